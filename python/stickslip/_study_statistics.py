"""Medians and paired differences of the rows of a study, with bootstrap errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._native import Error

#: Resamples of a bootstrap.
_RESAMPLES = 2000


def medians(
    rows: Sequence[Mapping[str, Any]],
    value: str = "wmse_occluded_mm",
    *,
    by: Sequence[str] = ("variant",),
    unit: str = "folder",
    seed: int = 0,
) -> list[dict[str, Any]]:
    """Returns the median of ``value`` for each combination of the items in ``by``.

    An item of an item has a name such as ``scene.pusher.friction``. ``error`` is the standard error
    by a bootstrap. It resamples units (experiments by default) with all their rows, as rows of one
    unit are not independent. Rows of a single unit are resampled themselves. ``rows`` is the number
    of rows, ``units`` of units, and ``left_out`` of rows with an error or without a finite value.
    """
    groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in map(flat, rows):
        groups.setdefault(tuple(row.get(name) for name in by), []).append(row)
    result = []
    for key, group in groups.items():
        used = [row for row in group if _is_finite(row.get(value))]
        values = np.array([row[value] for row in used])
        units = [row.get(unit) for row in used]
        summary = _summary(values, units, seed) | {"left_out": len(group) - len(used)}
        result.append(dict(zip(by, key, strict=True)) | summary)
    return result


def paired(
    rows: Sequence[Mapping[str, Any]],
    item: str,
    first: Any,
    second: Any,
    value: str = "wmse_occluded_mm",
    *,
    on: Sequence[str] = ("folder", "seed"),
    unit: str = "folder",
    seed: int = 0,
) -> dict[str, Any]:
    """Returns the median of ``value`` at ``item == first`` minus that at ``item == second``, pair by pair.

    Rows with the same items in ``on`` are a pair: ``paired(rows, "particles", 500, 100)``. ``error``,
    ``rows`` (pairs), ``units`` and ``left_out`` (rows without a partner or a finite value) are those
    of :func:`medians`.
    """
    sides: list[dict[tuple[Any, ...], dict[str, Any]]] = [{}, {}]
    found = 0
    for row in map(flat, rows):
        for side, wanted in zip(sides, (first, second), strict=True):
            if row.get(item) != wanted:
                continue
            found += 1
            key = tuple(row.get(name) for name in on)
            if key in side:
                raise Error(
                    f"two rows with {item} = {wanted!r} have the same {', '.join(on)}; name what differs in `on`"
                )
            if _is_finite(row.get(value)):
                side[key] = row
    pairs = [(row, sides[1][key]) for key, row in sides[0].items() if key in sides[1]]
    values = np.array([a[value] - b[value] for a, b in pairs])
    summary = _summary(values, [a.get(unit) for a, _ in pairs], seed)
    return summary | {"left_out": found - 2 * len(pairs)}


def flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the row with items of items under names with a dot."""
    result: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, Mapping):
            result |= {f"{name}.{inner}": item for inner, item in flat(value).items()}
        else:
            result[name] = value
    return result


def _is_finite(value: Any) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _summary(values: NDArray[np.float64], units: Sequence[Any], seed: int) -> dict[str, Any]:
    """Returns the median, its bootstrap error, and the numbers of rows and units."""
    names = list(dict.fromkeys(units))
    summary = {"median": math.nan, "error": math.nan, "rows": len(values), "units": len(names)}
    if not len(values):
        return summary
    summary["median"] = float(np.median(values))
    labels = units if len(names) > 1 else range(len(values))
    places: dict[Any, list[int]] = {}
    for k, label in enumerate(labels):
        places.setdefault(label, []).append(k)
    parts = [values[own] for own in places.values()]
    if len(parts) > 1:
        rng = np.random.default_rng(seed)
        drawn = rng.integers(len(parts), size=(_RESAMPLES, len(parts)))
        summary["error"] = float(
            np.std([np.median(np.concatenate([parts[k] for k in draw])) for draw in drawn], ddof=1)
        )
    return summary
