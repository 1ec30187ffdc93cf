"""Readers of scenes, logs and truths."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from stickslip import _native
from stickslip._columns import Columns, columns_of
from stickslip._native import Error, Scene


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """Reads a scene file.

    Raises :class:`stickslip.Error` with file, line, value, rule and next step if the scene is
    invalid, and OSError if the file cannot be read.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise Error(f"{path}: the scene is not UTF-8 text ({error.reason}). Save it as plain text") from error
    return Scene(text, str(path))


def load_log(path: str | os.PathLike[str]) -> Columns:
    """Reads ``log.csv`` or ``log.mcap``, as the file's ending says.

    Returns the columns of ``log.csv``, each (rows,): ``time`` (s), ``object_x``, ``object_y`` (m),
    ``object_theta`` (rad), ``pusher_x``, ``pusher_y``, ``pusher_theta``, and if present
    ``tactile_1``, ... (0 or 1), ``pusher_force_x``, ``pusher_force_y`` (N). NaN is a missing
    measurement.
    """
    path = Path(path)
    return _native.read_log(path.read_bytes(), str(path))


def load_truth(path: str | os.PathLike[str]) -> Columns:
    """Reads ``truth.csv``: ``time`` (s), ``x``, ``y`` (m), ``theta`` (rad), ..., each (rows,)."""
    path = Path(path)
    with path.open(encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        try:
            table = np.loadtxt(file, delimiter=",", ndmin=2)
        except ValueError as error:
            raise Error(f"{path}: {error}") from error
    if table.shape[1] != len(names):
        raise Error(f"{path}: the header names {len(names)} columns and the rows have {table.shape[1]} cells")
    return {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(names)}


def log_in(folder: Path) -> Path:
    """Returns the path of the log of an experiment folder."""
    return folder / "log.csv" if (folder / "log.csv").is_file() else folder / "log.mcap"


def experiments(folder: Path, scene_name: str) -> list[Path]:
    """Returns the folder, or the experiment folders below it in the order of their names."""

    def is_one(path: Path) -> bool:
        return (path / scene_name).is_file() or log_in(path).is_file()

    found = [folder] if is_one(folder) else sorted(path for path in folder.rglob("*") if is_one(path))
    return found or [folder]


def scene_of(scene: Scene | str | os.PathLike[str]) -> Scene:
    """Returns a scene as it is, or reads it from its file."""
    return load_scene(scene) if isinstance(scene, str | os.PathLike) else scene


def log_of(log: Any) -> Columns:
    """Returns the columns of a log given as a path, a mapping or a data frame."""
    if isinstance(log, str | os.PathLike):
        return load_log(log)
    return columns_of(log, "the log")
