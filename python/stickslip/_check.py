"""Faults of a log and its scene."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal

from stickslip import _native
from stickslip._columns import Log
from stickslip._files import log_of, scene_of
from stickslip._native import Scene


@dataclass(frozen=True)
class Finding:
    """Result of one check."""

    #: Subject of the check, such as ``units`` or ``sensor 1``.
    subject: str
    #: ``ok``, ``warning`` (estimates may be worse than they could be) or ``problem`` (estimates
    #: will be wrong).
    severity: Literal["ok", "warning", "problem"]
    #: What was found, with its number.
    found: str
    #: The next step; None if there is nothing to do.
    advice: str | None

    def __str__(self) -> str:
        advice = f"; {self.advice}" if self.advice else ""
        return f"{self.severity}: {self.subject}: {self.found}{advice}"


def check(log: Log, scene: Scene | str | os.PathLike[str]) -> list[Finding]:
    """Returns the findings of ``stickslip check`` about a log and its scene.

    ``log`` and ``scene`` are those of :func:`stickslip.filter`. Nothing is repaired.
    """
    known = scene_of(scene)
    found: Any = _native.check(log_of(log, known), known)
    return [Finding(*parts) for parts in found]
