"""Pages about runs, for browsers and notebooks."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip import _native
from stickslip._columns import Columns, Log, columns_of
from stickslip._files import load_truth, log_of, scene_of
from stickslip._native import Error, Scene
from stickslip._options import FilterOptions, arguments, with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Page(str):
    """Text of an HTML page that loads nothing. A notebook shows it in a frame."""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the page to a file and returns its path."""
        file = Path(path)
        file.write_text(self, encoding="utf-8")
        return file

    def __repr__(self) -> str:
        return f"<Page of {len(self) / 1000:.0f} kB: save() it, or show it in a notebook>"

    def _repr_html_(self) -> str:
        style = "width: 100%; height: 46rem; border: 0"
        return f'<iframe title="stickslip" style="{style}" srcdoc="{html.escape(self)}"></iframe>'


def run_of(log: Columns, scene: Scene, options: FilterOptions, **known: Any) -> dict[str, Any]:
    """Returns an experiment and the options of a run on it, as the library takes them."""
    return {
        "name": "log",
        "log": log,
        "scene": scene,
        "truth": None,
        "facts": None,
        "options": arguments(options),
        **known,
    }


@with_options
def report(
    log: Log,
    scene: Scene | str | os.PathLike[str] | None = None,
    *,
    truth: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    **options: Unpack[FilterOptions],
) -> Page:
    """Runs a method on a log; returns the page of ``stickslip filter --report``, with a player.

    ``log``, ``scene``: see :func:`stickslip.filter`. Without a ``scene``, ``scene.toml`` in the
    log's folder counts. ``truth``: columns ``time``, ``x``, ``y``, ``theta``, or the path of
    ``truth.csv``; without it, ``truth.csv`` in the log's folder counts if it is there, else the
    log's own poses. ``truth.json`` in that folder gives the times of the first contacts.

    >>> stickslip.report("my/log.csv", occlude=60).save("page.html")  # doctest: +SKIP
    """
    known: dict[str, Any] = {}
    folder = None
    if isinstance(log, str | os.PathLike):
        path = Path(log)
        folder = path if path.is_dir() else path.parent
        known["name"] = path.resolve().parent.name if path.name.startswith("log.") else path.name
        facts = folder / "truth.json"
        known["facts"] = facts.read_text(encoding="utf-8") if facts.is_file() else None
        if truth is None and (folder / "truth.csv").is_file():
            truth = folder / "truth.csv"
    if scene is None:
        if folder is None:
            raise Error("the scene is missing; give it, or the path of a log with a scene.toml in its folder")
        scene = folder / "scene.toml"
    if isinstance(truth, str | os.PathLike):
        truth = load_truth(truth)
    known["truth"] = None if truth is None else columns_of(truth, "the truth")
    found = scene_of(scene)
    given = run_of(log_of(log, found), found, options, **known)
    return Page(_native.report(given, options.get("progress")))
