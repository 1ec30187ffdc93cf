"""Modules of ROS 2 that pass messages on within the process, where rclpy is not installed.

tf2_ros is always a stand-in: transforms are put into ``Buffer.transforms``.
"""

import sys
from collections import defaultdict
from types import ModuleType, SimpleNamespace
from typing import ClassVar

import numpy as np


def install() -> None:
    """Installs what is missing."""
    _module("tf2_ros", Buffer=Buffer, TransformListener=Listener, TransformBroadcaster=Broadcaster)
    sys.modules["tf2_ros"].TransformException = KeyError
    try:
        import rclpy  # noqa: F401
    except ImportError:
        _install_rclpy()


class Buffer:
    """Transforms by parent and child."""

    transforms: ClassVar = {}

    def lookup_transform(self, parent, child, _):
        return self.transforms[parent, child]


class Listener:
    def __init__(self, buffer, node):
        pass


class Broadcaster:
    """Keeps what is sent."""

    sent: ClassVar = []

    def __init__(self, node):
        self.sent.clear()

    def sendTransform(self, message):
        self.sent.append(message)


class Node:
    """Node of a process without a middleware."""

    subscriptions: ClassVar = defaultdict(list)
    latched: ClassVar = {}

    def __init__(self, name, *, parameter_overrides=()):
        self.name, self.given = name, {parameter.name: parameter for parameter in parameter_overrides}

    def declare_parameter(self, name, default):
        return self.given.get(name, SimpleNamespace(value=default))

    def create_subscription(self, kind, topic, take, qos):
        topic = self._resolved(topic)
        self.subscriptions[topic].append(take)
        for message in self.latched.get(topic, []):
            take(message)

    def create_publisher(self, kind, topic, qos):
        topic = self._resolved(topic)

        def publish(message):
            if getattr(qos, "durability", None) == "transient_local":
                self.latched[topic] = [message]
            for take in self.subscriptions[topic]:
                take(message)

        return SimpleNamespace(publish=publish, get_subscription_count=lambda: len(self.subscriptions[topic]))

    def create_timer(self, period, tick):
        pass

    def destroy_node(self):
        self.subscriptions.clear()
        self.latched.clear()

    def _resolved(self, topic):
        return topic.replace("~", f"/{self.name}")


def _kind(kind, constants=(), /, **fields):
    """Makes a message type of fields and what makes their defaults."""

    def __init__(self, **given):
        for field, default in fields.items():
            setattr(self, field, given[field] if field in given else default())

    return type(kind, (), {"__init__": __init__, **dict(constants)})


def _module(name, **members):
    module = ModuleType(name)
    vars(module).update(members)
    sys.modules[name] = module


def _install_rclpy() -> None:
    def nothing(*_, **__):
        pass

    executor = SimpleNamespace(add_node=nothing, spin_once=nothing, shutdown=nothing)
    reliability = SimpleNamespace(BEST_EFFORT="best_effort", RELIABLE="reliable")
    _module("rclpy", init=nothing, shutdown=nothing, try_shutdown=nothing, spin=nothing)
    _module("rclpy.executors", ExternalShutdownException=InterruptedError, SingleThreadedExecutor=lambda: executor)
    _module("rclpy.node", Node=Node)
    _module("rclpy.parameter", Parameter=lambda name, value: SimpleNamespace(name=name, value=value))
    _module(
        "rclpy.qos",
        DurabilityPolicy=SimpleNamespace(TRANSIENT_LOCAL="transient_local"),
        QoSProfile=SimpleNamespace,
        ReliabilityPolicy=reliability,
    )
    _module("rclpy.time", Time=SimpleNamespace)
    _install_messages()


def _install_messages() -> None:
    stamp = _kind("Time", sec=int, nanosec=int)
    header = _kind("Header", stamp=stamp, frame_id=str)
    point = _kind("Point", x=float, y=float, z=float)
    quaternion = _kind("Quaternion", x=float, y=float, z=float, w=lambda: 1.0)
    pose = _kind("Pose", position=point, orientation=quaternion)
    covariance = _kind("PoseWithCovariance", pose=pose, covariance=lambda: np.zeros(36))
    vector = _kind("Vector3", x=float, y=float, z=float)
    wrench = _kind("Wrench", force=vector, torque=vector)
    transform = _kind("Transform", translation=point, rotation=quaternion)
    colour = _kind("ColorRGBA", r=float, g=float, b=float, a=float)
    levels = {"OK": b"\0", "WARN": b"\1"}
    marker = {"header": header, "ns": str, "id": int, "type": int, "action": int, "pose": pose, "scale": point}
    marker |= {"color": colour, "frame_locked": bool, "points": list}
    _module(
        "diagnostic_msgs.msg",
        DiagnosticArray=_kind("DiagnosticArray", header=header, status=list),
        DiagnosticStatus=_kind("DiagnosticStatus", levels, level=lambda: b"\0", name=str, message=str, values=list),
        KeyValue=_kind("KeyValue", key=str, value=str),
    )
    _module(
        "geometry_msgs.msg",
        Point=point,
        PoseStamped=_kind("PoseStamped", header=header, pose=pose),
        PoseWithCovarianceStamped=_kind("PoseWithCovarianceStamped", header=header, pose=covariance),
        TransformStamped=_kind("TransformStamped", header=header, child_frame_id=str, transform=transform),
        WrenchStamped=_kind("WrenchStamped", header=header, wrench=wrench),
    )
    _module("std_msgs.msg", Bool=_kind("Bool", data=bool))
    _module(
        "visualization_msgs.msg",
        Marker=_kind("Marker", {"LINE_STRIP": 4, "ADD": 0}, **marker),
        MarkerArray=_kind("MarkerArray", markers=list),
    )
