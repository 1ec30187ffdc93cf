"""Poses from transforms."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from stickslip_ros.planar import Pose, planar, seconds


class Transforms:
    """Reports each transform of a frame once."""

    def __init__(self, look_up: Callable[[], Any], take: Callable[[float, Pose], None]) -> None:
        self._look_up, self._take, self._latest = look_up, take, -math.inf

    def look(self) -> None:
        """Takes the newest transform if it is new."""
        found = self._look_up()
        if found is None or seconds(found.header.stamp) == self._latest:
            return
        self._latest = seconds(found.header.stamp)
        self._take(self._latest, planar(found.transform.translation, found.transform.rotation))
