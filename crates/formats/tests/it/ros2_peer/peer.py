"""ROS 2 recordings by other people's programs: what is in ours, and one of theirs for us to read.

    peer.py decode RECORDING        every message as a line `program topic log-time stamp frame numbers`, by two programs
    peer.py estimate RECORDING      every message of an estimate as a line of numbers, by our definitions and by those of ROS 2 Humble
    peer.py record LOG.csv FOLDER   a log as a bag, packed with zstd, topic after topic and the latest messages first
    peer.py kinds LOG.csv FOLDER    the same with other messages: PoseWithCovarianceStamped, Odometry, WrenchStamped as a touch
    peer.py frames LOG.csv FOLDER   the same with both bodies on /tf only: the object by two tags in front of a camera, each
                                    hidden now and then, the pusher by a robot's flange
    peer.py images FRAMES CALIBRATION.toml FOLDER
                                    a folder of grey PNG frames as a bag of images, packed and not, grey and in colour, the latest
                                    ones first, with CameraInfo and a touch every third frame

Times are integers in nanoseconds; numbers are written as Python does, so that they read back to the same bits.
"""

import csv
import functools
import math
import struct
import sys
import tomllib
import zlib
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

SECOND = 1_000_000_000


def fields(message):
    """Stamp, frame and numbers of a message of any of the three types."""
    if hasattr(message, "data"):
        return "-", "-", [int(message.data)]
    stamp = message.header.stamp
    if hasattr(message, "pose"):
        p, q = message.pose.position, message.pose.orientation
        numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
    else:
        f, t = message.wrench.force, message.wrench.torque
        numbers = [f.x, f.y, f.z, t.x, t.y, t.z]
    return stamp.sec * SECOND + stamp.nanosec, message.header.frame_id, numbers


def show(program, topic, log_time, message):
    stamp, frame, numbers = fields(message)
    print(program, topic, log_time, stamp, frame, *(repr(number) for number in numbers))


def decode(path):
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for _, channel, record, message in reader.iter_decoded_messages():
            assert record.log_time == record.publish_time
            show("mcap-ros2", channel.topic, record.log_time, message)
    with AnyReader([Path(path)]) as reader:
        for connection, log_time, raw in reader.messages():
            show("rosbags", connection.topic, log_time, reader.deserialize(raw, connection.msgtype))


def estimate(path):
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, record, message in reader.iter_decoded_messages():
            show_estimate("ours", channel.topic, record.log_time, message)
    store = get_typestore(Stores.ROS2_HUMBLE)
    with AnyReader([Path(path)]) as reader:
        for connection, log_time, raw in reader.messages():
            show_estimate("humble", connection.topic, log_time, store.deserialize_cdr(raw, connection.msgtype))


def show_estimate(program, topic, log_time, message):
    if hasattr(message, "markers"):
        for m in message.markers:
            p, q, c = m.pose.position, m.pose.orientation, m.color
            points = [number for point in m.points for number in (point.x, point.y, point.z)]
            numbers = [m.id, m.type, p.x, p.y, q.z, q.w, round(c.r, 2), len(m.points), *points]
            print(program, topic, log_time, m.header.frame_id, m.ns, *(repr(float(number)) for number in numbers))
    elif hasattr(message, "transforms"):
        for t in message.transforms:
            p, q = t.transform.translation, t.transform.rotation
            print(program, topic, log_time, t.header.frame_id, t.child_frame_id, *(repr(float(n)) for n in [p.x, p.y, q.z, q.w]))
    elif hasattr(message, "poses"):
        numbers = [n for pose in message.poses for n in (pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w)]
        print(program, topic, log_time, message.header.frame_id, "-", *(repr(float(n)) for n in numbers))
    elif hasattr(message, "fields"):
        points = np.frombuffer(bytes(message.data), [(field.name, "<f4") for field in message.fields])
        assert len(points) == message.width and message.height == 1 and message.row_step == len(message.data)
        assert [field.offset for field in message.fields] == [0, 4, 8] and message.point_step == 12
        print(program, topic, log_time, message.header.frame_id, "-", *(repr(float(n)) for point in points for n in point))
    elif isinstance(getattr(message, "data", None), float):
        print(program, topic, log_time, "world", "-", repr(message.data))
    elif hasattr(message, "pose") and hasattr(message.pose, "covariance"):
        p, q, c = message.pose.pose.position, message.pose.pose.orientation, message.pose.covariance
        print(program, topic, log_time, message.header.frame_id, "-", *(repr(float(n)) for n in [p.x, p.y, q.z, q.w, *c]))


