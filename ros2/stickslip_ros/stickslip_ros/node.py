"""ROS 2 node around ``stickslip.Tracker``: poses and touches in, the estimate and its frame out.

The README of the package has its parameters and topics.
"""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, WrenchStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Bool
from visualization_msgs.msg import MarkerArray

import stickslip
from stickslip_ros import markers, messages, quality
from stickslip_ros.following import Following
from stickslip_ros.planar import Pose, frames, planar, seconds, turned
from stickslip_ros.rows import Rows
from stickslip_ros.transforms import Transforms

#: Parameters with their defaults. A list of texts may not be empty, so [""] is no topic.
PARAMETERS = {
    "scene": "scene.toml",
    "object": "/object/pose",
    "pusher": "/pusher/pose",
    "fingers": [""],
    "contacts": [""],
    "wrench": "",
    "reliability": "best_effort",
    "depth": 50,
    "frame": "world",
    "child_frame": "stickslip_object",
    "rate": 30.0,
    "lag": 0.05,
    "particles": 500,
    "model": "robust",
    "seed": 0,
}


class StickslipNode(Node):
    """Connects messages, rows, the tracker and its estimates."""

    def __init__(self, **options: Any) -> None:
        super().__init__("stickslip", **options)
        given = {name: self.declare_parameter(name, default).value for name, default in PARAMETERS.items()}
        self._frame, self._child = given["frame"], given["child_frame"]
        scene = stickslip.load_scene(given["scene"])
        fingers, contacts = ([source for source in given[name] if source] for name in ("fingers", "contacts"))
        if len(fingers) != scene.fingers:
            text = f"`fingers` has {len(fingers)} sources, and {scene.name} {scene.fingers} [[finger]] tables"
            raise ValueError(f"{text}; give one for each table")
        self._rows = Rows(len(contacts), 1 / given["rate"], given["lag"], len(fingers))
        tracking = {name: given[name] for name in ("particles", "model", "seed")}
        self._following = Following(lambda: stickslip.Tracker(scene, **tracking))
        self._sent: float | None = None

        # outputs
        self._broadcaster = tf2_ros.TransformBroadcaster(self)
        self._poses = self.create_publisher(PoseWithCovarianceStamped, "~/pose", 10)
        self._health = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._scene = self.create_publisher(MarkerArray, "~/scene", quality.LATCHED)
        self._scene.publish(markers.scene(stickslip.outlines(scene), self._frame, self._child))

        # inputs
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer, self)
        self._transforms: list[Transforms] = []
        self._inputs = quality.of_inputs(given["reliability"], given["depth"])
        self._listen(given["object"], self._rows.object)
        for finger, source in enumerate([given["pusher"], *fingers]):
            self._listen(source, functools.partial(self._rows.pusher, finger=finger))
        for sensor, topic in enumerate(contacts):
            self._listen_to_touch(sensor, topic)
        if given["wrench"]:
            self._listen_to_force(given["wrench"])

        # twice the camera's rate, so that a complete row waits at most half a period
        self.create_timer(0.5 / given["rate"], self.tick)

    def tick(self) -> None:
        """Pushes the rows that are complete, and publishes their estimates."""
        for transforms in self._transforms:
            transforms.look()
        for row in self._rows.take():
            try:
                estimate = self._following.push(row)
            except stickslip.Error as error:
                self.get_logger().warning(str(error), throttle_duration_sec=1.0)
                continue
            if self._following.time is not None and not math.isnan(estimate["x"]):
                self._publish(estimate, self._following.time)

    def _listen(self, source: str, take: Callable[[float, Pose], None]) -> None:
        pair = frames(source)
        if pair is None:

            def on_pose(message: PoseStamped) -> None:
                self._check_frame(source, message.header.frame_id)
                take(seconds(message.header.stamp), planar(message.pose.position, message.pose.orientation))

            self.create_subscription(PoseStamped, source, on_pose, self._inputs)
            return
        if self._child in pair:
            raise ValueError(f"child_frame is `{self._child}`, a frame of `{source}`; give the estimate its own frame")

        def look_up() -> Any:
            try:
                return self._buffer.lookup_transform(*pair, Time())
            except tf2_ros.TransformException:
                return None

        self._check_frame(source, pair[0])
        self._transforms.append(Transforms(look_up, take))

    def _check_frame(self, source: str, found: str) -> None:
        if found not in ("", self._frame):
            text = f"{source}: the frame is `{found}`, and `frame` is `{self._frame}`; poses are used as they are"
            self.get_logger().warning(text, throttle_duration_sec=10.0)

    def _listen_to_touch(self, sensor: int, topic: str) -> None:
        def on_touch(message: Bool) -> None:
            self._rows.touch(sensor, message.data)

        self.create_subscription(Bool, topic, on_touch, self._inputs)

    def _listen_to_force(self, topic: str) -> None:
        def on_wrench(message: WrenchStamped) -> None:
            force, found = message.wrench.force, message.header.frame_id
            if found in ("", self._frame):
                self._rows.force(seconds(message.header.stamp), (force.x, force.y))
                return
            try:
                place = self._buffer.lookup_transform(self._frame, found, Time())
            except tf2_ros.TransformException as error:
                text = f"{topic}: a force in the frame `{found}` is left out: {error}"
                self.get_logger().warning(text, throttle_duration_sec=10.0)
                return
            self._rows.force(seconds(message.header.stamp), turned(force, place.transform.rotation))

        self.create_subscription(WrenchStamped, topic, on_wrench, self._inputs)

    def _publish(self, estimate: dict[str, float], time: float) -> None:
        self._poses.publish(messages.pose(estimate, self._frame, time))
        self._health.publish(messages.diagnostics(estimate, self._following, self._frame, time))
        if time != self._sent:
            # listeners of /tf refuse a second transform at one time
            self._broadcaster.sendTransform(messages.transform(estimate, self._frame, self._child, time))
            self._sent = time


def main(args: Sequence[str] | None = None) -> None:
    """Runs the node until it is shut down."""
    rclpy.init(args=args)
    node = StickslipNode()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
