"""Figures with matplotlib: ``pip install 'stickslip[plot]'``.

Each function draws on ``ax`` (None: new axes) and returns it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike, NDArray

from stickslip._columns import Log, numbers
from stickslip._files import log_of
from stickslip._native import Scene
from stickslip._outline import Polygons, outlines, placed
from stickslip._rollout import FRICTION

__all__ = ["errors", "friction", "particles", "poses", "scene"]

#: Colours of bodies and curves, from the colour-blind-safe palette of Okabe and Ito.
_BLUE, _ORANGE, _GREY = "#0072B2", "#D55E00", "#999999"


def scene(
    scene: Scene, *, object: ArrayLike | None = None, pusher: ArrayLike | None = None, ax: Axes | None = None
) -> Axes:
    """Draws the fixels, and the object and pusher at given poses (x, y in m, theta in rad).

    For a hand, the poses of the other fingers follow that of the pusher, (3 F,).
    """
    ax = _plane(ax)
    bodies = outlines(scene)
    for fixel in bodies.fixels:
        _draw(ax, fixel, color=_GREY, fill=True)
    if object is not None:
        _draw(ax, placed(bodies.object, object), color=_BLUE)
    if pusher is not None:
        places = numbers(pusher, "pusher").reshape(-1, 3)
        for finger, place in zip([bodies.pusher, *bodies.fingers], places, strict=False):
            _draw(ax, placed(finger, place), color=_ORANGE)
    ax.autoscale_view()
    return ax


def poses(
    estimate: Mapping[str, Any],
    scene: Scene,
    *,
    rows: Sequence[int] | None = None,
    log: Log | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draws the object's poses after ``rows`` (None: eight rows), later ones more opaque.

    The pusher is drawn too if its ``log`` is given.
    """
    ax = _plane(ax)
    bodies = outlines(scene)
    for fixel in bodies.fixels:
        _draw(ax, fixel, color=_GREY, fill=True)
    pose = np.column_stack([numbers(estimate[name], name) for name in ("x", "y", "theta")])
    seen = np.flatnonzero(np.isfinite(pose).all(axis=1))
    chosen = seen[np.linspace(0, len(seen) - 1, 8).astype(int)] if rows is None else np.asarray(rows, dtype=int)
    pushes = None if log is None else log_of(log)
    for share, row in zip(np.linspace(0.25, 1.0, len(chosen)), chosen, strict=True):
        _draw(ax, placed(bodies.object, pose[row]), color=_BLUE, alpha=float(share))
        if pushes is not None:
            at = [float(pushes[f"pusher_{name}"][row]) for name in ("x", "y", "theta")]
            if np.isfinite(at).all():
                _draw(ax, placed(bodies.pusher, at), color=_ORANGE, alpha=float(share))
    ax.autoscale_view()
    return ax


def errors(
    estimate: Mapping[str, Any], truth: Mapping[str, Any], *, intervals: float = 1.645, ax: Axes | None = None
) -> Axes:
    """Draws the distance (mm) of the estimate from the truth against time.

    The grey band has the length of ``intervals`` reported standard deviations (1.645: 90 % per
    axis).
    """
    ax = ax or plt.figure(layout="constrained").add_subplot()
    time = numbers(estimate["time"], "time")
    at = {name: np.interp(time, truth["time"], truth[name]) for name in ("x", "y")}
    away = 1e3 * np.hypot(estimate["x"] - at["x"], estimate["y"] - at["y"])
    spread = 1e3 * intervals * np.hypot(estimate["std_x"], estimate["std_y"])
    ax.fill_between(time, 0, spread, color=_GREY, alpha=0.4, label=f"{intervals:g} standard deviations")
    ax.plot(time, away, color=_BLUE, label="distance from the truth")
    _shade_dark(ax, time, estimate)
    ax.set(xlabel="time (s)", ylabel="distance (mm)", ylim=(0, None))
    ax.legend()
    return ax


def friction(estimate: Mapping[str, Any], *, names: Sequence[str] = FRICTION, ax: Axes | None = None) -> Axes:
    """Draws friction parameters over time with a band of one standard deviation; d_tri in cm."""
    ax = ax or plt.figure(layout="constrained").add_subplot()
    time = numbers(estimate["time"], "time")
    for name in names:
        value, std = (numbers(estimate[key], key) for key in (name, f"std_{name}"))
        if np.isnan(value).all():
            continue
        scale, label = (100.0, "d_tri (cm)") if name == "d_tri" else (1.0, name)
        (line,) = ax.plot(time, scale * value, label=label)
        ax.fill_between(time, scale * (value - std), scale * (value + std), color=line.get_color(), alpha=0.2)
    _shade_dark(ax, time, estimate)
    ax.set(xlabel="time (s)", ylim=(0, None))
    ax.legend()
    return ax


def particles(
    cloud: Mapping[str, NDArray[np.float64]], row: int, names: tuple[str, str] = ("x", "y"), *, ax: Axes | None = None
) -> Axes:
    """Draws two numbers of the particles after ``row`` against each other; areas show weights."""
    ax = ax or plt.figure(layout="constrained").add_subplot()
    (at,) = np.flatnonzero(np.asarray(cloud["row"]) == row)
    weight = cloud["weight"][at]
    across, up = names
    ax.scatter(cloud[across][at], cloud[up][at], s=2000 * weight, color=_BLUE, alpha=0.5, linewidths=0)
    ax.set(xlabel=across, ylabel=up)
    return ax


def _plane(ax: Axes | None) -> Axes:
    ax = ax or plt.figure(layout="constrained").add_subplot()
    ax.set(aspect="equal", xlabel="x (m)", ylabel="y (m)")
    return ax


def _draw(ax: Axes, polygons: Polygons, *, color: str, alpha: float = 1.0, fill: bool = False) -> None:
    for polygon in polygons:
        ax.add_patch(Polygon(polygon, fill=fill, edgecolor=color, facecolor=color, alpha=alpha))


def _shade_dark(ax: Axes, time: NDArray[np.float64], estimate: Mapping[str, Any]) -> None:
    """Shades the times without a camera pose."""
    dark = numbers(estimate["visual"], "visual") == 0
    if dark.any():
        ax.fill_between(time, 0, 1, where=dark, transform=ax.get_xaxis_transform(), color="black", alpha=0.06)
