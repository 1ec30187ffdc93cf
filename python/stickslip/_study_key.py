"""Names of the results of a study."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from stickslip import _native
from stickslip._files import experiments
from stickslip._native import Error, __version__

#: Keyword arguments of one run, which JSON can represent.
Task: TypeAlias = dict[str, Any]


def keys(function: str, tasks: Sequence[Task]) -> list[str]:
    """Returns a name for the result of each task.

    It depends on the function's name, the task's items, the version of the program, and the bytes
    of the files that items name: a file, or scene, log and truth of an experiment folder.
    """
    known: dict[tuple[str, str], dict[str, str]] = {}

    def digests(task: Task) -> dict[str, str]:
        found: dict[str, str] = {}
        scene_name = str(task.get("scene_name", "scene.toml"))
        for value in task.values():
            if isinstance(value, str) and value:
                if (value, scene_name) not in known:
                    known[value, scene_name] = _digests(Path(value), scene_name)
                found |= known[value, scene_name]
        return found

    return [hashlib.sha256(_text([function, __version__, task, digests(task)])).hexdigest()[:24] for task in tasks]


def _text(value: Any) -> bytes:
    def plain(item: Any) -> Any:
        if isinstance(item, np.generic):
            return item.item()
        raise Error(f"a task has {item!r}; its items must be numbers, texts, lists and dicts")

    return json.dumps(value, sort_keys=True, default=plain).encode()


def _digests(path: Path, scene_name: str) -> dict[str, str]:
    """Returns the digests of the files that a path stands for; none if there is no such path."""
    try:
        if path.is_file():
            files = [path]
        elif path.is_dir():
            folders = experiments(path, scene_name)
            files = [file for folder in folders for file in _files(folder, scene_name)]
        else:
            files = []
    except OSError:  # a text that is no path, as one that is too long
        return {}
    return {str(file): _digest(file) for file in files if file.is_file()}


def _files(folder: Path, scene_name: str) -> list[Path]:
    own = [folder / name for name in (scene_name, "truth.csv", "truth.json")]
    try:
        return own + _native.log_files(folder)
    except Error:  # the task itself reports it
        return own


def _digest(file: Path) -> str:
    digest = hashlib.sha256()
    with file.open("rb") as bytes_:
        while part := bytes_.read(1 << 20):
            digest.update(part)
    return digest.hexdigest()
