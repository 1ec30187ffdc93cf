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

#: A path of a log file, columns by name, or a data frame (anything with ``columns`` and ``[name]``).
Log: TypeAlias = "str | os.PathLike[str] | Mapping[str, Any] | Any"


def columns_of(table: Any, what: str) -> Columns:
    """Returns the columns of a mapping or a data frame as contiguous float64 arrays (rows,).

    Masked and missing values of data frames become NaN.
    """
    names = list(table.keys()) if isinstance(table, Mapping) else list(getattr(table, "columns", []))
    if not names:
        raise Error(f"{what} is {type(table).__name__}; give a path, a dict of columns, or a data frame with columns")
    return {str(name): _column(table[name], what, str(name)) for name in names}


def _column(values: Any, what: str, name: str) -> NDArray[np.float64]:
    try:
        if hasattr(values, "to_numpy") and hasattr(values, "isna"):  # pandas, NA is no float
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        column = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise Error(f"{what}: the column `{name}` holds something that is no number ({error})") from error
    if column.ndim != 1:
        raise Error(f"{what}: the column `{name}` has the shape {column.shape}; it must have one number per row")
    return column
