"""Stamps and poses of ROS as times and poses in the plane."""

from __future__ import annotations

import math
from typing import Any

#: x, y (m) and theta (rad).
Pose = tuple[float, float, float]

#: x, y (N).
Force = tuple[float, float]


def seconds(stamp: Any) -> float:
    """Returns the time of a ``builtin_interfaces/msg/Time`` (s), correctly rounded."""
    return float((stamp.sec * 10**9 + stamp.nanosec) / 10**9)


def planar(position: Any, orientation: Any) -> Pose:
    """Returns x, y (m) and the heading of the x-axis (rad) of a pose with an upright z-axis."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    return position.x, position.y, math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def turned(force: Any, orientation: Any) -> Force:
    """Returns x, y (N) of a force in the frame in which its own frame has this orientation."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    return (
        (1 - 2 * (y * y + z * z)) * force.x + 2 * (x * y - w * z) * force.y + 2 * (x * z + w * y) * force.z,
        2 * (x * y + w * z) * force.x + (1 - 2 * (x * x + z * z)) * force.y + 2 * (y * z - w * x) * force.z,
    )


def frames(source: str) -> tuple[str, str] | None:
    """Returns parent and child of a source such as ``/tf:table.tag_7``; None for a topic."""
    if not source.startswith("/tf:"):
        return None
    parent, dot, child = source.removeprefix("/tf:").partition(".")
    if not (parent and dot and child):
        raise ValueError(f"the source is `{source}`; frames are named as /tf:parent.child")
    return parent, child
