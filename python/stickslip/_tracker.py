"""Row-by-row tracking for a robot."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import _native
from stickslip._columns import Log, is_missing, numbers
from stickslip._files import log_of, scene_of
from stickslip._native import Error, Scene

#: Columns of a log with the covariance of the object's pose.
COVARIANCE = (
    "object_var_x",
    "object_var_y",
    "object_var_theta",
    "object_cov_x_y",
    "object_cov_x_theta",
    "object_cov_y_theta",
)


class Row(TypedDict):
    """Measurements at one time; None is a missing measurement."""

    #: Time (s).
    time: float
    #: Camera pose of the object (m, m, rad).
    object: Sequence[float] | None
    #: Covariance of that pose: variances of x, y, theta (m^2, m^2, rad^2), then covariances of x
    #: with y, x with theta, y with theta; None: the noise of the scene's camera.
    object_covariance: Sequence[float] | None
    #: Pose of the pusher (m, m, rad).
    pusher: Sequence[float] | None
    #: Poses of the other fingers of a hand, one per ``[[finger]]``.
    fingers: Sequence[Sequence[float] | None]
    #: Tactile readings of the fixels, then of the fingers of a hand, 0 or 1, over the interval that ends at this row.
    tactile: Sequence[bool | int | None]
    #: Force of the pusher, or of the whole hand, on the object, world frame (N).
    force: Sequence[float] | None


class Outcomes(TypedDict):
    """Probabilities of the end of a plan: the first five exclude each other and sum to 1."""

    #: The object rests, the drive yields, and the pressing contacts resist forces and torques in all directions.
    held: float
    #: The object rests and the drive yields, without such a form closure.
    jammed: float
    #: The object rests at a body, and the drive does not yield.
    resting: float
    #: The object moves, and a body touches it.
    moving: float
    #: No body touches the object.
    lost: float
    #: Sets of bodies that touch and their probabilities, the likeliest first.
    contacts: list[tuple[list[str], float]]
    #: Mean of the final poses (m, m, rad) and their standard deviations.
    x: float
    y: float
    theta: float
    std_x: float
    std_y: float
    std_theta: float
    #: Probability that the last step has no certified solution.
    unsolved: float


class Tracker:
    """Particle filter that takes one row at a time, on the caller's thread.

    Threads that use one tracker wait for their turns. A new reason to doubt the estimates is issued
    as :class:`stickslip.Warning`. Its estimates have the bits of
    ``stickslip.filter(..., causal=True)``. ``late``: largest delay of a row behind the latest one at
    which its object pose counts (s). The particles keep their poses for this time.

    >>> tracker = stickslip.Tracker(scene, particles=500)  # doctest: +SKIP
    >>> estimate = tracker.push(0.033, object=(0.1, 0.0, 0.0), pusher=(0.07, 0.0, 0.0))  # doctest: +SKIP
    """

    def __init__(
        self,
        scene: Scene | str | os.PathLike[str],
        *,
        model: Literal["robust", "paper"] = "robust",
        particles: int = 500,
        seed: int = 0,
        tactile: bool = True,
        substeps: int | None = None,
        late: float = 0.2,
    ) -> None:
        self._tracker = _native.Tracker(
            scene_of(scene),
            {
                "model": model,
                "particles": particles,
                "seed": seed,
                "tactile": tactile,
                "substeps": substeps,
                "late": late,
            },
        )

    def push(
        self,
        time: float,
        object: Sequence[float] | None = None,
        pusher: Sequence[float] | None = None,
        tactile: Sequence[bool | int | None] = (),
        force: Sequence[float] | None = None,
        object_covariance: Sequence[float] | None = None,
        fingers: Sequence[Sequence[float] | None] = (),
    ) -> dict[str, float]:
        """Takes the measurements at ``time`` (s); None and masked values are missing.

        ``object``, ``pusher``: poses (m, m, rad). ``tactile``: readings 0 or 1, sensor k on fixel
        k. ``force``: force of the pusher, or of the whole hand, on the object (N).
        ``object_covariance``: variances of x, y and theta, then covariances of x with y, x with
        theta and y with theta. ``fingers``: poses of the other fingers of a hand, one per
        ``[[finger]]``.

        Returns the estimate at the latest row, with the names of ``estimate.csv`` (see
        :func:`stickslip.filter`); NaN before the first object pose. A row without an object pose is
        occluded. A row that is not later than the latest one is late: its object pose counts for
        its own time.

        Raises :class:`stickslip.Error` if the row is invalid. The tracker is then unchanged.
        """
        try:
            readings = [None if is_missing(reading) else reading for reading in tactile]
        except TypeError as error:
            raise Error(f"tactile is {tactile!r}; give a list of readings, sensor k on fixel k") from error
        row = {
            "time": time,
            "object": _measured(object, "object"),
            "object_covariance": _measured(object_covariance, "object_covariance"),
            "pusher": _measured(pusher, "pusher"),
            "fingers": [_measured(finger, "finger") for finger in fingers],
            "tactile": readings,
            "force": _measured(force, "force"),
        }
        return self._tracker.push(row)

    @property
    def estimate(self) -> dict[str, float]:
        """Estimate at the latest row."""
        return self._tracker.estimate()

    def particles(self) -> dict[str, NDArray[np.float64]]:
        """Returns the particles after the latest row, an array (N,) each; (0,) before the first pose.

        ``weight`` (they sum to 1), ``x``, ``y`` (m), ``theta`` (rad), ``mu_s``, ``mu_p``, ``mu_f``,
        ``d_tri`` (m).
        """
        return self._tracker.particles()

    def outcomes(self, plan: ArrayLike, *, h: float = 1.0 / 30.0) -> Outcomes:
        """Predicts how the fingers' intended motion ends, by the particles themselves.

        ``plan``: intended poses of the pusher from the latest row on, ``h`` (s) apart, (T + 1, 3): x, y
        (m), theta (rad); for a hand, those of the other fingers follow, (T + 1, 3 F). Copies of the
        particles move with their velocities, friction, offsets and random forces. A drive with a
        stall force yields. Let a grasp go on closing at its end: a drive that stands presses with an
        unknown force, and such an end counts as resting. The tracker does not change.
        """
        path = numbers(plan, "plan")
        if path.ndim != 2 or path.shape[1] % 3 or not path.size:
            raise Error(f"plan has the shape {path.shape}; it must be (T + 1, 3 F) with F fingers, the pusher first")
        fingers = np.moveaxis(path.reshape(len(path), -1, 3), 1, 0)
        return self._tracker.outcomes(fingers.tolist(), h)  # type: ignore[return-value]

    def copy(self) -> Tracker:
        """Returns a tracker that goes on by itself: equal rows give it equal estimates."""
        twin = object.__new__(type(self))
        twin._tracker = self._tracker.copy()
        return twin

    @property
    def warnings(self) -> tuple[str, ...]:
        """Reasons to doubt the estimates so far, each with the next step."""
        return tuple(self._tracker.warnings)

    @property
    def observed(self) -> dict[str, bool]:
        """True for each friction parameter that the rows so far identify."""
        return self._tracker.observed

    @property
    def log_evidence(self) -> float:
        """ln of the evidence of the rows so far, up to a constant of the rows."""
        return self._tracker.log_evidence

    @property
    def collapses(self) -> int:
        """Number of rows at which no particle explained the camera's pose and all were resampled."""
        return self._tracker.collapses


