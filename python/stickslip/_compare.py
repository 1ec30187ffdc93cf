"""Comparison of all methods on experiment folders."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Unpack

from stickslip._files import experiments, load_log, load_scene, load_truth, log_in
from stickslip._filter import FilterOptions, filter
from stickslip._native import Error
from stickslip._score import score

#: Options of each variant: method, use of tactile readings, and ``camera_on`` for no occlusion.
_VARIANTS: dict[str, dict[str, Any]] = {
    "nominal": {"method": "nominal"},
    "kalman": {"method": "kalman"},
    "extended_kalman": {"method": "extended-kalman"},
    "particle_no_tactile": {"tactile": False},
    "particle": {},
    "particle_always_on": {"camera_on": True},
}


def compare(
    folders: Iterable[str | os.PathLike[str]],
    *,
    seeds: int = 1,
    variants: Iterable[str] = tuple(_VARIANTS),
    scene_name: str = "scene.toml",
    **options: Unpack[FilterOptions],
) -> list[dict[str, Any]]:
    """Runs each variant on each experiment folder and scores it.

    ``folders``: experiment folders, or folders that contain such folders. ``seeds``: number of
    seeds of each particle filter, from ``seed`` on. ``variants``: ``nominal``, ``kalman``,
    ``extended_kalman``, ``particle_no_tactile``, ``particle``, ``particle_always_on`` (no
    occlusion). ``particle_no_tactile`` is left out for a log without tactile columns, and
    ``particle_always_on`` for a log without hidden rows.

    ``options`` give the hidden rows; the default is ``occlude_from`` of ``truth.json``. Scores are
    against ``truth.csv`` if it exists, else against the log's own poses.

    Returns a dict per run: ``folder``, ``variant``, ``seed``, and the scores of
    :func:`stickslip.score`.
    """
    chosen = list(variants)
    unknown = sorted(set(chosen) - set(_VARIANTS))
    if unknown:
        raise Error(f"variants has a `{unknown[0]}`; it may have {', '.join(_VARIANTS)}")
    found = [inner for folder in folders for inner in experiments(Path(folder), scene_name)]
    return [row for folder in found for row in _on(folder, chosen, seeds, scene_name, options)]


def _on(folder: Path, variants: list[str], seeds: int, scene_name: str, options: FilterOptions) -> list[dict[str, Any]]:
    scene = load_scene(folder / scene_name)
    log = load_log(log_in(folder))
    truth = load_truth(folder / "truth.csv") if (folder / "truth.csv").is_file() else None
    known = folder / "truth.json"
    facts = json.loads(known.read_text(encoding="utf-8")) if known.is_file() else {}
    hiding: dict[str, Any] = {name: options.get(name) for name in ("occlude", "occlude_middle")}
    if hiding == {"occlude": None, "occlude_middle": None}:
        hiding["occlude"] = facts.get("occlude_from")
    hides = any(value is not None for value in hiding.values())
    rows = []
    for variant in variants:
        if (variant == "particle_no_tactile" and "tactile_1" not in log) or (
            variant == "particle_always_on" and not hides
        ):
            continue
        own = dict(_VARIANTS[variant])
        hidden = {} if own.pop("camera_on", False) else hiding
        first = options.get("seed", 0)
        for seed in range(first, first + (seeds if variant.startswith("particle") else 1)):
            run: Any = {**options, "occlude": None, "occlude_middle": None, **hidden, **own, "seed": seed}
            scores = score(
                filter(log, scene, **run),
                log,
                scene,
                truth=truth,
                first_pusher_contact=facts.get("first_pusher_contact"),
                **hiding,
            )
            rows.append({"folder": str(folder), "variant": variant, "seed": seed, **scores})
    return rows
