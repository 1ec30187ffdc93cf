"""Bodies of a scene as markers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker, MarkerArray

from stickslip import Outlines, Polygons

#: Width of a line (m).
WIDTH = 0.001

#: Colours of object and fixels: red, green, blue.
OBJECT, FIXEL = (0.0, 0.45, 0.7), (0.6, 0.6, 0.6)


def scene(outlines: Outlines, frame: str, child: str) -> MarkerArray:
    """Returns the fixels in ``frame``, and the object in ``child``, the frame of the estimate.

    The object is locked to its frame: viewers move it with each transform.
    """
    message = MarkerArray()
    message.markers = _outline("object", outlines.object, child, OBJECT)
    for k, fixel in enumerate(outlines.fixels, 1):
        message.markers += _outline(f"fixel_{k}", fixel, frame, FIXEL)
    return message


def _outline(name: str, polygons: Polygons, frame: str, colour: tuple[float, float, float]) -> list[Marker]:
    """Returns one closed line per part of a body."""
    return [_line(name, part, [*polygon, polygon[0]], frame, colour) for part, polygon in enumerate(polygons)]


def _line(name: str, part: int, corners: Iterable[Any], frame: str, colour: tuple[float, float, float]) -> Marker:
    marker = Marker()
    # a stamp of zero asks for the newest transform
    marker.header.frame_id = frame
    marker.ns, marker.id = name, part
    marker.type, marker.action, marker.frame_locked = Marker.LINE_STRIP, Marker.ADD, True
    marker.pose.orientation.w = 1.0
    marker.scale.x = WIDTH
    marker.color.r, marker.color.g, marker.color.b, marker.color.a = *colour, 1.0
    for x, y in corners:
        point = Point()
        point.x, point.y = float(x), float(y)
        marker.points.append(point)
    return marker
