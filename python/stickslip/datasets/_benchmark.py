"""Occlusion benchmark of all methods over a data set."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from stickslip._compare import compare
from stickslip._options import FilterOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


def occlusion_benchmark(
    folders: Iterable[str | os.PathLike[str]],
    *,
    seconds: float = 1.0,
    seeds: int = 1,
    scene_name: str = "scene.toml",
    **options: Unpack[FilterOptions],
) -> list[dict[str, Any]]:
    """Hides the camera for the middle ``seconds`` of every experiment and scores each method.

    Returns the rows of :func:`stickslip.compare`; ``wmse_occluded_mm`` is the benchmark's score.
    ``pandas.DataFrame(rows).groupby("variant")["wmse_occluded_mm"].median()`` makes a table of it.
    """
    own = FilterOptions(**{**options, "occlude": None, "occlude_middle": seconds})
    return compare(folders, seeds=seeds, scene_name=scene_name, **own)