def trajectory(path):
    from evo.tools import file_interface

    read = file_interface.read_tum_trajectory_file(path)
    valid, why = read.check()
    assert valid, why
    for time, position, (_, _, yaw) in zip(read.timestamps, read.positions_xyz, read.get_orientations_euler()):
        print(*(repr(float(number)) for number in [time, *position, yaw]))


def told():
    """A covariance of x, y, z and turns about the axes."""
    return np.array([1e-6 * (1 + i) if i == j else 1e-7 / (1 + i + j) for i in range(6) for j in range(6)])


class Bag:
    """A bag while it is written."""

    def __init__(self, writer):
        self.writer = writer
        self.store = get_typestore(Stores.ROS2_HUMBLE)
        self.types = self.store.types

    def topic(self, name, kind, messages):
        connection = self.writer.add_connection(name, kind, typestore=self.store)
        for time, message in reversed(messages):
            self.writer.write(connection, time, self.store.serialize_cdr(message, kind))

    def header(self, time):
        stamp = self.types["builtin_interfaces/msg/Time"](sec=time // SECOND, nanosec=time % SECOND)
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id="table")

    def pose(self, time, x, y, theta):
        types = self.types
        half = theta / 2
        position = types["geometry_msgs/msg/Point"](x=x, y=y, z=0.7)
        turn = types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=math.sin(half), w=math.cos(half))
        pose = types["geometry_msgs/msg/Pose"](position=position, orientation=turn)
        return types["geometry_msgs/msg/PoseStamped"](header=self.header(time), pose=pose)

    def pose_with_covariance(self, time, x, y, theta):
        types = self.types
        pose = types["geometry_msgs/msg/PoseWithCovariance"](pose=self.pose(time, x, y, theta).pose, covariance=told())
        return types["geometry_msgs/msg/PoseWithCovarianceStamped"](header=self.header(time), pose=pose)

    def odometry(self, time, x, y, theta):
        types = self.types
        vector = types["geometry_msgs/msg/Vector3"](x=1.0, y=2.0, z=3.0)
        twist = types["geometry_msgs/msg/TwistWithCovariance"](
            twist=types["geometry_msgs/msg/Twist"](linear=vector, angular=vector), covariance=np.arange(36.0)
        )
        pose = self.pose_with_covariance(time, x, y, theta).pose
        return types["nav_msgs/msg/Odometry"](header=self.header(time), child_frame_id="hand", pose=pose, twist=twist)

    def transforms(self, time, *links):
        """A message on /tf of links (parent, child, 4 x 4 matrix)."""
        types = self.types
        stamp = self.header(time).stamp
        messages = []
        for parent, child, m in links:
            x, y, z, w = quaternion(m[:3, :3])
            transform = types["geometry_msgs/msg/Transform"](
                translation=types["geometry_msgs/msg/Vector3"](x=m[0, 3], y=m[1, 3], z=m[2, 3]),
                rotation=types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
            )
            header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=parent)
            messages.append(types["geometry_msgs/msg/TransformStamped"](header=header, child_frame_id=child, transform=transform))
        return types["tf2_msgs/msg/TFMessage"](transforms=messages)

    def wrench(self, time, x, y):
        vector = self.types["geometry_msgs/msg/Vector3"]
        wrench = self.types["geometry_msgs/msg/Wrench"](force=vector(x=x, y=y, z=0.0), torque=vector(x=0.0, y=0.0, z=0.0))
        return self.types["geometry_msgs/msg/WrenchStamped"](header=self.header(time), wrench=wrench)


def motion(x, y, z, yaw, over=0.0):
    """A rigid motion as a 4 x 4 matrix: to a point, turned about z and then over its own x-axis."""
    c, s, co, so = math.cos(yaw), math.sin(yaw), math.cos(over), math.sin(over)
    return np.array([[c, -s * co, s * so, x], [s, c * co, -c * so, y], [0.0, so, co, z], [0.0, 0.0, 0.0, 1.0]])


