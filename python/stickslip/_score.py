"""How far an estimate is from what happened."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from stickslip import _native
from stickslip._columns import Log, columns_of
from stickslip._files import log_of, scene_of
from stickslip._filter import FilterOptions, arguments
from stickslip._native import Scene


def score(
    estimate: Mapping[str, Any],
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    truth: Mapping[str, Any] | None = None,
    occlude: int | tuple[int, int | None] | None = None,
    occlude_middle: float | None = None,
    first_pusher_contact: int | None = None,
    virtual_radius: float | None = None,
) -> dict[str, float]:
    """Scores an estimate against ``truth`` (columns ``time``, ``x``, ``y``, ``theta``), else against the
    log's own poses, hidden ones included.

    ``occlude``, ``occlude_middle``: what was hidden from the method, as in :func:`stickslip.filter`.
    ``first_pusher_contact``: its row, where it is known. ``virtual_radius``: weight of an angle (m), by
    default the object's radius of gyration.

    Returns ``wmse_mm``, the weighted RMSE of the pose over all rows (mm; the paper calls it WMSE),
    ``wmse_occluded_mm`` over hidden rows, ``wmse_moving_mm`` from first contact to rest,
    ``spread_occluded_mm``, what ``wmse_occluded_mm`` would be if the standard deviations were true, and the
    final errors ``final_error_mm`` and ``final_error_deg``; NaN where there is nothing to score on.
    """
    return _native.score(
        columns_of(estimate, "the estimate"),
        {
            "log": log_of(log),
            "scene": scene_of(scene),
            "truth": None if truth is None else columns_of(truth, "the truth"),
            "options": arguments(FilterOptions(occlude=occlude, occlude_middle=occlude_middle)),
            "first_pusher_contact": first_pusher_contact,
            "virtual_radius": virtual_radius,
        },
    )
