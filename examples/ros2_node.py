"""ROS 2 node around ``stickslip.Tracker``: poses and touches in, the estimate and its frame out.

    python3 ros2_node.py --ros-args -p scene:=my/scene.toml -p object:=/tf:table.tag_7 -p pusher:=/pusher/pose \
        -p contacts:="['/fixel_1/contact']"

Needs a sourced ROS 2 with rclpy and tf2_ros, and the Python package stickslip. The parameters are
in the guide, docs/guide/live.md. ``main`` only connects the functions of this file to ROS.
"""

from __future__ import annotations

import contextlib
import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Any

import stickslip

#: x, y (m) and theta (rad).
Pose = tuple[float, float, float]

#: Shortest step, forth or back, that restarts the tracker, and longest step to the row after it (s).
PAUSE, NEAR = 5.0, 1.0

#: Time for which pusher poses are kept (s).
KEPT = 2.0


def seconds(stamp: Any) -> float:
    """Returns the time of a ``builtin_interfaces/msg/Time`` (s)."""
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def planar(position: Any, orientation: Any) -> Pose:
    """Returns x, y (m) and the heading of the x-axis (rad) of a pose with an upright z-axis."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    return position.x, position.y, math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def frames(source: str) -> tuple[str, str] | None:
    """Returns parent and child of a source such as ``/tf:table.tag_7``; None for a topic."""
    if not source.startswith("/tf:"):
        return None
    parent, dot, child = source.removeprefix("/tf:").partition(".")
    if not (parent and dot and child):
        raise ValueError(f"the source is `{source}`; frames are named as /tf:parent.child")
    return parent, child


def between(track: Sequence[tuple[float, Pose]], time: float) -> Pose | None:
    """Interpolates the pose at ``time`` (s); the last pose after the track, None before it."""
    after = bisect_left(track, time, key=lambda entry: entry[0])
    if after == len(track) or track[after][0] == time:
        return track[min(after, len(track) - 1)][1] if track else None
    if after == 0:
        return None
    (t0, (x0, y0, a0)), (t1, (x1, y1, a1)) = track[after - 1], track[after]
    share = (time - t0) / (t1 - t0)
    turn = math.remainder(a1 - a0, 2 * math.pi)
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0), a0 + share * turn


class Rows:
    """Makes rows at the camera's rate from messages that arrive asynchronously.

    A row waits until a pusher pose at its time or later arrives, at most ``period`` (s). A row has
    the pusher alone if no object pose arrives for one and a half periods plus ``lag`` (s), the
    delay of the camera's poses after the pusher's of the same time. A sensor reads true if it was
    true at any time since the previous row.
    """

    def __init__(self, sensors: int, period: float, lag: float = 0.0) -> None:
        self._period, self._lag = period, lag
        self._objects: list[tuple[float, Pose]] = []
        self._pusher: list[tuple[float, Pose]] = []
        self._reads: list[bool | None] = [None] * sensors
        self._touched = [False] * sensors
        self._latest = -math.inf

    def object(self, time: float, pose: Pose) -> None:
        """Takes a pose of the object at a time (s)."""
        self._objects.append((time, pose))

    def pusher(self, time: float, pose: Pose) -> None:
        """Takes a pose of the pusher at a time (s); ignores it if it is out of order."""
        if self._pusher and self._pusher[-1][0] - time > PAUSE:
            # another clock, or one wrong time
            self._pusher = []
        if not self._pusher or time > self._pusher[-1][0]:
            self._pusher.append((time, pose))

    def touch(self, sensor: int, on: bool) -> None:
        """Takes a reading of a sensor; sensors are numbered from 0."""
        self._reads[sensor] = on
        self._touched[sensor] |= on

    def take(self) -> list[stickslip.Row]:
        """Returns the rows that are complete, each once."""
        rows = []
        newest = max([time for time, _ in self._pusher[-1:] + self._objects], default=-math.inf)
        passed = self._pusher[-1][0] if self._pusher else -math.inf
        waiting = []
        for time, pose in sorted(self._objects, key=lambda entry: entry[0]):
            if passed >= time or newest - time >= self._period:
                rows.append(self._row(time, pose))
            else:
                waiting.append((time, pose))
        self._objects = waiting
        while not waiting and -math.inf < self._latest + 1.5 * self._period + self._lag <= passed:
            # a pause gives one row, which the tracker refuses
            step = self._period if passed - self._latest < PAUSE else passed - self._latest
            rows.append(self._row(self._latest + step, None))
        self._pusher = [entry for entry in self._pusher if entry[0] >= passed - KEPT]
        return rows

    def _row(self, time: float, pose: Pose | None) -> stickslip.Row:
        is_set_back = self._latest - time > PAUSE
        is_late = time <= self._latest and not is_set_back
        self._latest = time if is_set_back else max(time, self._latest)
        readings = zip(self._touched, self._reads, strict=True)
        tactile = [None if read is None else on or read for on, read in readings]
        if not is_late:
            self._touched = [False] * len(self._touched)
        return {"time": time, "object": pose, "pusher": between(self._pusher, time), "tactile": tactile, "force": None}


class Following:
    """Tracker that restarts after a pause, or when the clock is set back."""

    def __init__(self, start: Callable[[], stickslip.Tracker]) -> None:
        self._start = start
        self._tracker = start()
        self.time: float | None = None
        self._elsewhere: float | None = None

    def push(self, row: stickslip.Row) -> dict[str, float]:
        """Returns the estimate at the latest row, whose time is ``time`` (s).

        Raises :class:`stickslip.Error` if the row is invalid, or if it is the first one that is far
        from the others, since its time may be wrong.
        """
        time = row["time"]
        try:
            estimate = self._tracker.push(**row)
        except stickslip.Error:
            before = self._elsewhere
            far = self.time is not None and abs(time - self.time) > PAUSE
            self._elsewhere = time if far else before
            if not far or before is None or not 0 <= time - before <= NEAR:
                raise
            tracker = self._start()
            estimate = tracker.push(**row)
            self._tracker, self.time = tracker, None
        self._elsewhere = None
        self.time = time if self.time is None else max(time, self.time)
        return estimate


def fill_header(header: Any, frame: str, time: float) -> None:
    """Fills a ``std_msgs/msg/Header`` with a frame and a time (s)."""
    whole = math.floor(time)
    # a product with the whole time would lose digits
    nanoseconds = round(1e9 * (time - whole))
    header.frame_id = frame
    header.stamp.sec, header.stamp.nanosec = whole + nanoseconds // 10**9, nanoseconds % 10**9


def _fill_place(position: Any, orientation: Any, estimate: dict[str, float]) -> None:
    position.x, position.y = estimate["x"], estimate["y"]
    orientation.z, orientation.w = math.sin(estimate["theta"] / 2), math.cos(estimate["theta"] / 2)


def fill_pose(message: Any, estimate: dict[str, float]) -> None:
    """Fills a ``geometry_msgs/msg/PoseWithCovarianceStamped`` with pose and covariance of an estimate."""
    _fill_place(message.pose.pose.position, message.pose.pose.orientation, estimate)
    for place, name in [(0, "std_x"), (7, "std_y"), (35, "std_theta")]:
        message.pose.covariance[place] = estimate[name] ** 2
    for row, column, name in [(0, 1, "cov_x_y"), (0, 5, "cov_x_theta"), (1, 5, "cov_y_theta")]:
        message.pose.covariance[6 * row + column] = message.pose.covariance[6 * column + row] = estimate[name]


def fill_transform(message: Any, estimate: dict[str, float], child: str) -> None:
    """Fills a ``geometry_msgs/msg/TransformStamped`` with the pose of an estimate as the frame ``child``."""
    message.child_frame_id = child
    _fill_place(message.transform.translation, message.transform.rotation, estimate)


def words(estimate: dict[str, float]) -> list[tuple[str, str]]:
    """Returns friction, contacts and health of an estimate for ``diagnostic_msgs/msg/KeyValue``."""
    placed = {"x", "y", "theta", "std_x", "std_y", "std_theta", "cov_x_y", "cov_x_theta", "cov_y_theta"}
    return [(name, f"{value:.6g}") for name, value in estimate.items() if name not in placed and not math.isnan(value)]


class Transforms:
    """Reports each transform of a frame once."""

    def __init__(self, look_up: Callable[[], Any], take: Callable[[float, Pose], None]) -> None:
        self._look_up, self._take, self._latest = look_up, take, -math.inf

    def look(self) -> None:
        """Takes the newest transform if it is new."""
        found = self._look_up()
        if found is None or seconds(found.header.stamp) <= self._latest:
            return
        self._latest = seconds(found.header.stamp)
        self._take(self._latest, planar(found.transform.translation, found.transform.rotation))


def main() -> None:
    """Runs the node until it is shut down."""
    import rclpy
    import tf2_ros
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
    from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped
    from rclpy.executors import ExternalShutdownException
    from rclpy.qos import qos_profile_sensor_data
    from rclpy.time import Time
    from std_msgs.msg import Bool

    rclpy.init()
    node = rclpy.create_node("stickslip")

    def parameter(name: str, default: Any) -> Any:
        return node.declare_parameter(name, default).value

    scene = stickslip.load_scene(parameter("scene", "scene.toml"))
    particles, frame, rate = parameter("particles", 500), parameter("frame", "world"), parameter("rate", 30.0)
    contacts = [topic for topic in parameter("contacts", [""]) if topic]
    following = Following(lambda: stickslip.Tracker(scene, particles=particles))
    rows = Rows(len(contacts), 1 / rate, parameter("lag", 0.05))
    buffer = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(buffer, node)
    broadcaster = tf2_ros.TransformBroadcaster(node)
    poses = node.create_publisher(PoseWithCovarianceStamped, "~/pose", 10)
    health = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
    looked_up = []

    def listen(source: str, take: Callable[[float, Pose], None]) -> None:
        pair = frames(source)
        if pair is None:

            def on_pose(message: Any) -> None:
                take(seconds(message.header.stamp), planar(message.pose.position, message.pose.orientation))

            node.create_subscription(PoseStamped, source, on_pose, qos_profile_sensor_data)
            return

        def look_up() -> Any:
            try:
                return buffer.lookup_transform(*pair, Time())
            except tf2_ros.TransformException:
                return None

        looked_up.append(Transforms(look_up, take))

    listen(parameter("object", "/object/pose"), rows.object)
    listen(parameter("pusher", "/pusher/pose"), rows.pusher)
    for sensor, topic in enumerate(contacts):
        node.create_subscription(
            Bool, topic, lambda message, sensor=sensor: rows.touch(sensor, message.data), qos_profile_sensor_data
        )

    def publish(estimate: dict[str, float], time: float) -> None:
        pose, transform, status = PoseWithCovarianceStamped(), TransformStamped(), DiagnosticArray()
        for message in (pose, transform, status):
            fill_header(message.header, frame, time)
        fill_pose(pose, estimate)
        fill_transform(transform, estimate, "stickslip_object")
        values = [KeyValue(key=key, value=value) for key, value in words(estimate)]
        status.status = [DiagnosticStatus(name="stickslip", values=values)]
        poses.publish(pose)
        broadcaster.sendTransform(transform)
        health.publish(status)

    def on_time() -> None:
        for transforms in looked_up:
            transforms.look()
        for row in rows.take():
            try:
                estimate = following.push(row)
            except stickslip.Error as error:
                node.get_logger().warning(str(error), throttle_duration_sec=1.0)
                continue
            if following.time is not None and not math.isnan(estimate["x"]):
                publish(estimate, following.time)

    # twice the camera's rate, so that a complete row waits at most half a period
    node.create_timer(0.5 / rate, on_time)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    listener.unregister()
    node.destroy_node()


if __name__ == "__main__":
    main()
