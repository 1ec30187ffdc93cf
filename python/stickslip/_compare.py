"""Comparison of all methods on experiment folders."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _native
from stickslip._columns import Columns
from stickslip._files import Topics, experiments, load_log, load_scene, load_truth, path_of
from stickslip._filter import filter
from stickslip._native import Error, Scene
from stickslip._options import FilterOptions, arguments, with_options
from stickslip._page import Page, run_of
from stickslip._score import score

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Options of each variant: method, use of tactile readings, and ``camera_on`` for no occlusion.
_VARIANTS: dict[str, dict[str, Any]] = {
    "nominal": {"method": "nominal"},
    "kalman": {"method": "kalman"},
    "extended_kalman": {"method": "extended-kalman"},
    "particle_no_tactile": {"tactile": False},
    "particle": {},
    "particle_always_on": {"camera_on": True},
}


class Comparison(list[dict[str, Any]]):
    """Runs of :func:`compare`, a dict each. A notebook shows the :meth:`page`."""

    def __init__(
        self,
        rows: Iterable[dict[str, Any]],
        experiments: Iterable[_Experiment] = (),
        options: FilterOptions | None = None,
    ) -> None:
        super().__init__(rows)
        self._experiments = list(experiments)
        self._options = options or FilterOptions()

    def page(self) -> Page:
        """Returns the page of ``stickslip compare --report``.

        Its players are of the logs with the largest errors, which are run again with seed 0.
        """
        on = [experiment.given(self._options) for experiment in self._experiments]
        return Page(_native.comparison_page(self, on, arguments(self._options)))

    def _repr_html_(self) -> str:
        return self.page()._repr_html_()


@with_options
def compare(
    folders: Iterable[str | os.PathLike[str]],
    *,
    seeds: int = 1,
    variants: Iterable[str] = tuple(_VARIANTS),
    scene_name: str = "scene.toml",
    scene: Mapping[str, Any] | None = None,
    topics: Topics | None = None,
    **options: Unpack[FilterOptions],
) -> Comparison:
    """Runs each variant on each experiment folder and scores it.

    ``folders``: experiment folders, or folders that contain such folders. ``seeds``: number of
    seeds of each particle filter, from ``seed`` on. ``variants``: ``nominal``, ``kalman``,
    ``extended_kalman``, ``particle_no_tactile``, ``particle``, ``particle_always_on`` (no
    occlusion). ``particle_no_tactile`` is left out for a log without tactile columns, and
    ``particle_always_on`` for a log without hidden rows. ``scene``: values that replace those of
    each scene, as :meth:`Scene.replace` takes them. ``topics``: see :func:`stickslip.load_log`.

    ``options`` give the hidden rows; the default is ``occlude_from`` of ``truth.json``. Scores are
    against ``truth.csv`` if it exists, else against the log's own poses. ``progress`` gets finished
    runs and all runs.

    Returns a dict per run: ``folder``, ``variant``, ``seed``, the scores of
    :func:`stickslip.score`, ``unsolved`` (steps of particles), and ``warnings``, ``observed``,
    ``log_evidence`` and ``collapses`` of :class:`stickslip.Estimate`. ``page()`` of the whole is
    the page of ``stickslip compare --report``.
    """
    chosen = list(variants)
    unknown = sorted(set(chosen) - set(_VARIANTS))
    if unknown:
        raise Error(f"variants has a `{unknown[0]}`; it may have {', '.join(_VARIANTS)}")
    progress = options.pop("progress", None)
    paths = [inner for folder in folders for inner in experiments(path_of(folder, "a folder"), scene_name)]
    read = [_Experiment.read(path, scene_name, scene or {}, topics, options) for path in paths]
    first = options.get("seed", 0)
    runs = [
        (experiment, variant, seed)
        for experiment in read
        for variant in chosen
        if experiment.differs(variant)
        for seed in range(first, first + (seeds if variant.startswith("particle") else 1))
    ]
    rows = []
    for done, (experiment, variant, seed) in enumerate(runs):
        try:
            rows.append(experiment.run(variant, seed, options))
        except Error as error:
            raise Error(f"{experiment.folder}: {error}") from error
        if progress is not None:
            progress(done + 1, len(runs))
    return Comparison(rows, read, options)


@dataclass(frozen=True)
class _Experiment:
    """An experiment folder, read, and its hidden rows."""

    folder: Path
    scene: Scene
    log: Columns
    truth: Columns | None
    facts: dict[str, Any]
    hiding: FilterOptions

    @classmethod
    def read(
        cls,
        folder: Path,
        scene_name: str,
        values: Mapping[str, Any],
        topics: Topics | None,
        options: FilterOptions,
    ) -> _Experiment:
        scene = load_scene(folder / scene_name)
        scene = scene.replace(**values) if values else scene
        log = load_log(folder, scene=scene, topics=topics)
        truth = load_truth(folder / "truth.csv") if (folder / "truth.csv").is_file() else None
        known = folder / "truth.json"
        facts = json.loads(known.read_text(encoding="utf-8")) if known.is_file() else {}
        hiding = FilterOptions(occlude=options.get("occlude"), occlude_middle=options.get("occlude_middle"))
        if hiding == {"occlude": None, "occlude_middle": None}:
            hiding["occlude"] = facts.get("occlude_from")
        return cls(folder, scene, log, truth, facts, hiding)

    def differs(self, variant: str) -> bool:
        """Returns False if the variant is the same as another one here."""
        hides = any(value is not None for value in self.hiding.values())
        return (variant != "particle_no_tactile" or "tactile_1" in self.log) and (
            variant != "particle_always_on" or hides
        )

    def given(self, options: FilterOptions) -> dict[str, Any]:
        """Returns the experiment as the library takes it."""
        known = {"name": str(self.folder), "truth": self.truth, "facts": json.dumps(self.facts) if self.facts else None}
        return run_of(self.log, self.scene, FilterOptions(**{**options, **self.hiding}), **known)

    def run(self, variant: str, seed: int, options: FilterOptions) -> dict[str, Any]:
        """Runs a variant and scores it."""
        own = dict(_VARIANTS[variant])
        seen = {"occlude": None, "occlude_middle": None}
        hidden = seen if own.pop("camera_on", False) else self.hiding
        run: Any = {**options, **hidden, **own, "seed": seed}
        estimate = filter(self.log, self.scene, **run)
        scores = score(
            estimate,
            self.log,
            self.scene,
            truth=self.truth,
            first_pusher_contact=self.facts.get("first_pusher_contact"),
            occlude=self.hiding.get("occlude"),
            occlude_middle=self.hiding.get("occlude_middle"),
        )
        return {
            "folder": str(self.folder),
            "variant": variant,
            "seed": seed,
            **scores,
            "warnings": list(estimate.warnings),
            "observed": estimate.observed,
            "log_evidence": estimate.log_evidence,
            "collapses": estimate.collapses,
            "unsolved": int(np.nansum(estimate["unsolved"])),
        }
