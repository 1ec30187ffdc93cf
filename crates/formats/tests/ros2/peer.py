"""ROS 2 recordings by other people's programs: what is in ours, and one of theirs for us to read.

    peer.py decode RECORDING        every message as a line `program topic log-time stamp frame numbers`, by two programs
    peer.py record LOG.csv FOLDER   a log as a bag, packed with zstd, topic after topic and the latest messages first

Times are integers in nanoseconds; numbers are written as Python does, so that they read back to the same bits.
"""

import csv
import math
import sys
from pathlib import Path

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

    def wrench(self, time, x, y):
        vector = self.types["geometry_msgs/msg/Vector3"]
        wrench = self.types["geometry_msgs/msg/Wrench"](force=vector(x=x, y=y, z=0.0), torque=vector(x=0.0, y=0.0, z=0.0))
        return self.types["geometry_msgs/msg/WrenchStamped"](header=self.header(time), wrench=wrench)


def record(log, folder):
    rows = list(csv.DictReader(open(log)))
    times = [round(float(row["time"]) * SECOND) for row in rows]

    def cells(columns):
        """Times and numbers of the rows in which these are filled."""
        filled = [(time, [row[column] for column in columns]) for time, row in zip(times, rows) if row[columns[0]]]
        return [(time, [float(cell) for cell in numbers]) for time, numbers in filled]

    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        bag = Bag(writer)
        for body in ["object", "pusher"]:
            poses = cells([f"{body}_{axis}" for axis in ["x", "y", "theta"]])
            bag.topic(f"/{body}/pose", "geometry_msgs/msg/PoseStamped", [(time, bag.pose(time, *pose)) for time, pose in poses])
        for k in range(1, 1 + sum(column.startswith("tactile_") for column in rows[0])):
            touches = cells([f"tactile_{k}"])
            boolean = bag.types["std_msgs/msg/Bool"]
            bag.topic(f"/fixel_{k}/contact", "std_msgs/msg/Bool", [(time, boolean(data=bool(on))) for time, [on] in touches])
        if "pusher_force_x" in rows[0]:
            forces = cells(["pusher_force_x", "pusher_force_y"])
            bag.topic("/pusher/wrench", "geometry_msgs/msg/WrenchStamped", [(time, bag.wrench(time, *force)) for time, force in forces])


if __name__ == "__main__":
    {"decode": decode, "record": record}[sys.argv[1]](*sys.argv[2:])
