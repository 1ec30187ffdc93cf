"""Estimates with facts of their run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _native

if TYPE_CHECKING:
    from stickslip._page import Page


class Estimate(dict[str, NDArray[np.float64]]):
    """Columns of ``estimate.csv``, each (rows,), and facts of the run.

    The columns are those of a dict: ``estimate["x"]``, ``pandas.DataFrame(estimate)``. A notebook
    shows the :meth:`player`.
    """

    # vars() has the facts of the run, and not the run itself
    __slots__ = ("__dict__", "__weakref__", "_on")

    #: Reasons to doubt the estimate, each with the next step. They were issued as warnings too.
    warnings: tuple[str, ...]
    #: True for each friction parameter that the log identifies; empty for methods without friction.
    observed: dict[str, bool]
    #: ln of the evidence of the log, up to a constant of the log. The scene or model with the
    #: higher one predicts the log better. None for methods without particles.
    log_evidence: float | None
    #: Number of rows at which no particle explained the camera's pose and all were resampled.
    collapses: int

    def __init__(
        self, columns: Mapping[str, NDArray[np.float64]], facts: Mapping[str, Any], on: Mapping[str, Any]
    ) -> None:
        super().__init__(columns)
        self._on = on
        self.warnings = tuple(facts["warnings"])
        self.observed = dict(facts["observed"])
        self.log_evidence = facts["log_evidence"]
        self.collapses = facts["collapses"]

    def player(self) -> Page:
        """Returns a page that plays the estimate back. For particles, see :func:`stickslip.report`."""
        from stickslip._page import Page

        return Page(_native.player(self, self._on))

    def _repr_html_(self) -> str:
        return self.player()._repr_html_()
