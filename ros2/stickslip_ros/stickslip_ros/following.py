"""Tracker that restarts."""

from __future__ import annotations

from collections.abc import Callable

import stickslip
from stickslip_ros.rows import PAUSE

#: Longest step to the row after a pause (s).
NEAR = 1.0


class Following:
    """Tracker that restarts after a pause, or when the clock is set back."""

    def __init__(self, start: Callable[[], stickslip.Tracker]) -> None:
        self._start = start
        self._tracker = start()
        self._elsewhere: float | None = None
        self._collapses_before = 0
        #: Time of the latest row (s).
        self.time: float | None = None
        #: Late rows, refused rows and restarts so far.
        self.late, self.refused, self.restarts = 0, 0, 0

    def push(self, row: stickslip.Row) -> dict[str, float]:
        """Returns the estimate at the latest row.

        Raises :class:`stickslip.Error` if the row is invalid, or if it is the first one that is far
        from the others, since its time may be wrong.
        """
        try:
            estimate = self._push(row)
        except stickslip.Error:
            self.refused += 1
            raise
        time = row["time"]
        self._elsewhere = None
        self.late += self.time is not None and time <= self.time
        self.time = time if self.time is None else max(time, self.time)
        return estimate

    @property
    def collapses(self) -> int:
        """Rows so far at which no particle explained the camera's pose."""
        return self._collapses_before + self._tracker.collapses

    @property
    def doubts(self) -> tuple[str, ...]:
        """Reasons to doubt the estimates since the latest restart."""
        return self._tracker.warnings

    @property
    def observed(self) -> list[str]:
        """Friction parameters that the rows since the latest restart identify."""
        return [name for name, is_observed in self._tracker.observed.items() if is_observed]

    def _push(self, row: stickslip.Row) -> dict[str, float]:
        time = row["time"]
        try:
            return self._tracker.push(**row)
        except stickslip.Error:
            before = self._elsewhere
            far = self.time is not None and abs(time - self.time) > PAUSE
            self._elsewhere = time if far else before
            if not far or before is None or not 0 <= time - before <= NEAR:
                raise
        tracker = self._start()
        estimate = tracker.push(**row)
        self._collapses_before += self._tracker.collapses
        self._tracker, self.time = tracker, None
        self.restarts += 1
        return estimate
