"""Simulation of many pushes at once."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import _native
from stickslip._columns import numbers
from stickslip._files import scene_of
from stickslip._native import Error, Scene
from stickslip._options import Progress

#: Names of the friction parameters, in the order of arrays.
FRICTION = ("mu_s", "mu_p", "mu_f", "d_tri")


class Rollout(TypedDict):
    """N trajectories of T steps."""

    #: Poses of the object (N, T + 1, 3): x, y (m), theta (rad); the start first.
    pose: NDArray[np.float64]
    #: Twists of the object (N, T + 1, 3): vx, vy (m/s), omega (rad/s).
    twist: NDArray[np.float64]
    #: Steps without a certified solution (N,).
    unsolved: NDArray[np.uint32]
    #: Vector from the pusher's final position to its commanded one (m), (N, 2); 0 unless it yields.
    pusher_lag: NDArray[np.float64]
    #: Largest length of this vector after any step (m), (N,).
    most_pusher_lag: NDArray[np.float64]


def rollout(
    scene: Scene | str | os.PathLike[str],
    states: ArrayLike,
    pusher: ArrayLike,
    friction: Mapping[str, ArrayLike] | None = None,
    *,
    h: float = 1.0 / 30.0,
    threads: int | None = None,
    out: Rollout | None = None,
    progress: Progress | None = None,
) -> Rollout:
    """Simulates N pushes over T steps of ``h`` seconds by the certified contact dynamics.

    ``states``: start of the object, (N, 6): x, y (m), theta (rad), vx, vy (m/s), omega (rad/s), or
    (N, 3): poses at rest. ``pusher``: commanded poses at the ends of steps, (N, T + 1, 3), or
    (T + 1, 3) for all: x, y (m), theta (rad); for a hand, those of the other fingers follow, (N, T +
    1, 3 F) with F fingers. The pusher moves straight between them, and yields if the scene has a
    stall force. ``friction``: ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m), each a
    number or (N,); the scene's values by default. ``out``: a rollout of the same shape, whose poses
    and twists are overwritten. ``progress``: gets the finished trajectories and all trajectories.

    The interpreter's lock is released. C-ordered float64 arrays are read in place, and results are
    written directly into the returned arrays. A trajectory depends only on its own start, friction
    and pusher: the bits are the same for any N and any number of threads. Ctrl-C ends the call.

    Raises :class:`stickslip.Error` if shapes do not match or a number is out of range.
    """
    scene = scene_of(scene)
    start = numbers(states, "states")
    if start.ndim != 2 or start.shape[1] not in (3, 6):
        raise Error(f"states has the shape {start.shape}; it must be (N, 6), or (N, 3) for poses at rest")
    count = len(start)
    if start.shape[1] == 3:
        start = np.hstack([start, np.zeros((count, 3))])
    pushers = numbers(pusher, "pusher")
    if pushers.ndim == 2:
        pushers = pushers[np.newaxis]
    width = 3 * (1 + scene.fingers)
    if pushers.ndim != 3 or pushers.shape[2] != width or len(pushers) not in (1, count) or pushers.shape[1] < 2:
        raise Error(
            f"pusher has the shape {np.shape(pusher)}; it must be ({count}, T + 1, {width}), or (T + 1, {width}) for "
            "all, with T at least 1"
        )
    shape = (count, pushers.shape[1], 3)
    pose, twist = (np.empty(shape), np.empty(shape)) if out is None else _overwritten(out, shape, start, pushers)
    given = {
        "h": h,
        "threads": threads,
        "states": start,
        "friction": _frictions(scene, friction or {}, count),
        "pushers": pushers,
        "poses": pose,
        "twists": twist,
    }
    ends = _native.rollout(scene, given, progress)
    return {
        "pose": pose,
        "twist": twist,
        "unsolved": ends["unsolved"],
        "pusher_lag": ends["pusher_lag"],
        "most_pusher_lag": ends["most_pusher_lag"],
    }


def _overwritten(
    out: Rollout, shape: tuple[int, int, int], *inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the poses and twists of an earlier rollout, if they can take the numbers of this one."""
    arrays: list[NDArray[np.float64]] = []
    for name in ("pose", "twist"):
        array: object = out.get(name)
        if not isinstance(array, np.ndarray) or array.dtype != np.float64 or array.shape != shape:
            found = (
                f"{array.dtype} of the shape {array.shape}" if isinstance(array, np.ndarray) else type(array).__name__
            )
            raise Error(f"out: `{name}` is {found}; it must be float64 of this rollout's shape {shape}")
        if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
            raise Error(f"out: `{name}` must be writable, aligned and in C order; give the result of a rollout")
        if any(np.may_share_memory(array, other) for other in (*arrays, *inputs)):
            raise Error(f"out: `{name}` has memory in common with another array; give arrays of their own")
        arrays.append(array)
    return arrays[0], arrays[1]


def _frictions(scene: Scene, given: Mapping[str, ArrayLike], count: int) -> NDArray[np.float64]:
    """Returns the friction of each trajectory (N, 4)."""
    nominal = scene.friction
    unknown = sorted(set(given) - set(FRICTION))
    if unknown:
        raise Error(f"friction has a `{unknown[0]}`; it may have {', '.join(FRICTION)}")
    if "d_tri" in given and np.isnan(nominal["d_tri"]):
        raise Error("friction has a `d_tri`, but the scene's feet are known; leave it out")
    friction = np.empty((count, len(FRICTION)))
    for k, name in enumerate(FRICTION):
        values = numbers(given[name], f"friction: `{name}`") if name in given else np.nan_to_num(nominal[name])
        if np.shape(values) not in ((), (1,), (count,)):
            raise Error(f"friction: `{name}` has the shape {np.shape(values)}; it must be a number or ({count},)")
        if not np.all((values >= 0) & np.isfinite(values)):
            raise Error(f"friction: `{name}` has a value that is negative or not finite")
        friction[:, k] = values
    return friction
