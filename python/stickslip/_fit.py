"""What many pushes teach."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _native
from stickslip._columns import Columns, Log
from stickslip._files import experiments, load_log, load_scene, log_in, log_of
from stickslip._native import Scene
from stickslip._simulate import Simulation

#: What a push may be given as: its experiment folder, a simulation, or a scene and a log.
Push = str | os.PathLike[str] | Simulation | tuple[Scene, Log]


@dataclass(frozen=True)
class Fit:
    """What some pushes taught."""

    #: Names of what was learnt, in the order of all arrays; a name like ``pusher_offset`` stands for two, x and y.
    names: tuple[str, ...]
    #: Values that predict best; the first guess where the pushes teach nothing of one (spread over 0.8 of the prior's).
    values: dict[str, float]
    #: Standard deviations of those, in the same unit (m, s, or none); the prior's where nothing was learnt.
    stds: dict[str, float]
    #: First guesses.
    prior_values: dict[str, float]
    #: Standard deviations of the first guesses, at the guess.
    prior_stds: dict[str, float]
    #: Whether the pushes left less than half of the prior's spread.
    determined: dict[str, bool]
    #: Correlation in the posterior (P, P).
    correlation: NDArray[np.float64]
    #: Draws of the posterior by name, and of ``camera_scale`` and ``drift``, each (512,); k-th ones belong together.
    draws: dict[str, NDArray[np.float64]]
    #: Errors on pushes left out, as ``cross_validation`` of ``fit.json`` has them; None where none was left out.
    cross_validation: dict[str, Any] | None
    #: The first push's scene with the learnt values and their spreads in place, the first guesses where
    #: ``cross_validation["pays"]`` is false; ``scene.text`` is the file.
    scene: Scene
    #: All numbers, under the names of ``fit.json``; ``["parameters"][k]["constant"]`` is the constant of material or
    #: support that the k-th value imitates, with its 90 % interval, or None.
    result: dict[str, Any]


def fit(
    pushes: str | os.PathLike[str] | Iterable[Push],
    free: Sequence[str] = ("mu_p", "tripod_radius"),
    *,
    seed: int = 0,
    folds: int | None = None,
    scene_name: str = "scene.toml",
    threads: int | None = None,
) -> Fit:
    """Learns from many pushes of one object on one table what their scene cannot know.

    ``pushes``: experiment folders (``scene.toml``, ``log.csv`` or ``log.mcap``), folders of such folders, what
    :func:`stickslip.simulate` returned, or pairs of a scene and a log; at least two pushes. All scenes must start
    from the same first guess. ``free``: what to learn, of ``mu_s``, ``mu_p``, ``mu_f``, ``tripod_radius``,
    ``centre_of_friction``, ``outline_scale``, ``outline_offset``, ``pusher_offset``, ``latency``. ``folds``: parts that
    the pushes are dealt into, each to be predicted by a fit to the others; 0: none; None: 4, 2 for fewer than 8
    pushes, 0 for fewer than 4. The numbers have the bits of the program's ``fit.json``, on any number of threads.

    Raises :class:`stickslip.Error` where a push or a name cannot be used.
    """
    given = [pushes] if isinstance(pushes, str | os.PathLike) else list(pushes)
    read = [push for item in given for push in _pushes(item, scene_name)]
    options = {"free": list(free), "seed": seed, "folds": folds, "threads": threads}
    learnt, validation, draws, text = _native.fit(
        [(f"push {k}" if name is None else name, scene, log) for k, (name, scene, log) in enumerate(read)], options
    )
    result = json.loads(learnt)
    result["cross_validation"] = json.loads(validation)
    learnt_values = {fitted["name"]: fitted for fitted in result["parameters"]}

    def by_name(key: str) -> dict[str, Any]:
        return {name: fitted[key] for name, fitted in learnt_values.items()}

    return Fit(
        names=tuple(learnt_values),
        values=by_name("value"),
        stds=by_name("std"),
        prior_values=by_name("prior_value"),
        prior_stds=by_name("prior_std"),
        determined=by_name("determined"),
        correlation=np.array(result["correlation"]),
        draws=draws,
        cross_validation=result["cross_validation"],
        scene=Scene(text, read[0][1].name),
        result=result,
    )


def _pushes(item: Push, scene_name: str) -> list[tuple[str | None, Scene, Columns]]:
    if isinstance(item, Simulation):
        return [(None, item.scene, item.log)]
    if isinstance(item, tuple):
        scene, log = item
        return [(None, scene, log_of(log))]
    return [
        (folder.name, load_scene(folder / scene_name), load_log(log_in(folder)))
        for folder in experiments(Path(item), scene_name)
    ]
