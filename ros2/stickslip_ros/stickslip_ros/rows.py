"""Rows of a log from messages that arrive asynchronously."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence

import stickslip
from stickslip_ros.planar import Force, Pose

#: Longest step back of a clock that is not set back (s).
PAUSE = 5.0

#: Time for which pusher poses are kept (s).
KEPT = 2.0


def between(track: Sequence[tuple[float, Pose]], time: float) -> Pose | None:
    """Interpolates the pose at ``time`` (s); the last pose after the track, None before it."""
    after = bisect_left(track, time, key=lambda entry: entry[0])
    if after == len(track) or track[after][0] == time:
        return track[min(after, len(track) - 1)][1] if track else None
    if after == 0:
        return None
    (t0, (x0, y0, a0)), (t1, (x1, y1, a1)) = track[after - 1], track[after]
    share = (time - t0) / (t1 - t0)
    turn = math.remainder(a1 - a0, 2 * math.pi)
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0), a0 + share * turn


def newest(track: Sequence[tuple[float, Pose]]) -> float:
    """Returns the time of the last pose (s)."""
    return track[-1][0] if track else -math.inf


class Rows:
    """Rows at the camera's rate.

    A row waits until a pose of the pusher, and of each other finger of a hand, at its time or later
    arrives, at most ``period`` (s). A row has
    the pusher alone if no object pose arrives for one and a half periods plus ``lag`` (s), the
    delay of the camera's poses after the pusher's of the same time. Such rows also fill the gap
    before an object pose.

    The force of a row is the mean since the previous row.

    A touch has no stamp. Its time is that of the newest pusher pose. A sensor reads true if it was
    true at any time since the previous row.
    """

    def __init__(self, sensors: int, period: float, lag: float = 0.0, fingers: int = 0) -> None:
        self._period, self._lag = period, lag
        self._objects: list[tuple[float, Pose]] = []
        self._tracks: list[list[tuple[float, Pose]]] = [[] for _ in range(1 + fingers)]
        self._forces: list[tuple[float, Force]] = []
        self._touches: list[tuple[float, int, bool]] = []
        self._reads: list[bool | None] = [None] * sensors
        self._latest = -math.inf

    def object(self, time: float, pose: Pose) -> None:
        """Takes a pose of the object at a time (s)."""
        self._objects.append((time, pose))

    def pusher(self, time: float, pose: Pose, finger: int = 0) -> None:
        """Takes a pose of the pusher, or of another ``finger`` from 1 on, at a time (s).

        Ignores it if it is out of order.
        """
        track = self._tracks[finger]
        if newest(track) - time > PAUSE:
            # another clock, or one wrong time
            track.clear()
            self._touches = [(-math.inf, sensor, on) for _, sensor, on in self._touches]
        if time > newest(track):
            track.append((time, pose))

    def force(self, time: float, force: Force) -> None:
        """Takes a force of the pusher on the object at a time (s)."""
        self._forces.append((time, force))

    def touch(self, sensor: int, on: bool) -> None:
        """Takes a reading of a sensor; sensors are numbered from 0."""
        self._touches.append((newest(self._tracks[0]), sensor, on))

    def take(self) -> list[stickslip.Row]:
        """Returns the rows that are complete, each once."""
        rows = []
        passed = self._passed()
        latest = max([passed, *(time for time, _ in self._objects)])
        waiting = []
        for time, pose in sorted(self._objects, key=lambda entry: entry[0]):
            if passed >= time or latest - time >= self._period:
                rows += self._gap(time, passed)
                rows.append(self._row(time, pose))
            else:
                waiting.append((time, pose))
        self._objects = waiting
        while not waiting and -math.inf < self._latest + 1.5 * self._period + self._lag <= passed:
            # a pause gives one row, which the tracker refuses
            step = self._period if passed - self._latest < PAUSE else passed - self._latest
            rows.append(self._row(self._latest + step, None))
        self._tracks = [[entry for entry in track if entry[0] >= passed - KEPT] for track in self._tracks]
        return rows

    def _gap(self, time: float, passed: float) -> list[stickslip.Row]:
        """Returns the rows without an object pose before ``time`` (s).

        They make the rows independent of the times at which rows are taken.
        """
        rows = []
        while 1.5 * self._period <= time - self._latest < PAUSE and self._latest + self._period <= passed:
            rows.append(self._row(self._latest + self._period, None))
        return rows

    def _passed(self) -> float:
        """Returns the time up to which the fingers have passed (s); a silent one counts for a period."""
        times = [newest(track) for track in self._tracks]
        return max(min(times), times[0] - self._period)

    def _row(self, time: float, pose: Pose | None) -> stickslip.Row:
        is_set_back = self._latest - time > PAUSE
        is_late = time <= self._latest and not is_set_back
        before = -math.inf if is_set_back else self._latest
        self._latest = time if is_set_back else max(time, self._latest)
        # only the object pose of a late row counts
        return {
            "time": time,
            "object": pose,
            "object_covariance": None,
            "pusher": between(self._tracks[0], time),
            "fingers": [between(track, time) for track in self._tracks[1:]],
            "tactile": [None] * len(self._reads) if is_late else self._tactile(time),
            "force": None if is_late else self._force(before, time),
        }

    def _force(self, before: float, time: float) -> Force | None:
        """Returns the mean force from the previous row, at ``before``, to ``time`` (s)."""
        own = [force for stamp, force in self._forces if before < stamp <= time]
        self._forces = [entry for entry in self._forces if time < entry[0] <= time + PAUSE]
        if not own:
            return None
        return sum(x for x, _ in own) / len(own), sum(y for _, y in own) / len(own)

    def _tactile(self, time: float) -> list[bool | None]:
        """Returns the readings over the interval from the previous row to ``time`` (s)."""
        touched = [False] * len(self._reads)
        for _, sensor, on in [touch for touch in self._touches if touch[0] <= time]:
            touched[sensor] |= on
            self._reads[sensor] = on
        self._touches = [touch for touch in self._touches if touch[0] > time]
        return [None if read is None else on or read for on, read in zip(touched, self._reads, strict=True)]
