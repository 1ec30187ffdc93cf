"""Scene parameters learnt from many pushes."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _native
from stickslip._columns import Columns, Log
from stickslip._files import Topics, experiments, load_log, load_scene, log_of, scene_of
from stickslip._native import Error, Scene
from stickslip._options import Progress
from stickslip._page import Page
from stickslip._simulate import Simulation

#: A push: its experiment folder, a simulation, or a scene and a log.
Push = str | os.PathLike[str] | Simulation | tuple[Scene | str | os.PathLike[str], Log]


@dataclass(frozen=True)
class Fit:
    """Result of :func:`fit`. A notebook shows the :meth:`page`."""

    #: Names of the parameters, in the order of all arrays; ``pusher_offset`` and the like are two,
    #: x and y.
    names: tuple[str, ...]
    #: Posterior means, of the logarithm for positive numbers.
    values: dict[str, float]
    #: Standard deviations, in the same unit (m, s, or none).
    stds: dict[str, float]
    #: Nominal values, the medians of the priors.
    prior_values: dict[str, float]
    #: Standard deviations of the priors at the nominal values.
    prior_stds: dict[str, float]
    #: True if the posterior's spread is less than half of the prior's.
    determined: dict[str, bool]
    #: Correlation in the posterior (P, P).
    correlation: NDArray[np.float64]
    #: Posterior draws by name, and of ``camera_scale`` and ``drift``, each (512,); k-th values are
    #: joint.
    draws: dict[str, NDArray[np.float64]]
    #: Errors on pushes left out, as ``cross_validation`` of ``fit.json``; None without such pushes.
    cross_validation: dict[str, Any] | None
    #: First push's scene with the learnt values and spreads, or with the nominal values if
    #: ``cross_validation["pays"]`` is false; ``scene.text`` is the file.
    scene: Scene
    #: All numbers, with the names of ``fit.json``; ``["parameters"][k]["interval_90"]`` has the ends
    #: of the k-th 90 % interval.
    result: dict[str, Any]
    #: Reasons to doubt the fit, each with the push that it is about.
    warnings: tuple[str, ...]
    _page: str = field(repr=False, compare=False)

    def page(self) -> Page:
        """Returns the page of ``stickslip fit --report``."""
        return Page(self._page)

    def _repr_html_(self) -> str:
        return self.page()._repr_html_()


def fit(
    pushes: str | os.PathLike[str] | Iterable[Push],
    free: Sequence[str] = (),
    *,
    seed: int = 0,
    folds: int | None = None,
    scene_name: str = "scene.toml",
    topics: Topics | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Learns unknown scene parameters from many pushes of one object on one table.

    Pushes of several objects are refused: the program's ``stickslip fit`` deals them by object.

    ``pushes``: at least two pushes, as experiment folders (``scene.toml``, ``log.csv`` or
    ``log.mcap``), folders of such folders, results of :func:`stickslip.simulate`, or pairs of a
    scene and a log, each also as a path: ``[("scene.toml", bag) for bag in bags]``. All scenes must
    have the same first guess. ``free``: parameters to learn, of ``mu_s``, ``mu_p``, ``mu_f``,
    ``tripod_radius``, ``centre_of_friction``, ``support``, ``outline_scale``, ``outline_offset``,
    ``pusher_offset``, ``latency``; none: ``mu_p`` and all that the first scene leaves open of
    ``support``. ``folds``: number of parts in the cross-validation, each predicted by a fit to the
    others; 0: none; None: 4, or 2 for fewer than 8 pushes, or 0 for fewer than 4. ``topics``: see
    :func:`stickslip.load_log`. ``progress``: gets the vectors of parameters tried and an upper
    limit of them, at which it ends.

    Reasons to doubt the fit are issued as :class:`stickslip.Warning` and kept as ``warnings``.
    Ctrl-C ends the call. The numbers have the bits of the program's ``fit.json``, on any number of threads.

    Raises :class:`stickslip.Error` if a push or a name is invalid.
    """
    given = [pushes] if isinstance(pushes, str | os.PathLike) else list(pushes)
    read = [push for item in given for push in _pushes(item, scene_name, topics)]
    options = {
        "free": [free] if isinstance(free, str) else list(free),
        "seed": seed,
        "folds": folds,
        "threads": threads,
    }
    learnt, validation, draws, text, warnings, page = _native.fit(
        [(f"push {k}" if name is None else name, scene, log) for k, (name, scene, log) in enumerate(read)],
        options,
        progress,
    )
    result = json.loads(learnt)
    result |= {"warnings": warnings, "cross_validation": json.loads(validation)}
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
        warnings=tuple(warnings),
        _page=page,
    )


def _pushes(item: Push, scene_name: str, topics: Topics | None) -> list[tuple[str | None, Scene, Columns]]:
    if isinstance(item, Simulation):
        return [(None, item.scene, item.log)]
    if isinstance(item, tuple) and len(item) == 2:
        scene = scene_of(item[0])
        return [(None, scene, log_of(item[1], scene, topics))]
    if not isinstance(item, str | os.PathLike):
        raise Error(f"a push is {item!r}; give a folder, a simulation, or a pair of a scene and a log")
    folders = experiments(Path(item), scene_name)
    scenes = [load_scene(folder / scene_name) for folder in folders]
    return [
        (folder.name, scene, load_log(folder, scene=scene, topics=topics))
        for folder, scene in zip(folders, scenes, strict=True)
    ]
