"""Resumable runs of logs x settings x seeds on many workers, by joblib's backends.

A study is a folder with one file per finished task. A second start runs only the missing tasks. A
task that fails, or whose worker dies, is listed with its error and repeated at the next start.
Needs ``pip install 'stickslip[study]'``.

>>> from stickslip import study
>>> tasks = study.grid(folders, {"particles": [100, 500]}, seeds=20)  # doctest: +SKIP
>>> rows = study.run(tasks, "my-study", workers=8)  # doctest: +SKIP
>>> study.to_parquet(rows, "my-study.parquet")  # doctest: +SKIP
"""

from __future__ import annotations

import hashlib
import importlib
import itertools
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip._compare import compare
from stickslip._native import Error

try:
    import joblib
except ImportError as error:
    raise ImportError(
        "stickslip.study runs on joblib, which is not installed. Install it: pip install 'stickslip[study]'"
    ) from error

__all__ = ["Task", "grid", "run", "score_folder", "to_parquet"]

#: Keyword arguments of one run, which JSON can represent.
Task = dict[str, Any]

#: Number of dead workers after which the task itself counts as failed.
_ATTEMPTS = 3


def grid(
    folders: Iterable[str | os.PathLike[str]],
    settings: Mapping[str, Sequence[Any]] | None = None,
    *,
    seeds: int = 1,
) -> list[Task]:
    """Returns one task for :func:`score_folder` per folder, combination of settings and seed.

    ``settings``: see :class:`stickslip.FilterOptions`.
    """
    names = list(settings or {})
    choices = itertools.product(*(settings or {}).values())
    combinations = [dict(zip(names, choice, strict=True)) for choice in choices]
    return [
        {"folder": os.fspath(folder), "seed": seed, **combination}
        for folder in folders
        for combination in combinations
        for seed in range(seeds)
    ]


def score_folder(folder: str, seed: int = 0, variant: str = "particle", **options: Any) -> dict[str, Any]:
    """Scores one variant on one folder, on one thread (see :func:`stickslip.compare`)."""
    own: Any = {"threads": 1, **options, "seed": seed}
    rows = compare([folder], variants=[variant], **own)
    if not rows:
        raise Error(f"{folder}: the variant `{variant}` does not differ from the others here; leave it out")
    return rows[0]


def run(
    tasks: Sequence[Task],
    folder: str | os.PathLike[str],
    *,
    function: Callable[..., dict[str, Any]] = score_folder,
    workers: int = -1,
    backend: str = "loky",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Runs ``function(**task)`` for every task that has no result in ``folder`` yet.

    ``function``: importable by workers; returns a dict that JSON can represent. ``workers``: number
    of workers, -1 for one per processor. ``backend``: ``loky`` (processes, the default),
    ``threading``, or one that is registered with joblib: ``ray`` (registered here if Ray is
    installed), ``dask``. ``progress``: True to print progress on standard error.

    Returns the rows of all tasks in their order. A row has the task's items, updated with those of
    its result, or ``error`` with the reason. Results do not depend on backend or workers.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{_key(function, task)}.json" for task in tasks]
    if len(set(files)) < len(files):
        twice = next(task for k, task in enumerate(tasks) if files[k] in files[:k])
        raise Error(f"the task {twice} is there twice; give each task once")
    for file in files:
        for ending in (".error", ".tries"):
            file.with_suffix(ending).unlink(missing_ok=True)
    _register(backend)
    jobs = {file: joblib.delayed(_run_one)(function, task, str(file)) for task, file in zip(tasks, files, strict=True)}
    while pending := [file for file in files if not _outcome(file)]:
        _say(progress, f"{len(files) - len(pending)} of {len(files)} tasks are done")
        fresh = [file for file in pending if not _tries(file)]
        if fresh:
            failure = _run_together([jobs[file] for file in fresh], backend, workers, progress)
            if not any(map(_tries, fresh)) and not any(map(_outcome, fresh)):
                name = f"{function.__module__}.{function.__qualname__}"
                raise Error(
                    f"the backend `{backend}` ran no task ({failure}); is it installed, and can workers import {name}?"
                ) from failure
            continue
        # unfinished tasks of a dead worker run one at a time: only the task at fault is lost
        for file in pending:
            _run_together([jobs[file]], backend, 2, progress)
            if not _outcome(file) and _tries(file) >= _ATTEMPTS:
                _write(file.with_suffix(".error"), {"error": f"its worker died {_ATTEMPTS} times"})
    outcomes = [_outcome(file) or file for file in files]
    rows = [task | json.loads(file.read_text("utf-8")) for task, file in zip(tasks, outcomes, strict=True)]
    failed = sum("error" in row for row in rows)
    _say(progress, f"{len(rows) - failed} of {len(rows)} tasks are done, {failed} failed")
    return rows


def to_parquet(rows: Sequence[Mapping[str, Any]], path: str | os.PathLike[str]) -> None:
    """Writes rows as a Parquet file, a column per name; null if a row has no such item."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = list(dict.fromkeys(name for row in rows for name in row))
    pq.write_table(pa.table({name: [row.get(name) for row in rows] for name in names}), os.fspath(path))


def _key(function: Callable[..., Any], task: Task) -> str:
    """Returns the name of a task's file, which depends on the function and the items."""
    name = f"{function.__module__}.{function.__qualname__}"
    return hashlib.sha256(json.dumps([name, task], sort_keys=True).encode()).hexdigest()[:24]


def _run_together(jobs: list[Any], backend: str, workers: int, progress: bool) -> Exception | None:
    """Gives jobs to workers; returns the reason if a worker dies, with its jobs not done."""
    try:
        with joblib.parallel_config(backend=backend, n_jobs=workers):
            joblib.Parallel()(jobs)
    except Exception as error:  # joblib, loky and Ray have different errors for a dead worker
        _say(progress, f"a worker died ({type(error).__name__}); its unfinished tasks are repeated")
        return error
    return None


def _run_one(function: Callable[..., dict[str, Any]], task: Task, file: str) -> None:
    """Runs a task in a worker and writes its result or its error."""
    path = Path(file)
    with path.with_suffix(".tries").open("a", encoding="utf-8") as tries:
        tries.write("1")
    try:
        _write(path, function(**task))
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        _write(path.with_suffix(".error"), {"error": reason, "traceback": traceback.format_exc()})
    path.with_suffix(".tries").unlink(missing_ok=True)


def _write(path: Path, value: Mapping[str, Any]) -> None:
    """Writes a file completely or not at all."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_text(json.dumps(value), encoding="utf-8")
    part.replace(path)


def _tries(file: Path) -> int:
    """Returns the number of times that a task was begun and not finished."""
    tries = file.with_suffix(".tries")
    return tries.stat().st_size if tries.exists() else 0


def _outcome(file: Path) -> Path | None:
    """Returns the file of a task's result or error, if it exists."""
    return next((path for path in (file, file.with_suffix(".error")) if path.exists()), None)


def _register(backend: str) -> None:
    if backend == "ray":
        importlib.import_module("ray.util.joblib").register_ray()


def _say(progress: bool, text: str) -> None:
    if progress:
        print(f"study: {text}", file=sys.stderr)
