"""Importers of the recordings of J. Zhou and M. T. Mason (CMU)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stickslip._columns import Columns
from stickslip._native import Error
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._streams import Stream, unwrapped

#: Longest time without rows while the hand is on the table (s).
_LIFTED = 0.5


def import_two_finger(
    file: str | os.PathLike[str],
    scene: str,
    out: str | os.PathLike[str],
    *,
    scale: float = 1.0,
    shift: tuple[float, float] = (0.0, 0.0),
    centre: tuple[float, float] = (0.0, -0.3175),
    single_pushes: bool = False,
) -> list[Path]:
    """Writes the experiment folder of one run of ``robot_exp_logs`` (ISRR 2017).

    The files are those of PlanarManipulationToolBox. With ``single_pushes``, each push of the run
    becomes a folder ``out-1``, ``out-2``, ...

    ``file``: rows of time (s), the object's x, y (mm), theta (rad), the hand's, and the pushed
    edge, without a header. The first row is a stale message and is dropped. Object poses of zeros
    are lost ones and become empty. Angles are unwrapped. The file has no rows while the hand is
    lifted. They are filled at 30 Hz with empty cells, so that the hand does not sweep through the
    object. ``centre``, ``scale``, ``shift`` correct a disagreement of camera and robot: object
    positions p become ``centre`` + ``scale`` (p - ``centre``) + ``shift`` (m).
    """
    table = _table(Path(file), 8)[1:]
    if not len(table):
        raise Error(f"{file} has one row; the first is dropped, so a run needs more")
    lost = (table[:, 1:4] == 0).all(axis=1)
    poses = table[:, 1:7] * np.array([1e-3, 1e-3, 1.0, 1e-3, 1e-3, 1.0])
    middle = np.asarray(centre)
    poses[:, :2] = middle + scale * (poses[:, :2] - middle) + np.asarray(shift)
    poses[~lost, 2] = unwrapped(poses[~lost, 2], 2 * np.pi)
    poses[:, 5] = unwrapped(poses[:, 5], 2 * np.pi)
    poses[lost, :3] = np.nan
    time = table[:, 0] - table[0, 0]
    breaks = np.flatnonzero(np.diff(time) > _LIFTED) + 1
    if not single_pushes:
        return [_write(out, scene, *_filled(time, poses, breaks), file)]
    parts = zip(np.split(time, breaks), np.split(poses, breaks), strict=True)
    return [
        _write(f"{os.fspath(out)}-{push}", scene, times - times[0], part, file)
        for push, (times, part) in enumerate(parts, start=1)
    ]


def read_alternating(file: str | os.PathLike[str]) -> Stream:
    """Reads a file of MLab_EXP whose odd lines are times (s) and whose even lines are numbers.

    ``pos*.txt`` and ``robot*.txt`` of ``exp3`` and ``exp4`` have x, y, z (mm) and a quaternion w,
    x, y, z. :func:`planar` makes poses of them, with the calibration of the tracked body, and
    :func:`log_of_streams` makes a log. ``force*.txt`` has forces (N) in the sensor's frame.
    """
    lines = Path(file).read_text(encoding="utf-8").split("\n")
    lines = [line for line in lines if line.strip()]
    try:
        rows = [[float(at), *map(float, numbers.split())] for at, numbers in zip(lines[::2], lines[1::2], strict=True)]
    except ValueError as error:
        raise Error(f"{file}: its lines must be a time and numbers in turn ({error})") from error
    if len({len(row) for row in rows}) > 1:
        raise Error(f"{file}: its rows differ in length; is it cut off?")
    return Stream.of(rows, str(file))


def _table(file: Path, columns: int) -> NDArray[np.float64]:
    try:
        table = np.loadtxt(file, delimiter=",", ndmin=2)
    except ValueError as error:
        raise Error(f"{file}: {error}") from error
    if table.shape[1] != columns:
        raise Error(f"{file} has {table.shape[1]} columns; a run has {columns}")
    return table


def _filled(
    time: NDArray[np.float64], poses: NDArray[np.float64], breaks: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Adds rows of NaN at 30 Hz while the hand is lifted."""
    times, rows = [], []
    for begin, end in zip([0, *breaks], [*breaks, len(time)], strict=True):
        if begin > 0:
            lifted = np.arange(time[begin - 1] + 1 / 30, time[begin] - 1 / 60, 1 / 30)
            times.append(lifted)
            rows.append(np.full((len(lifted), 6), np.nan))
        times.append(time[begin:end])
        rows.append(poses[begin:end])
    return np.concatenate(times), np.concatenate(rows)


def _write(
    out: str | os.PathLike[str],
    scene: str,
    time: NDArray[np.float64],
    poses: NDArray[np.float64],
    file: str | os.PathLike[str],
) -> Path:
    names = [f"{body}_{name}" for body in ("object", "pusher") for name in ("x", "y", "theta")]
    log: Columns = {"time": np.ascontiguousarray(time)}
    log |= {name: np.ascontiguousarray(poses[:, k]) for k, name in enumerate(names)}
    return write_experiment(out, scene, log, {"source": Path(file).name, "note": "no ground truth"})
