"""Text of scene files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._columns import numbers
from stickslip._native import Error, Scene
from stickslip._toml import tomllib


def uniform_plate(polygon: ArrayLike, mass: float) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Returns the frame and the inertia of a plate of equal thickness.

    ``polygon``: corners (K, 2) in m, counter-clockwise. ``mass`` in kg. Returns the polygon moved
    to the centre of mass as origin (K, 2), that centre in the given frame (2,), and the moment of
    inertia about it (kg m^2).
    """
    a = numbers(polygon, "polygon")
    if a.ndim != 2 or a.shape[1] != 2 or len(a) < 3:
        raise Error(f"the polygon has the shape {a.shape}; it must be (K, 2) with K at least 3")
    b = np.roll(a, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = 0.5 * cross.sum()
    if not area > 0:
        raise Error(f"the polygon's area is {area} m^2; give its corners counter-clockwise")
    centre = ((a + b) * cross[:, None]).sum(axis=0) / (6 * area)
    a, b = a - centre, b - centre
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    second = (cross * ((a * a) + (a * b) + (b * b)).sum(axis=1)).sum() / 12
    return a, centre, float(mass * second / area)


def scene_text(
    shape: Sequence[str] | str,
    *,
    mass: float,
    inertia: float,
    pusher_radius: float,
    friction: float = 0.3,
    pusher_friction: float = 0.3,
    tripod_radius: float | None = None,
    position_std: float = 5e-4,
    orientation_std: float = 5e-3,
    latency: float = 0.0,
) -> str:
    """Returns the text of a ``scene.toml`` for an object pushed by a round finger, without fixels.

    ``shape``: convex parts in TOML, such as ``"{ disc = { radius = 0.03 } }"``, or rows of corners
    as from :func:`uniform_plate`, in the frame of the centre of mass. Friction values and
    ``tripod_radius`` (m; the radius of gyration by default) are first guesses. The filter adapts
    them, and ``stickslip fit`` learns them.
    """
    parts = [shape] if isinstance(shape, str) else list(shape)
    if parts and not isinstance(parts[0], str):
        outline: list[Any] = [{"polygon": numbers(parts, "shape")}]
    else:
        outline = tomllib.loads(f"shape = [ {', '.join(parts)} ]")["shape"]
    scene = Scene.from_numbers(
        gravity=9.81,
        object={"mass": mass, "inertia": inertia, "shape": outline},
        support={
            "friction": friction,
            "tripod_radius": np.sqrt(inertia / mass) if tripod_radius is None else tripod_radius,
        },
        pusher={"shape": [{"disc": {"radius": pusher_radius}}], "friction": pusher_friction},
        fixels={"friction": 0.25},
        camera={"position_std": position_std, "orientation_std": orientation_std, "latency": latency},
    )
    return scene.text
