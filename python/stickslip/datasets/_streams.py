"""Rows of a log from streams with different clocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._columns import Columns, numbers
from stickslip._native import Error

#: Longest time between two samples for interpolation (s), as in the format.
LONGEST_GAP = 0.2

#: Times that differ by less than this are equal (s).
_SAME = 1e-6


@dataclass(frozen=True)
class Stream:
    """Measurements of one sensor, with their times."""

    #: Time of each sample (s), (n,).
    time: NDArray[np.float64]
    #: Samples (n, k): poses x, y (m), theta (rad), or forces (N).
    value: NDArray[np.float64]

    @classmethod
    def of(cls, rows: ArrayLike, name: str) -> Stream:
        """Makes a stream of rows (n, 1 + k), time first: sorted, with the first of equal times."""
        table = numbers(rows, name)
        if table.ndim != 2 or table.shape[1] < 2 or not len(table):
            raise Error(f"{name} has the shape {table.shape}; it must be rows of a time and numbers, at least one")
        if not np.isfinite(table).all():
            (row, column), *_ = np.argwhere(~np.isfinite(table))
            raise Error(f"{name}: row {row}, number {column} is {table[row, column]}; all must be finite")
        _, first = np.unique(table[:, 0], return_index=True)
        return cls(table[first, 0], table[first, 1:])


def log_of_streams(
    object: Stream,
    pusher: Stream,
    force: Stream | None = None,
    *,
    rate: float = 30.0,
    symmetry: float | None = None,
    start: float | None = None,
) -> Columns:
    """Makes a log of streams that are not synchronised.

    The log has rows at ``rate`` (Hz) while both object and pusher are recorded. Poses are
    interpolated over at most 0.2 s; a longer gap gives NaN. ``force`` (world frame, on the object)
    is the mean over the interval that ends at the row. Angles are unwrapped. ``symmetry`` (rad):
    rotation that maps the object to itself, pi / 2 for a square; jumps by multiples of it are
    removed. ``start``: time that becomes 0, by default that of the first row.
    """
    if not rate > 0:
        raise Error(f"rate is {rate} Hz; it must be above 0")
    first = max(object.time[0], pusher.time[0])
    last = min(object.time[-1], pusher.time[-1])
    if last <= first:
        raise Error(
            f"the object is recorded from {object.time[0]} to {object.time[-1]} s and the pusher from "
            f"{pusher.time[0]} to {pusher.time[-1]} s; they must overlap. Are both by one clock?"
        )
    time = first + np.arange(int(np.floor((last - first) * rate + 1e-9)) + 1) / rate
    period = 2 * np.pi if symmetry is None else symmetry
    poses = {"object": _poses(object, time, period), "pusher": _poses(pusher, time, 2 * np.pi)}
    log = {"time": time - (first if start is None else start)}
    for body, pose in poses.items():
        log |= {f"{body}_{name}": np.ascontiguousarray(pose[:, k]) for k, name in enumerate(("x", "y", "theta"))}
    if force is not None:
        mean = _means(force, time, rate)
        log |= {"pusher_force_x": mean[:, 0].copy(), "pusher_force_y": mean[:, 1].copy()}
    return log


def planar(position: ArrayLike, quaternion: ArrayLike, body: ArrayLike | None = None) -> NDArray[np.float64]:
    """Projects spatial poses to planar ones (n, 3).

    ``position`` (n, 3), in any unit of length, and ``quaternion`` (n, 4) as w, x, y, z: the tracked
    frame. ``body`` (4, 4): pose of the object in the tracked frame, in the same unit, if the two
    differ.
    """
    place = numbers(position, "position")
    w, x, y, z = np.moveaxis(numbers(quaternion, "quaternion"), -1, 0)
    scale = 2 / (w * w + x * x + y * y + z * z)
    turn = np.stack(
        [
            np.stack([1 - scale * (y * y + z * z), scale * (x * y - w * z), scale * (x * z + w * y)], -1),
            np.stack([scale * (x * y + w * z), 1 - scale * (x * x + z * z), scale * (y * z - w * x)], -1),
            np.stack([scale * (x * z - w * y), scale * (y * z + w * x), 1 - scale * (x * x + y * y)], -1),
        ],
        axis=-2,
    )
    offset = np.eye(4) if body is None else numbers(body, "body")
    place = place + turn @ offset[:3, 3]
    turn = turn @ offset[:3, :3]
    return np.column_stack([place[:, 0], place[:, 1], np.arctan2(turn[:, 1, 0], turn[:, 0, 0])])


def unwrapped(theta: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """Removes jumps by multiples of ``period`` (rad) from angles (n,)."""
    return np.asarray(np.unwrap(theta, period=period), dtype=np.float64)


def _poses(stream: Stream, time: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    value = stream.value.copy()
    value[:, 2] = unwrapped(value[:, 2], period)
    pose = np.column_stack([np.interp(time, stream.time, value[:, k]) for k in range(3)])
    later = np.searchsorted(stream.time, time).clip(0, len(stream.time) - 1)
    earlier = (later - 1).clip(0)
    off = np.minimum(np.abs(time - stream.time[later]), np.abs(time - stream.time[earlier]))
    pose[(stream.time[later] - stream.time[earlier] > LONGEST_GAP) & (off > _SAME)] = np.nan
    return pose


def _means(stream: Stream, time: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Averages the samples in (t - 1 / rate, t] of each row; NaN without samples."""
    ends = np.searchsorted(stream.time, time, side="right")
    begins = np.searchsorted(stream.time, time - 1 / rate, side="right")
    sums = np.vstack([np.zeros(2), np.cumsum(stream.value[:, :2], axis=0)])
    count = ends - begins
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray((sums[ends] - sums[begins]) / count[:, None])
