"""Errors of an estimate against a reference."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from stickslip import _native
from stickslip._columns import Log, columns_of
from stickslip._files import load_truth, log_of, scene_of
from stickslip._native import Scene
from stickslip._options import FilterOptions, arguments


def score(
    estimate: Mapping[str, Any],
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    truth: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    occlude: int | tuple[int, int | None] | None = None,
    occlude_middle: float | None = None,
    first_pusher_contact: int | None = None,
    virtual_radius: float | None = None,
) -> dict[str, Any]:
    """Scores an estimate against ``truth`` or, without it, against the log's own poses.

    ``truth``: columns ``time``, ``x``, ``y``, ``theta``, or the path of ``truth.csv``. The log's
    poses include the hidden ones. ``occlude``, ``occlude_middle``: the rows that were hidden, as in
    :func:`stickslip.filter`.
    ``first_pusher_contact``: row of the first contact, if known. ``virtual_radius``: weight of an
    angle (m), by default the object's radius of gyration.

    Returns these numbers; NaN: there are no rows to score.

    - ``wmse_mm``: pose RMSE over all rows (mm; the paper calls it WMSE)
    - ``wmse_occluded_mm``: pose RMSE over hidden rows
    - ``wmse_moving_mm``: pose RMSE from first contact to rest
    - ``spread_occluded_mm``: expected ``wmse_occluded_mm`` if the standard deviations are correct
    - ``final_error_mm`` and ``final_error_deg``: errors at the end
    - ``covered_90``: share of the 90 % intervals of x, y and theta that cover the reference, and
      ``crps_mm``: the score of the whole belief (CRPS), over hidden rows if there are some
    - ``pit``: over the same rows, the share of the reference's x, y and theta in each tenth of the
      belief (probability integral transform), a list of ten; 0.1 each if the belief is calibrated
    """
    if isinstance(truth, str | os.PathLike):
        truth = load_truth(truth)
    known = scene_of(scene)
    return _native.score(
        columns_of(estimate, "the estimate"),
        {
            "log": log_of(log, known),
            "scene": known,
            "truth": None if truth is None else columns_of(truth, "the truth"),
            "options": arguments(FilterOptions(occlude=occlude, occlude_middle=occlude_middle)),
            "first_pusher_contact": first_pusher_contact,
            "virtual_radius": virtual_radius,
        },
    )