def quaternion(r):
    """The unit quaternion (x, y, z, w) of a rotation, as an eigenvector (Bar-Itzhack)."""
    k = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[2, 0] + r[0, 2], r[2, 1] - r[1, 2]],
            [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], r[2, 1] + r[1, 2], r[0, 2] - r[2, 0]],
            [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r[0, 0] + r[1, 1] + r[2, 2]],
        ]
    )
    return np.linalg.eigh(k)[1][:, 3]


class Log:
    """A table of measurements."""

    def __init__(self, path):
        self.rows = list(csv.DictReader(open(path)))
        self.times = [round(float(row["time"]) * SECOND) for row in self.rows]

    def cells(self, *columns):
        """Times and numbers of the rows in which these are filled."""
        filled = [(time, [row[column] for column in columns]) for time, row in zip(self.times, self.rows) if row[columns[0]]]
        return [(time, [float(cell) for cell in numbers]) for time, numbers in filled]

    def poses(self, body):
        return self.cells(*[f"{body}_{axis}" for axis in ["x", "y", "theta"]])

    def sensors(self):
        return [(k, self.cells(f"tactile_{k}")) for k in range(1, 1 + sum(column.startswith("tactile_") for column in self.rows[0]))]


def writing(folder):
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    return writer


def record(path, folder):
    log = Log(path)
    with writing(folder) as writer:
        bag = Bag(writer)
        for body in ["object", "pusher"]:
            poses = [(time, bag.pose(time, *pose)) for time, pose in log.poses(body)]
            bag.topic(f"/{body}/pose", "geometry_msgs/msg/PoseStamped", poses)
        write_touches(bag, log)
        if "pusher_force_x" in log.rows[0]:
            forces = log.cells("pusher_force_x", "pusher_force_y")
            bag.topic("/pusher/wrench", "geometry_msgs/msg/WrenchStamped", [(time, bag.wrench(time, *force)) for time, force in forces])


def write_touches(bag, log):
    boolean = bag.types["std_msgs/msg/Bool"]
    for k, touches in log.sensors():
        bag.topic(f"/fixel_{k}/contact", "std_msgs/msg/Bool", [(time, boolean(data=bool(on))) for time, [on] in touches])


def kinds(path, folder):
    log = Log(path)
    with writing(folder) as writer:
        bag = Bag(writer)
        objects = [(time, bag.pose_with_covariance(time, *pose)) for time, pose in log.poses("object")]
        bag.topic("/object/pose", "geometry_msgs/msg/PoseWithCovarianceStamped", objects)
        pushers = [(time, bag.odometry(time, *pose)) for time, pose in log.poses("pusher")]
        bag.topic("/pusher/pose", "nav_msgs/msg/Odometry", pushers)
        for k, touches in log.sensors():
            forces = [(time, bag.wrench(time, 0.0, -0.06 if on else 0.04)) for time, [on] in touches]
            bag.topic(f"/fixel_{k}/contact", "geometry_msgs/msg/WrenchStamped", forces)


def frames(path, folder):
    log = Log(path)
    camera = motion(0.3, -0.1, 0.9, 0.7, over=math.pi)
    base = motion(-0.5, 0.2, 0.0, -1.1)
    # the second tag looks down, as detectors of tags have it
    tags = {"tag_7": (0, motion(0.012, -0.004, 0.02, 1.5)), "tag36h11:8": (1, motion(-0.02, 0.01, 0.02, -0.5, over=math.pi))}
    with writing(folder) as writer:
        bag = Bag(writer)
        messages = []
        for row, (time, (x, y, theta)) in enumerate(log.poses("object")):
            body = motion(x, y, 0.0, theta)
            seen = [(name, body @ mount) for name, (k, mount) in tags.items() if row % 9 != 3 + k]
            links = [("camera", name, np.linalg.inv(camera) @ tag) for name, tag in seen]
            messages.append((time, bag.transforms(time, *links)))
        for time, (x, y, theta) in log.poses("pusher"):
            flange = np.linalg.inv(base) @ motion(x, y, 0.3, theta)
            messages.append((time, bag.transforms(time, ("base", "flange", flange), ("flange", "finger", motion(0.0, 0.0, 0.1, row)))))
        bag.topic("/tf", "tf2_msgs/msg/TFMessage", messages)
        still = bag.transforms(0, ("table", "camera", camera), ("table", "base", base))
        bag.topic("/tf_static", "tf2_msgs/msg/TFMessage", [(log.times[0], still)])
        write_touches(bag, log)


