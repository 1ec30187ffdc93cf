"""Quality of service of the topics."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

#: Reliability of the inputs, by the value of the parameter.
RELIABILITY = {"best_effort": ReliabilityPolicy.BEST_EFFORT, "reliable": ReliabilityPolicy.RELIABLE}

#: Messages that a subscriber gets also if it starts later.
LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def of_inputs(reliability: str, depth: int) -> QoSProfile:
    """Returns the profile of the input topics; ``depth`` is the number of messages that wait."""
    if reliability not in RELIABILITY:
        raise ValueError(f"reliability is `{reliability}`; it must be best_effort or reliable")
    if depth < 1:
        raise ValueError(f"depth is {depth}; it must be at least 1")
    return QoSProfile(depth=depth, reliability=RELIABILITY[reliability])
