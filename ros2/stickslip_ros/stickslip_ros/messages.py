"""Estimates as messages."""

from __future__ import annotations

import math
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped

from stickslip_ros.following import Following

#: Estimated quantities that other messages have.
PLACED = {"time", "x", "y", "theta", "cov_x_y", "cov_x_theta", "cov_y_theta"}


def fill_header(header: Any, frame: str, time: float) -> None:
    """Fills a ``std_msgs/msg/Header`` with a frame and a time (s)."""
    whole = math.floor(time)
    # a product with the whole time would lose digits
    nanoseconds = round(1e9 * (time - whole))
    header.frame_id = frame
    header.stamp.sec, header.stamp.nanosec = whole + nanoseconds // 10**9, nanoseconds % 10**9


def pose(estimate: dict[str, float], frame: str, time: float) -> PoseWithCovarianceStamped:
    """Returns pose and covariance of an estimate."""
    message = PoseWithCovarianceStamped()
    fill_header(message.header, frame, time)
    _fill_place(message.pose.pose.position, message.pose.pose.orientation, estimate)
    for place, name in [(0, "std_x"), (7, "std_y"), (35, "std_theta")]:
        message.pose.covariance[place] = estimate[name] ** 2
    for row, column, name in [(0, 1, "cov_x_y"), (0, 5, "cov_x_theta"), (1, 5, "cov_y_theta")]:
        message.pose.covariance[6 * row + column] = message.pose.covariance[6 * column + row] = estimate[name]
    return message


def transform(estimate: dict[str, float], frame: str, child: str, time: float) -> TransformStamped:
    """Returns the pose of an estimate as the frame ``child`` in ``frame``."""
    message = TransformStamped()
    fill_header(message.header, frame, time)
    message.child_frame_id = child
    _fill_place(message.transform.translation, message.transform.rotation, estimate)
    return message


def diagnostics(estimate: dict[str, float], following: Following, frame: str, time: float) -> DiagnosticArray:
    """Returns friction, contacts, spreads and health of an estimate, and the counts of its tracker.

    The status is a warning if the tracker has reasons to doubt its estimates.
    """
    message = DiagnosticArray()
    fill_header(message.header, frame, time)
    doubts = following.doubts
    status = DiagnosticStatus()
    status.level = DiagnosticStatus.WARN if doubts else DiagnosticStatus.OK
    status.name, status.message = "stickslip", "; ".join(doubts)
    status.values = [_key_value(key, text) for key, text in words(estimate) + _counts(following)]
    message.status = [status]
    return message


def words(estimate: dict[str, float]) -> list[tuple[str, str]]:
    """Returns friction, contacts, spreads and health of an estimate as text."""
    return [(name, f"{value:.6g}") for name, value in estimate.items() if name not in PLACED and not math.isnan(value)]


def _counts(following: Following) -> list[tuple[str, str]]:
    return [
        ("observed", " ".join(following.observed)),
        ("collapses", str(following.collapses)),
        ("late_rows", str(following.late)),
        ("refused_rows", str(following.refused)),
        ("restarts", str(following.restarts)),
    ]


def _key_value(key: str, value: str) -> KeyValue:
    message = KeyValue()
    message.key, message.value = key, value
    return message


def _fill_place(position: Any, orientation: Any, estimate: dict[str, float]) -> None:
    position.x, position.y = estimate["x"], estimate["y"]
    orientation.z, orientation.w = math.sin(estimate["theta"] / 2), math.cos(estimate["theta"] / 2)
