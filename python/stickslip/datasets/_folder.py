"""Writer of experiment folders."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stickslip import _native
from stickslip._columns import Columns, columns_of
from stickslip._native import Error, Scene


def write_experiment(
    folder: str | os.PathLike[str], scene: str, log: Columns, facts: Mapping[str, Any] | None = None
) -> Path:
    """Writes ``scene.toml`` (its text), ``log.csv`` and, with ``facts``, ``truth.json`` into a new folder.

    Raises :class:`stickslip.Error`, and writes nothing, if the scene or the log is invalid or the
    folder is not empty.
    """
    folder = Path(folder)
    Scene(scene, str(folder / "scene.toml"))
    text = _native.write_log(columns_of(log, "the log"))
    if folder.exists() and any(folder.iterdir()):
        raise Error(f"{folder} is not empty; give a new folder, so that nothing recorded is lost")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(scene, encoding="utf-8")
    if facts is not None:
        (folder / "truth.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    (folder / "log.csv").write_bytes(text)
    return folder
