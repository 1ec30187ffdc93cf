"""Outlines of a scene's bodies for drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._native import Scene
from stickslip._toml import tomllib

#: Number of corners of the polygon that approximates a disc or an ellipse.
_CORNERS = 48

#: Closed polygons (K, 2) in m, one per part.
Polygons = list[NDArray[np.float64]]


@dataclass(frozen=True)
class Outlines:
    """Bodies of a scene: object and fingers in their own frames, fixels in the world frame."""

    object: Polygons
    pusher: Polygons
    fixels: list[Polygons]
    #: Other fingers of a hand.
    fingers: list[Polygons]


def outlines(scene: Scene) -> Outlines:
    """Returns the bodies of a scene as polygons (K, 2) in m, one per part."""
    bodies = tomllib.loads(scene.text)
    fixels = [
        placed(_parts(fixel["shape"]), (*fixel["position"], fixel.get("angle", 0.0)))
        for fixel in bodies.get("fixel", [])
    ]
    fingers = [_parts(finger["shape"]) for finger in bodies.get("finger", [])]
    return Outlines(_parts(bodies["object"]["shape"]), _parts(bodies["pusher"]["shape"]), fixels, fingers)


def placed(polygons: Polygons, pose: ArrayLike) -> Polygons:
    """Returns the polygons of a body moved to ``pose`` (x, y in m, theta in rad)."""
    x, y, theta = np.asarray(pose, dtype=np.float64)
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    return [polygon @ turn.T + [x, y] for polygon in polygons]


def _parts(parts: list[dict[str, Any]]) -> Polygons:
    return [_polygon(part) for part in parts]


def _polygon(part: dict[str, Any]) -> NDArray[np.float64]:
    if "polygon" in part:
        return np.asarray(part["polygon"], dtype=np.float64)
    angle = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
    if "disc" in part:
        body, axes = part["disc"], (part["disc"]["radius"],) * 2
    else:
        body, axes = part["ellipse"], part["ellipse"]["semi_axes"]
    around = np.column_stack([axes[0] * np.cos(angle), axes[1] * np.sin(angle)])
    (polygon,) = placed([around], (*body.get("centre", (0.0, 0.0)), body.get("angle", 0.0)))
    return polygon
