"""Importers of the MIT pushing data set and of Omnipush."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._native import Error
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._streams import Stream, log_of_streams, planar


def import_mit(
    file: str | os.PathLike[str],
    scene: str,
    out: str | os.PathLike[str],
    *,
    rate: float = 30.0,
    symmetry: float | None = np.pi / 2,
    force_sign: float | None = None,
) -> Path:
    """Writes the experiment folder ``out`` of one push of the MIT pushing data set (Yu et al., IROS 2016).

    ``file``: JSON, or HDF5 (needs ``h5py``), with ``object_pose`` and ``tip_pose`` as rows of time
    (s), x, y (m), theta (rad), or of time, x, y, z and a quaternion x, y, z, w; and ``ft_wrench``
    as rows of time, fx, fy (N), torque. The streams are not synchronised, and the object's angle
    jumps by 90 and 180 degrees: see :func:`log_of_streams`. ``scene``: text of ``scene.toml``, with
    the object's frame of the data set, whose origin is the centre of mass. ``force_sign``: 1 if the
    forces act on the object, -1 if they act on the finger; None leaves them out.
    """
    streams = _read(Path(file))
    force = streams.get("force")
    if force_sign is None or force is None:
        force = None
    else:
        force = Stream(force.time, force_sign * force.value)
    log = log_of_streams(streams["object"], streams["pusher"], force, rate=rate, symmetry=symmetry)
    facts = {"source": Path(file).name, "note": "no ground truth: poses are the tracker's"}
    return write_experiment(out, scene, log, facts)


def import_omnipush(
    file: str | os.PathLike[str], scene: str, out: str | os.PathLike[str], *, rate: float = 30.0
) -> Path:
    """Writes the experiment folder ``out`` of one push of Omnipush (Bauza et al., IROS 2019).

    ``file``: HDF5 (needs ``h5py``) or JSON with ``object_pose`` and ``tip_pose`` as rows of time
    (s), x, y (m), yaw (rad). ``scene``: text of ``scene.toml``.
    """
    return import_mit(file, scene, out, rate=rate, symmetry=None)


#: Names of streams in files, singular in most, plural in some.
_NAMES = {
    "object": ("object_pose", "object_poses"),
    "pusher": ("tip_pose", "tip_poses"),
    "force": ("ft_wrench", "ft_wrenches"),
}


def _read(file: Path) -> dict[str, Stream]:
    if file.suffix in (".h5", ".hdf5"):
        try:
            import h5py
        except ImportError as error:
            raise Error(f"{file}: HDF5 needs the package h5py; pip install h5py") from error
        with h5py.File(file) as open_file:
            return _streams(file, lambda name: open_file[name][()] if name in open_file else None)
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise Error(f"{file}:{error.lineno}:{error.colno}: no JSON: {error.msg}") from error
    if not isinstance(data, dict):
        raise Error(f"{file}: the JSON is a {type(data).__name__}; it must be an object with `object_pose`, `tip_pose`")
    return _streams(file, data.get)


def _streams(file: Path, get: Callable[[str], Any]) -> dict[str, Stream]:
    found: dict[str, Stream] = {}
    for stream, names in _NAMES.items():
        rows = next((rows for rows in map(get, names) if rows is not None), None)
        if rows is not None:
            found[stream] = _stream(Stream.of(rows, f"{file}: {names[0]}"), stream, f"{file}: {names[0]}")
        elif stream != "force":
            raise Error(f"{file}: there is no `{names[0]}`; a push has `object_pose` and `tip_pose`")
    return found


def _stream(rows: Stream, stream: str, name: str) -> Stream:
    """Converts spatial poses to planar ones."""
    if stream == "force" or rows.value.shape[1] == 3:
        return rows
    if rows.value.shape[1] != 7:
        raise Error(f"{name} has rows of {1 + rows.value.shape[1]} numbers; they must have 4 or 8, time first")
    return Stream(rows.time, planar(rows.value[:, :3], np.roll(rows.value[:, 3:], 1, axis=1)))