@functools.cache
def grey_pixels(png):
    """The pixels of a grey PNG file of 8 bits, by its specification."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        body = png[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
            assert (depth, colour, interlace) == (8, 0, 0)
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    lines = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, width + 1)
    above = np.zeros(width, np.uint8)
    rows = []
    for line in lines:
        row = unfiltered(line[0], line[1:], above)
        rows.append(row)
        above = row
    return np.array(rows)


def unfiltered(kind, line, above):
    """A row of a PNG file from what stands for it and the row above."""
    if kind == 0:
        return line.copy()
    if kind == 2:
        return line + above
    row = np.zeros_like(line)
    for x in range(len(line)):
        left, up, corner = (int(row[x - 1]) if x else 0), int(above[x]), (int(above[x - 1]) if x else 0)
        guess = left + up - corner
        paeth = min([left, up, corner], key=lambda side: abs(guess - side))
        row[x] = (int(line[x]) + {1: left, 3: (left + up) // 2, 4: paeth}[int(kind)]) % 256
    return row


def images(frames, calibration, folder):
    lens = tomllib.loads(Path(calibration).read_text())["lens"]
    rows = list(csv.DictReader(open(Path(frames) / "frames.csv")))
    shots = [(round(float(row["time"]) * SECOND), (Path(frames) / row["file"]).read_bytes()) for row in rows]
    with writing(folder) as writer:
        bag = Bag(writer)
        types = bag.types

        def packed(time, png):
            data = np.frombuffer(png, np.uint8)
            return types["sensor_msgs/msg/CompressedImage"](header=bag.header(time), format="mono8; png compressed mono8", data=data)

        def raw(time, png, encoding):
            pixels = grey_pixels(png)
            if encoding == "mono16":
                rows = np.pad(pixels.astype(">u2") * 257, ((0, 0), (0, 3)))
            else:
                rows = np.pad(np.repeat(pixels, {"mono8": 1, "bgr8": 3}[encoding], axis=1), ((0, 0), (0, 16)), constant_values=9)
            data = np.frombuffer(rows.tobytes(), np.uint8)
            height, width = pixels.shape
            return types["sensor_msgs/msg/Image"](
                header=bag.header(time), height=height, width=width, encoding=encoding, is_bigendian=int(encoding == "mono16"),
                step=len(data) // height, data=data,
            )  # fmt: skip

        def info(time):
            (fx, fy), (cx, cy), size = lens["focal"], lens["centre"], lens["size"]
            (k1, k2, *k3), (p1, p2) = lens["radial"], lens["tangential"]
            roi = types["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
            return types["sensor_msgs/msg/CameraInfo"](
                header=bag.header(time), height=size[1], width=size[0], distortion_model="plumb_bob",
                d=np.array([k1, k2, p1, p2, *(k3 or [0.0])]), k=np.array([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
                r=np.eye(3).flatten(), p=np.array([fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]), binning_x=0, binning_y=0, roi=roi,
            )  # fmt: skip

        times = [time for time, _ in shots]
        bag.topic("/cam/image_raw/compressed", "sensor_msgs/msg/CompressedImage", [(time, packed(time, png)) for time, png in shots])
        for name, encoding in [("cam", "mono8"), ("colour", "bgr8"), ("deep", "mono16")]:
            bag.topic(f"/{name}/image_raw", "sensor_msgs/msg/Image", [(time, raw(time, png, encoding)) for time, png in shots])
            bag.topic(f"/{name}/camera_info", "sensor_msgs/msg/CameraInfo", [(time, info(time)) for time in times])
        boolean = types["std_msgs/msg/Bool"]
        bag.topic("/fixel_1/contact", "std_msgs/msg/Bool", [(time, boolean(data=k % 3 == 0)) for k, time in enumerate(times)])


if __name__ == "__main__":
    commands = {"decode": decode, "estimate": estimate, "trajectory": trajectory, "record": record, "kinds": kinds, "frames": frames, "images": images}
    commands[sys.argv[1]](*sys.argv[2:])
