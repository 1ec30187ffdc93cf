"""Resumable runs of logs x settings x seeds on many workers, by joblib's backends.

A study is a folder with one file per finished task. A second start runs only the missing tasks. A
task that fails, or whose worker dies, is listed with its error and repeated at the next start. A
result counts for the bytes of its scene and log and for this version of the program: if one of them
changes, the task runs again. Workers send their results to the driver, which alone writes files.
Needs ``pip install 'stickslip[study]'``.

>>> from stickslip import study
>>> tasks = study.grid(folders, {"particles": [100, 500]}, seeds=20)  # doctest: +SKIP
>>> rows = study.run(tasks, "my-study", workers=8)  # doctest: +SKIP
>>> study.medians(rows, by=["particles"])  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
import itertools
import json
import os
import sys
import time
import traceback
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip._compare import compare
from stickslip._native import Error
from stickslip._options import Progress
from stickslip._study_key import Task, keys
from stickslip._study_statistics import flat, medians, paired

try:
    import joblib
except ImportError as error:
    raise ImportError(
        "stickslip.study runs on joblib, which is not installed. Install it: pip install 'stickslip[study]'"
    ) from error

__all__ = ["Task", "grid", "medians", "paired", "run", "score_folder", "status", "to_parquet", "watch"]

#: Number of dead workers after which the task itself counts as failed.
_ATTEMPTS = 3

#: Tasks per worker between two times that a backend without a stream returns results.
_CHUNK = 8

#: Time between two lines of progress (s).
_PAUSE = 10.0


def grid(
    folders: Iterable[str | os.PathLike[str]],
    settings: Mapping[str, Sequence[Any]] | None = None,
    *,
    scene: Mapping[str, Sequence[Any]] | None = None,
    seeds: int = 1,
) -> list[Task]:
    """Returns one task for :func:`score_folder` per folder, combination of settings and seed.

    ``settings``: see :class:`stickslip.FilterOptions`. ``scene``: values of scene keys, as
    ``{"pusher.friction": [0.2, 0.3]}``; see :meth:`stickslip.Scene.replace`.
    """
    combinations = [
        own | ({"scene": values} if values else {}) for own in _combined(settings) for values in _combined(scene)
    ]
    return [
        {"folder": os.fspath(folder), "seed": seed, **combination}
        for folder in folders
        for combination in combinations
        for seed in range(seeds)
    ]


def _combined(choices: Mapping[str, Sequence[Any]] | None) -> list[dict[str, Any]]:
    names = list(choices or {})
    return [dict(zip(names, chosen, strict=True)) for chosen in itertools.product(*(choices or {}).values())]


def score_folder(
    folder: str, seed: int = 0, variant: str = "particle", scene: Mapping[str, Any] | None = None, **options: Any
) -> dict[str, Any]:
    """Scores one variant on one folder, on one thread (see :func:`stickslip.compare`)."""
    own: Any = {"threads": 1, **options, "seed": seed}
    rows = compare([folder], variants=[variant], scene=scene, **own)
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
    progress: bool | Progress = True,
) -> list[dict[str, Any]]:
    """Runs ``function(**task)`` for every task that has no result in ``folder`` yet.

    ``function``: importable by workers; returns a dict that JSON can represent. ``workers``: number
    of workers, -1 for one per processor. ``backend``: ``loky`` (processes, the default),
    ``threading``, or one that is registered with joblib: ``ray`` (registered here if Ray is
    installed), ``dask``. ``progress``: True to print progress on standard error, or a function of
    the finished tasks and all tasks.

    Returns the rows of all tasks in their order. A row has the task's items, updated with those of
    its result, or ``error`` with the reason. Results do not depend on backend or workers.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files = _files(tasks, folder, function)
    if len(set(files)) < len(files):
        twice = next(task for k, task in enumerate(tasks) if files[k] in files[:k])
        raise Error(f"the task {twice} is there twice; give each task once")
    for file in files:
        file.with_suffix(".error").unlink(missing_ok=True)
    if backend == "ray":
        importlib.import_module("ray.util.joblib").register_ray()
    pending = [k for k, file in enumerate(files) if not file.exists()]
    report = _Report(progress, len(files), len(pending))

    def keep(k: int, outcome: str) -> None:
        failed = "error" in json.loads(outcome)
        _write(files[k].with_suffix(".error") if failed else files[k], outcome)
        report.add(failed)

    def begin(group: Sequence[int], size: int) -> Exception | None:
        jobs = [joblib.delayed(_run_one)(k, function, tasks[k]) for k in group]
        return _run_together(jobs, backend, size, keep)

    # after a death the unfinished tasks run in halves, until the task at fault is alone
    groups, deaths = deque([pending] if pending else []), Counter[int]()
    while groups:
        group = groups.popleft()
        failure = begin(group, workers if len(group) > 1 else 2)
        left = [k for k in group if not _outcome(files[k])]
        if failure is None or not left:
            continue
        if report.done == report.before:
            _probe(function, backend, failure)
        report.say(f"a worker died ({type(failure).__name__}); its unfinished tasks are repeated")
        if len(left) > 1:
            groups.extend((left[: len(left) // 2], left[len(left) // 2 :]))
            continue
        deaths[left[0]] += len(group) == 1
        if deaths[left[0]] < _ATTEMPTS:
            groups.append(left)
        else:
            keep(left[0], json.dumps({"error": f"its worker died {_ATTEMPTS} times"}))
    outcomes = [_outcome(file) or file for file in files]
    rows = [task | json.loads(file.read_text("utf-8")) for task, file in zip(tasks, outcomes, strict=True)]
    report.end()
    return rows


def status(
    tasks: Sequence[Task],
    folder: str | os.PathLike[str],
    *,
    function: Callable[..., dict[str, Any]] = score_folder,
) -> dict[str, int]:
    """Returns the number of tasks that are ``done``, ``failed`` and ``missing`` in a study's folder.

    It only reads, and can be called from another process while the study runs.
    """
    outcomes = [_outcome(file) for file in _files(tasks, Path(folder), function)]
    failed = sum(file is not None and file.suffix == ".error" for file in outcomes)
    missing = outcomes.count(None)
    return {"done": len(outcomes) - failed - missing, "failed": failed, "missing": missing}


def watch(
    tasks: Sequence[Task],
    folder: str | os.PathLike[str],
    *,
    function: Callable[..., dict[str, Any]] = score_folder,
    interval: float = _PAUSE,
) -> dict[str, int]:
    """Prints the :func:`status` every ``interval`` (s) until no task is missing; returns the last one."""
    while True:
        found = status(tasks, folder, function=function)
        print(f"study: {found['done']} of {len(tasks)} tasks are done, {found['failed']} failed", file=sys.stderr)
        if not found["missing"]:
            return found
        time.sleep(interval)


def to_parquet(rows: Sequence[Mapping[str, Any]], path: str | os.PathLike[str]) -> None:
    """Writes rows as a Parquet file, a column per name; null if a row has no such item.

    Items of an item, such as ``observed``, have columns of their own: ``observed.mu_p``.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = [flat(row) for row in rows]
    names = list(dict.fromkeys(name for row in table for name in row))
    pq.write_table(pa.table({name: [row.get(name) for row in table] for name in names}), os.fspath(path))


def _files(tasks: Sequence[Task], folder: Path, function: Callable[..., Any]) -> list[Path]:
    """Returns the file of each task's result."""
    return [folder / f"{key}.json" for key in keys(f"{function.__module__}.{function.__qualname__}", tasks)]


def _run_together(jobs: list[Any], backend: str, workers: int, keep: Callable[[int, str], None]) -> Exception | None:
    """Gives jobs to workers and keeps outcomes as they come; returns the reason if a worker dies."""
    try:
        chosen = joblib.parallel_config(backend=backend, n_jobs=workers)
    except Exception as error:  # there is no such backend
        return error
    with chosen:
        outcomes = _outcomes(jobs, workers)
        while True:
            try:
                k, outcome = next(outcomes)
            except StopIteration:
                return None
            except Exception as error:  # joblib, loky and Ray have different errors for a dead worker
                return error
            keep(k, outcome)


def _outcomes(jobs: list[Any], workers: int) -> Iterator[tuple[int, str]]:
    """Yields the outcomes of jobs, from some backends in chunks."""
    if joblib.parallel.get_active_backend()[0].supports_return_generator:
        yield from joblib.Parallel(return_as="generator_unordered")(jobs)
        return
    size = _CHUNK * joblib.effective_n_jobs(workers)
    for first in range(0, len(jobs), size):
        yield from joblib.Parallel()(jobs[first : first + size])


def _probe(function: Callable[..., Any], backend: str, failure: Exception) -> None:
    """Raises an error if the backend runs no job at all."""
    try:
        with joblib.parallel_config(backend=backend, n_jobs=2):
            joblib.Parallel()([joblib.delayed(_nothing)(function)])
    except Exception as error:
        name = f"{function.__module__}.{function.__qualname__}"
        raise Error(
            f"the backend `{backend}` ran no task ({failure}); is it installed, and can workers import {name}?"
        ) from error


def _nothing(_: Callable[..., Any]) -> None:
    """Runs in a worker that can import the function."""


def _run_one(k: int, function: Callable[..., dict[str, Any]], task: Task) -> tuple[int, str]:
    """Runs a task in a worker; returns its number and its result or error as JSON."""
    try:
        return k, json.dumps(function(**task))
    except Exception as error:
        return k, json.dumps({"error": f"{type(error).__name__}: {error}", "traceback": traceback.format_exc()})


def _write(path: Path, text: str) -> None:
    """Writes a file completely or not at all."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)


def _outcome(file: Path) -> Path | None:
    """Returns the file of a task's result or error, if it exists."""
    return next((path for path in (file, file.with_suffix(".error")) if path.exists()), None)


class _Report:
    """Progress of a study."""

    def __init__(self, progress: bool | Progress, total: int, pending: int) -> None:
        self._progress, self._total, self._failed = progress, total, 0
        self.before = self.done = total - pending
        self._said = self._start = time.monotonic()
        self.say(f"{self.done} of {total} tasks are done")

    def add(self, failed: bool) -> None:
        """Counts a finished task."""
        self.done += 1
        self._failed += failed
        if callable(self._progress):
            self._progress(self.done, self._total)
        now = time.monotonic()
        if now - self._said >= _PAUSE:
            self._said = now
            left = (now - self._start) * (self._total - self.done) / (self.done - self.before)
            self.say(f"{self.done} of {self._total} tasks, {self._failed} failed; {left / 60:.0f} min left")

    def end(self) -> None:
        """Reports all tasks."""
        self.say(f"{self._total - self._failed} of {self._total} tasks are done, {self._failed} failed")

    def say(self, text: str) -> None:
        """Prints a line if lines are wanted."""
        if self._progress is True:
            print(f"study: {text}", file=sys.stderr)