def _measured(values: Any, name: str) -> list[float] | None:
    """Returns the numbers of a measurement, None if it is missing."""
    if is_missing(values):
        return None
    found = numbers(values, name)
    if found.ndim != 1:
        raise Error(f"{name} is {values!r}; give its numbers in a list")
    return found.tolist()  # type: ignore[no-any-return]


def rows(log: Log) -> Iterator[Row]:
    """Yields the rows of a log: ``for row in rows(log): tracker.push(**row)``."""
    columns = log_of(log)
    fingers = [f"finger_{k}" for k in range(1, len(columns) + 1) if f"finger_{k}_x" in columns]
    sensors = [f"tactile_{k}" for k in range(1, len(columns) + 1) if f"tactile_{k}" in columns]

    def group(row: int, *names: str) -> tuple[float, ...] | None:
        values = tuple(float(columns[name][row]) for name in names if name in columns)
        return None if not values or np.isnan(values).all() else values

    def reading(value: Any) -> bool | None:
        return None if np.isnan(value) else bool(value)

    for row, time in enumerate(columns["time"]):
        yield {
            "time": float(time),
            "object": group(row, "object_x", "object_y", "object_theta"),
            "object_covariance": group(row, *COVARIANCE),
            "pusher": group(row, "pusher_x", "pusher_y", "pusher_theta"),
            "fingers": [group(row, f"{finger}_x", f"{finger}_y", f"{finger}_theta") for finger in fingers],
            "tactile": [reading(columns[sensor][row]) for sensor in sensors],
            "force": group(row, "pusher_force_x", "pusher_force_y"),
        }
