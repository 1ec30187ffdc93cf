"""Logs, estimates and truths as dicts of NumPy columns."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip._native import Error

#: One float64 array (rows,) per name.
Columns: TypeAlias = dict[str, NDArray[np.float64]]

#: A path of a log, columns by name, or a data frame (anything with ``columns`` and ``[name]``).
Log: TypeAlias = "str | os.PathLike[str] | Mapping[str, Any] | Any"


def columns_of(table: Any, what: str) -> Columns:
    """Returns the columns of a mapping or a data frame as float64 arrays (rows,)."""
    names = list(table.keys()) if isinstance(table, Mapping) else list(getattr(table, "columns", []))
    if not names:
        raise Error(f"{what} is {type(table).__name__}; give a path, a dict of columns, or a data frame with columns")
    return {str(name): _column(table[name], what, str(name)) for name in names}


def numbers(values: Any, name: str) -> NDArray[np.float64]:
    """Returns an aligned float64 array in C order; masked values, None and pandas' NA become NaN."""
    try:
        if hasattr(values, "to_numpy") and hasattr(values, "isna"):  # pandas, NA is no float
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        elif isinstance(values, list | tuple) and any(isinstance(value, np.ma.MaskedArray) for value in values):
            values = np.ma.array(values, dtype=np.float64)
        elif isinstance(values, list | tuple) or (isinstance(values, np.ndarray) and values.dtype.kind == "O"):
            values = np.array(values, dtype=object)
            values[np.vectorize(_is_na, otypes=[bool])(values)] = None
        if isinstance(values, np.ma.MaskedArray):
            values = np.ma.filled(values.astype(np.float64), np.nan)
        return np.require(values, np.float64, ["C", "A"])
    except (TypeError, ValueError) as error:
        raise Error(f"{name} holds something that is no number ({error})") from error


def _is_na(value: Any) -> bool:
    """Returns True for pandas' NA, which is no float."""
    return type(value).__name__ == "NAType"


def is_missing(value: Any) -> bool:
    """Returns True for None, a masked value, pandas' NA, and an array whose values are all masked."""
    if value is None or _is_na(value):
        return True
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.getmaskarray(value).all())


def _column(values: Any, what: str, name: str) -> NDArray[np.float64]:
    column = numbers(values, f"{what}: the column `{name}`")
    if column.ndim != 1:
        raise Error(f"{what}: the column `{name}` has the shape {column.shape}; it must have one number per row")
    return column
