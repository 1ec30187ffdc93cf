"""The node of ros2/stickslip_ros and a peer that publishes its inputs and receives its outputs.

The middleware is that of rclpy where it is installed, else a stand-in.
"""

import math
import os
import time
from collections import Counter, defaultdict
from types import SimpleNamespace

import ros2_stand_in

ros2_stand_in.install()

import rclpy  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from geometry_msgs.msg import (  # noqa: E402
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    WrenchStamped,
)
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from std_msgs.msg import Bool  # noqa: E402
from visualization_msgs.msg import MarkerArray  # noqa: E402

from stickslip_ros import node as under_test  # noqa: E402
from stickslip_ros import quality  # noqa: E402
from stickslip_ros.messages import fill_header  # noqa: E402
from stickslip_ros.rows import Rows  # noqa: E402

#: True if rclpy is not installed.
IS_STAND_IN = ros2_stand_in.Node is Node

OUTPUTS = {"/stickslip/pose": PoseWithCovarianceStamped, "/diagnostics": DiagnosticArray}


class CountedRows(Rows):
    """Rows that count messages and keep what was taken."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.messages, self.taken = Counter(), []

    def object(self, *arguments):
        super().object(*arguments)
        self.messages["object"] += 1

    def pusher(self, *arguments, finger):
        super().pusher(*arguments, finger=finger)
        self.messages["pusher"] += 1

    def touch(self, *arguments):
        super().touch(*arguments)
        self.messages["touch"] += 1

    def force(self, *arguments):
        super().force(*arguments)
        self.messages["force"] += 1

    def take(self):
        rows = super().take()
        self.taken += rows
        return rows


class Session:
    """A running node. Each message is received before the next one is sent."""

    def __init__(self, monkeypatch, **parameters):
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        monkeypatch.setattr(under_test, "Rows", CountedRows)
        monkeypatch.setattr(ros2_stand_in.Buffer, "transforms", {})
        self.transforms = ros2_stand_in.Buffer.transforms
        self.broadcast = ros2_stand_in.Broadcaster.sent
        self.received, self.warnings, self._publishers = defaultdict(list), [], {}
        rclpy.init(domain_id=1 + os.getpid() % 100)
        given = {"reliability": "reliable", "frame": "table", **parameters}
        try:
            self.node = under_test.StickslipNode(
                parameter_overrides=[Parameter(name, value=value) for name, value in given.items()]
            )
            self.node.get_logger = lambda: SimpleNamespace(warning=lambda text, **_: self.warnings.append(text))
            self._count_answers()
            self.peer = Node("peer")
            self.executor = SingleThreadedExecutor()
            for node in (self.node, self.peer):
                self.executor.add_node(node)
            for topic, kind in OUTPUTS.items():
                self.peer.create_subscription(kind, topic, self.received[topic].append, 1000)
            self.until(lambda: self.node._poses.get_subscription_count() and self.node._health.get_subscription_count())
        except BaseException:
            rclpy.try_shutdown()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        for node in (self.node, self.peer):
            node.destroy_node()
        rclpy.shutdown()

    def until(self, done, seconds=20.0):
        """Runs the nodes until ``done()``."""
        end = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < end, "no message came"
            self.executor.spin_once(timeout_sec=0.005)

    def pose(self, topic, stamp, pose):
        """Sends a pose in the plane."""
        message = PoseStamped()
        fill_header(message.header, "table", stamp)
        place(message.pose.position, message.pose.orientation, pose)
        self._send(topic, message, "object" if "object" in topic else "pusher")

    def transform(self, parent, child, stamp, pose):
        """Puts a transform into the buffer."""
        message = TransformStamped()
        fill_header(message.header, parent, stamp)
        place(message.transform.translation, message.transform.rotation, pose)
        self.transforms[parent, child] = message

    def touch(self, topic, on):
        """Sends a reading of a sensor."""
        message = Bool()
        message.data = on
        self._send(topic, message, "touch")

    def force(self, topic, stamp, force, frame="table"):
        """Sends a force."""
        message = WrenchStamped()
        fill_header(message.header, frame, stamp)
        message.wrench.force.x, message.wrench.force.y, message.wrench.force.z = force
        self._send(topic, message, "force")

    def tick(self):
        """Lets the node take its rows, and receives its estimates."""
        self.node.tick()
        self.until(lambda: len(self.poses) == len(self.health) == self._answers)

    def scene(self):
        """Returns the scene's markers as a viewer receives them that starts now."""
        found = []
        self.peer.create_subscription(MarkerArray, "/stickslip/scene", found.append, quality.LATCHED)
        self.until(lambda: found)
        return found[0].markers

    @property
    def poses(self):
        """Poses of the node so far."""
        return self.received["/stickslip/pose"]

    @property
    def health(self):
        """Diagnostics of the node so far."""
        return self.received["/diagnostics"]

    @property
    def rows(self):
        """Rows of the node so far."""
        return self.node._rows.taken

    def _count_answers(self):
        publish, self._answers = self.node._publish, 0

        def counted(*arguments):
            publish(*arguments)
            self._answers += 1

        self.node._publish = counted

    def _send(self, topic, message, kind):
        if topic not in self._publishers:
            self._publishers[topic] = self.peer.create_publisher(type(message), topic, 10)
            self.until(self._publishers[topic].get_subscription_count)
        before = self.node._rows.messages[kind]
        self._publishers[topic].publish(message)
        self.until(lambda: self.node._rows.messages[kind] > before)


def place(position, orientation, pose):
    """Fills a position and an orientation with a pose in the plane, above it."""
    position.x, position.y, position.z = pose[0], pose[1], 0.3
    orientation.z, orientation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
