"""Importers of the recordings of J. Zhou and M. T. Mason (CMU)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._columns import Columns
from stickslip._native import Error, Scene
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._scene import uniform_plate
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


#: Runs of the published table: time of each log, by its folder.
_RUNS = {
    "bigrect_3pts/bigrect_3pts_20_neg30_90": ["05-23_22-05-15", "05-23_22-09-16", "05-23_22-10-46"],
    "bigrect_3pts/bigrect_3pts_30_50_60": ["05-23_22-15-52", "05-23_22-17-27"],
    "bigrect_3pts/bigrect_3pts_60_20_150": ["05-23_22-22-55", "05-23_22-24-39", "05-23_22-25-24"],
    "bigrect_ridge/bigrect_ridge_20_neg30_90": ["05-23_21-24-11", "05-23_21-27-06"],
    "bigrect_ridge/bigrect_ridge_30_50_60": ["05-23_21-35-34", "05-23_21-44-48", "05-23_21-46-02"],
    "bigrect_ridge/bigrect_ridge_60_20_150": ["05-23_21-52-29", "05-23_21-55-51"],
    "butter/butter_20_neg10_30": ["05-24_12-15-49", "05-24_12-21-04", "05-24_12-22-08"],
    "butter/butter_60_20_135": ["05-24_12-25-31", "05-24_12-27-05"],
    "butter/butter_neg30_10_90": ["05-24_12-09-43", "05-24_12-11-45", "05-24_12-12-31"],
    "tri/tri_0_0_90": ["05-23_20-25-09", "05-23_20-28-32"],
    "tri/tri_30_50_45": ["05-23_20-34-37", "05-23_20-37-08", "05-23_20-39-08"],
    "tri/tri_neg50_20_180": ["05-23_20-48-46", "05-23_20-50-37"],
}
#: Scale and shift (m) of object positions that make camera and robot agree.
_CORRECTIONS = {"bigrect": (1.0, (1e-4, 1.3e-3)), "butter": (0.9779, (7e-4, 1.4e-3)), "tri": (1.0, (0.0, 0.0))}


def two_finger_scene(polygon: ArrayLike, *, position_std: float, orientation_std: float) -> str:
    """Returns the text of ``scene.toml`` for a plate pushed by the two fingers of ``robot_exp_logs``.

    ``polygon``: corners (K, 2) in m, counter-clockwise. Mass, friction and support are guesses: the
    data tell none of them. Camera latency is 0.16 s, as the stops of the hand show.
    """
    mass = 0.05
    corners, _, inertia = uniform_plate(polygon, mass)
    fingers = [{"disc": {"radius": 0.0025, "centre": [0.0, side * 0.009]}} for side in (1, -1)]
    return Scene.from_numbers(
        gravity=9.81,
        object={"mass": mass, "inertia": inertia, "shape": [{"polygon": corners}]},
        support={"friction": 0.3, "tripod_radius": np.sqrt(inertia / mass)},
        pusher={"shape": fingers, "friction": 0.3},
        fixels={"friction": 0.25},
        camera={"position_std": position_std, "orientation_std": orientation_std, "latency": 0.16},
    ).text


def import_two_finger_set(
    logs: str | os.PathLike[str], out: str | os.PathLike[str], butter: str | None = None
) -> list[Path]:
    """Writes the pushes of ``docs/results.md`` below ``out``, from the folder ``robot_exp_logs``.

    ``logs`` is what :func:`fetch` returns for ``two-finger``. Without ``butter``, the text of a scene
    with the outline of the butterfly, its 16 of 70 pushes are left out.
    """
    scenes = {
        "bigrect": two_finger_scene(
            [[0.0, 0.0], [0.05, 0.0], [0.05, 0.035], [0.0, 0.035]], position_std=4e-4, orientation_std=0.005
        ),
        "tri": two_finger_scene([[0.0, 0.0], [0.0, 0.0275], [-0.058, 0.0]], position_std=1e-3, orientation_std=0.015),
        "butter": butter,
    }
    pushes: list[Path] = []
    for folder, runs in _RUNS.items():
        condition = Path(folder).name
        kind = condition.split("_")[0]
        scene, (scale, shift) = scenes[kind], _CORRECTIONS[kind]
        if scene is None:
            continue
        for run, time in enumerate(runs, start=1):
            file = Path(logs) / folder / f"log2017-{time}.txt"
            if not file.is_file():
                raise Error(f'{file} is missing; give the folder robot_exp_logs that fetch("two-finger") returns')
            target = Path(out) / f"{condition}_{run}"
            pushes += import_two_finger(file, scene, target, scale=scale, shift=shift, single_pushes=True)
    return pushes


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
