"""Importer of tables with any column names."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stickslip._columns import Columns
from stickslip._native import Error
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._streams import unwrapped

#: Column of the file, or a column and the factor that converts it to SI units.
Source = str | tuple[str, float]


def import_csv(
    file: str | os.PathLike[str],
    scene: str,
    out: str | os.PathLike[str],
    columns: Mapping[str, Source],
    *,
    delimiter: str = ",",
    missing: tuple[str, ...] = ("", "nan", "NaN"),
) -> Path:
    """Writes the experiment folder ``out`` of a table with a header.

    ``columns``: the file's column for each column of ``log.csv``, with a factor if it is not in SI
    units::

        {"time": ("stamp_ms", 1e-3), "object_x": ("x_mm", 1e-3), "object_theta": ("yaw_deg", np.pi / 180), ...}

    Pose columns that are not named (the pusher's angle, for example) are 0. ``missing``: cells that
    mean a missing measurement; a pose is missing if one of its numbers is. Angles are unwrapped.
    Time starts at 0.
    """
    read = {name: _column(Path(file), source, delimiter, missing) for name, source in columns.items()}
    for name in ("time", "object_x", "object_y", "pusher_x", "pusher_y"):
        if name not in read:
            raise Error(f"columns names no `{name}`; a log has at least time, object_x, object_y, pusher_x, pusher_y")
    log: Columns = {"time": read.pop("time")}
    log["time"] = log["time"] - log["time"][0]
    for body in ("object", "pusher"):
        names = [f"{body}_{axis}" for axis in ("x", "y", "theta")]
        pose = [read.pop(name, np.zeros(len(log["time"]))) for name in names]
        gone = np.isnan(pose).any(axis=0)
        pose[2] = pose[2].copy()
        pose[2][~gone] = unwrapped(pose[2][~gone], 2 * np.pi)
        log |= {name: np.where(gone, np.nan, column) for name, column in zip(names, pose, strict=True)}
    return write_experiment(out, scene, log | read, {"source": Path(file).name})


def _column(file: Path, source: Source, delimiter: str, missing: tuple[str, ...]) -> NDArray[np.float64]:
    name, factor = (source, 1.0) if isinstance(source, str) else source
    with file.open(encoding="utf-8", newline="") as open_file:
        reader = csv.DictReader(open_file, delimiter=delimiter)
        if name not in (reader.fieldnames or []):
            raise Error(f"{file}: there is no column `{name}`; there are {', '.join(reader.fieldnames or [])}")
        values = []
        for line, row in enumerate(reader, start=2):
            cell = (row[name] or "").strip()
            try:
                values.append(np.nan if cell in missing else factor * float(cell))
            except ValueError as error:
                raise Error(f"{file}:{line}: column `{name}`: {cell!r} is no number") from error
    return np.asarray(values, dtype=np.float64)
