"""Warnings at the line of the caller."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable

from stickslip._native import Warning


def warn(texts: Iterable[str]) -> None:
    """Issues warnings at the line that called the package."""
    level, frame = 1, sys._getframe()
    while frame is not None and str(frame.f_globals.get("__name__", "")).split(".")[0] == "stickslip":
        level, frame = level + 1, frame.f_back  # type: ignore[assignment]
    for text in texts:
        warnings.warn(text, Warning, stacklevel=level)
