"""Readers of scenes, logs, bags and truths."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from stickslip import _native
from stickslip._columns import Columns, columns_of
from stickslip._native import Error, Scene

#: Topics of a bag by ``object``, ``pusher``, ``wrench``, ``fixel_1``, ``fixel_2``, ...
Topics: TypeAlias = "Mapping[str, str | Sequence[str] | None]"


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """Reads a scene file.

    Raises :class:`stickslip.Error` with file, line, value, rule and next step if the scene is
    invalid, and OSError if the file cannot be read.
    """
    path = path_of(path, "the scene")
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise Error(f"{path}: the scene is not UTF-8 text ({error.reason}). Save it as plain text") from error
    return Scene(text, str(path))


def load_log(
    path: str | os.PathLike[str],
    *,
    scene: Scene | str | os.PathLike[str] | None = None,
    topics: Topics | None = None,
) -> Columns:
    """Reads a log: ``log.csv``, an MCAP recording, the folder of a bag, or an experiment folder.

    ``scene``: for bags with tags or force sensors, gives the poses of tags on object and pusher and
    the force of a touch. ``topics``: topics of a bag if they have other names, as
    ``{"object": "/tf:table.tag_7", "pusher": "/arm/tool0"}``. A body may have several frames, in a
    list. An empty text leaves ``wrench`` out. :func:`stickslip.info` lists what there is.

    Returns the columns of ``log.csv``, each (rows,): ``time`` (s), ``object_x``, ``object_y`` (m),
    ``object_theta`` (rad), ``pusher_x``, ``pusher_y``, ``pusher_theta``, and if present
    ``tactile_1``, ... (0 or 1), ``pusher_force_x``, ``pusher_force_y`` (N). NaN is a missing
    measurement. Lost parts of a bag are issued as :class:`stickslip.Warning`.
    """
    path, mappings = path_of(path, "the log"), _mappings(topics)
    path.stat()
    return _native.read_log(path, None if scene is None else scene_of(scene), mappings)


def info(bag: str | os.PathLike[str]) -> dict[str, Any]:
    """Describes a bag, as ``stickslip info --json``.

    Returns ``topics`` (name, type, messages, rate, gap), ``poses`` (what moves), ``suggestion``
    (topics for a log, as ``KEY=TOPIC``) and ``commands`` to continue with.
    """
    path = path_of(bag, "the bag")
    path.stat()
    described: dict[str, Any] = json.loads(_native.bag_info(path))
    return described


def load_truth(path: str | os.PathLike[str]) -> Columns:
    """Reads ``truth.csv``: ``time`` (s), ``x``, ``y`` (m), ``theta`` (rad), ..., each (rows,)."""
    path = path_of(path, "the truth")
    with path.open(encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        try:
            table = np.loadtxt(file, delimiter=",", ndmin=2)
        except ValueError as error:
            raise Error(f"{path}: {error}") from error
    if table.shape[1] != len(names):
        raise Error(f"{path}: the header names {len(names)} columns and the rows have {table.shape[1]} cells")
    return {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(names)}


def experiments(folder: Path, scene_name: str) -> list[Path]:
    """Returns the folder, or the experiment folders below it in the order of their names."""

    def is_one(path: Path) -> bool:
        return any((path / name).is_file() for name in (scene_name, "log.csv", "log.mcap"))

    found = [folder] if is_one(folder) else sorted(path for path in folder.rglob("*") if is_one(path))
    return found or [folder]


def path_of(given: Any, what: str) -> Path:
    """Returns a path; refuses what is none."""
    try:
        return Path(given)
    except TypeError as error:
        raise Error(f"{what} is {given!r}; give a path") from error


def scene_of(scene: Scene | str | os.PathLike[str]) -> Scene:
    """Returns a scene as it is, or reads it from its file."""
    return scene if isinstance(scene, Scene) else load_scene(scene)


def log_of(log: Any, scene: Scene | None = None, topics: Topics | None = None) -> Columns:
    """Returns the columns of a log given as a path, a mapping or a data frame."""
    if isinstance(log, str | os.PathLike):
        return load_log(log, scene=scene, topics=topics)
    return columns_of(log, "the log")


def _mappings(topics: Topics | None) -> list[str]:
    """Returns topics as the program takes them."""
    if not isinstance(topics, Mapping | None):
        raise Error(f'topics is {topics!r}; give a dict of topics, as {{"object": "/tf:table.tag_7"}}')
    named = [(key, names if isinstance(names, list | tuple) else [names]) for key, names in (topics or {}).items()]
    return [f"{key}={name or ''}" for key, names in named for name in names]
