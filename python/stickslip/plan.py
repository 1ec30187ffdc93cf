"""Choice of a push: by distance to a goal, risk of a jam, or information about friction; of a grasp: by how it ends.

>>> from stickslip import plan
>>> pushes = plan.straight_pushes(scene, pose=(0, 0, 0), count=500, length=0.05)  # doctest: +SKIP
>>> outcome = plan.predict(scene, (0, 0, 0), pushes, plan.prior(scene, 50))  # doctest: +SKIP
>>> best = outcome.nearest(goal=(0.05, 0.01, 0.3), jam_below=0.05)  # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._columns import numbers
from stickslip._native import Error, Scene
from stickslip._options import Progress
from stickslip._outline import outlines
from stickslip._rollout import FRICTION, rollout
from stickslip._tracker import Outcomes, Tracker

__all__ = ["Outcome", "grasp", "jaw_closings", "jaw_openings", "predict", "prior", "straight_pushes"]

#: Distance between object and pusher at the start of a candidate (m).
_CLEARANCE = 2e-3


@dataclass(frozen=True)
class Outcome:
    """End of N pushes under K frictions."""

    #: Final poses of the object (N, K, 3): x, y (m), theta (rad).
    pose: NDArray[np.float64]
    #: True if the pusher yielded or a step had no certified solution (N, K).
    jammed: NDArray[np.bool_]
    #: Weight of an angle in distances (m): the object's radius of gyration.
    radius: float

    @property
    def jam_probability(self) -> NDArray[np.float64]:
        """Share of the frictions under which each push jams (N,)."""
        return np.asarray(self.jammed.mean(axis=1))

    def distance(self, goal: ArrayLike) -> NDArray[np.float64]:
        """Returns the RMS distance (m) to ``goal`` (m, m, rad) over the frictions (N,)."""
        away = self.pose - numbers(goal, "goal")
        turn = np.angle(np.exp(1j * away[..., 2]))
        square = away[..., 0] ** 2 + away[..., 1] ** 2 + (self.radius * turn) ** 2
        return np.asarray(np.sqrt(square.mean(axis=1)))

    def nearest(self, goal: ArrayLike, *, jam_below: float = 1.0) -> int:
        """Returns the push nearest to ``goal`` whose jam probability is at most ``jam_below``."""
        allowed = self.jam_probability <= jam_below
        if not allowed.any():
            raise Error(f"every push jams with more than {jam_below}; the least is {self.jam_probability.min()}")
        return int(np.where(allowed, self.distance(goal), np.inf).argmin())

    def information(self, *, position_std: float, orientation_std: float) -> NDArray[np.float64]:
        """Returns the information about friction in one pose after each push (N,), in nats.

        It is the mutual information of friction and a pose with this noise (m, rad). The poses
        under the K frictions are taken as normal: half of ln det(1 + C / noise), with their
        covariance C.
        """
        noise = np.array([position_std, position_std, orientation_std])
        if self.pose.shape[1] < 2 or not (noise > 0).all():
            raise Error("information needs two frictions or more, and noise above 0")
        spread = (self.pose - self.pose.mean(axis=1, keepdims=True)) / noise
        covariance = np.einsum("nki,nkj->nij", spread, spread) / (self.pose.shape[1] - 1)
        return np.asarray(0.5 * np.linalg.slogdet(np.eye(3) + covariance)[1])


def predict(
    scene: Scene,
    pose: ArrayLike,
    pushes: ArrayLike,
    friction: Mapping[str, ArrayLike] | None = None,
    *,
    h: float = 1.0 / 30.0,
    gives_way: float = 1e-3,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Outcome:
    """Simulates every push under every friction.

    ``pose``: pose of the object at rest, (3,), or one per friction, (K, 3), as from
    :func:`stickslip.particles`. ``pushes``: poses of the pusher (N, T + 1, 3), a step of ``h`` (s)
    apart. ``friction``: ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m), each (K,), as from
    :func:`prior` or :func:`stickslip.samples`; the scene's by default. ``gives_way``: lag of the
    pusher (m) above which a push counts as jammed. ``progress``: see :func:`stickslip.rollout`.
    """
    paths = numbers(pushes, "pushes")
    if paths.ndim != 3 or paths.shape[2] != 3 or paths.shape[1] < 2:
        raise Error(f"pushes has the shape {paths.shape}; it must be (N, T + 1, 3)")
    values = {name: np.atleast_1d(numbers(value, name)) for name, value in (friction or {}).items()}
    starts = np.atleast_2d(numbers(pose, "pose"))
    draws = max([len(starts), *(len(value) for value in values.values())])
    starts = np.broadcast_to(starts, (draws, 3))
    count = len(paths)
    result = rollout(
        scene,
        np.tile(starts, (count, 1)),
        np.repeat(paths, draws, axis=0),
        {name: np.tile(np.broadcast_to(value, draws), count) for name, value in values.items()},
        h=h,
        threads=threads,
        progress=progress,
    )
    jammed = (result["unsolved"] > 0) | (result["most_pusher_lag"] > gives_way)
    return Outcome(
        result["pose"][:, -1].reshape(count, draws, 3).copy(), jammed.reshape(count, draws), scene.virtual_radius
    )


def prior(scene: Scene, count: int, *, seed: int = 0) -> dict[str, NDArray[np.float64]]:
    """Draws frictions from the scene's prior (``[uncertainty]``), each (count,); d_tri in m."""
    normals = np.random.default_rng(seed).standard_normal((count, len(FRICTION)))
    drawn = scene.drawn_friction(normals)
    known = {name for name, value in scene.friction.items() if not np.isnan(value)}
    return {name: drawn[:, k].copy() for k, name in enumerate(FRICTION) if name in known}


def straight_pushes(
    scene: Scene,
    pose: ArrayLike,
    count: int,
    *,
    length: float,
    speed: float = 0.02,
    h: float = 1.0 / 30.0,
    seed: int = 0,
) -> NDArray[np.float64]:
    """Draws random straight pushes: pusher poses (count, T + 1, 3), ``h`` (s) apart.

    A push begins clear of the object at ``pose`` and goes ``length`` (m) past the circle around it,
    at ``speed`` (m/s). Direction and aim across the object are random. A push may sweep through a
    fixel.
    """
    if not (count > 0 and length > 0 and speed > 0 and h > 0):
        raise Error("count, length, speed and h must be above 0")
    x, y, _ = numbers(pose, "pose")
    bodies = outlines(scene)
    reach = _radius(bodies.object)
    away = reach + _radius(bodies.pusher) + _CLEARANCE
    rng = np.random.default_rng(seed)
    angle = rng.uniform(-np.pi, np.pi, count)
    aside = rng.uniform(-0.7, 0.7, count) * reach
    ahead = np.column_stack([np.cos(angle), np.sin(angle)])
    across = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    start = np.array([x, y]) - away * ahead + aside[:, None] * across
    steps = max(1, int(np.ceil((length + _CLEARANCE) / (speed * h))))
    travelled = speed * h * np.arange(steps + 1)
    places = start[:, None, :] + travelled[None, :, None] * ahead[:, None, :]
    return np.concatenate([places, np.broadcast_to(angle[:, None, None], (count, steps + 1, 1))], axis=2)


def jaw_closings(
    scene: Scene,
    pose: ArrayLike,
    *,
    angles: ArrayLike,
    offsets: ArrayLike = (0.0,),
    speed: float = 0.02,
    clearance: float = _CLEARANCE,
    h: float = 1.0 / 30.0,
) -> NDArray[np.float64]:
    """Returns the closings of a jaw about an object at ``pose`` (m, m, rad).

    The scene has one ``[[finger]]`` beside the pusher. Every angle (rad, direction of the pusher's
    motion in the world) is combined with every offset (m) of the fingers' line across it, from the
    object's centre. The jaw begins ``clearance`` (m) outside the circle around the object: where its
    pose is uncertain, wider, so that no finger comes down on it. Each finger moves at ``speed``
    (m/s) until both would meet. Both are turned by the angle. The result is (N, T + 1, 6), ``h`` (s)
    apart: poses of the pusher, then of the finger.
    """
    if not (speed > 0 and clearance > 0 and h > 0):
        raise Error("speed, clearance and h must be above 0")
    x, y, _ = numbers(pose, "pose")
    opening, closed = jaw_openings(scene, clearance)
    steps = max(1, int(np.ceil((opening - closed) / (speed * h))))
    travelled = np.minimum(speed * h * np.arange(steps + 1), opening - closed)
    angle, aside = (grid.ravel() for grid in np.meshgrid(numbers(angles, "angles"), numbers(offsets, "offsets")))
    ahead = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = np.array([x, y]) + aside[:, None] * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    turned = np.broadcast_to(angle[:, None, None], (len(angle), steps + 1, 1))
    away = (opening - travelled)[None, :, None] * ahead[:, None, :]
    return np.concatenate([middle[:, None] - away, turned, middle[:, None] + away, turned], axis=2)


def jaw_openings(scene: Scene, clearance: float = _CLEARANCE) -> tuple[float, float]:
    """Returns half the distance (m) of a jaw's fingers around the object, and where they meet.

    They are ``clearance`` (m) outside the circle around the object, whose centre is between them.
    The scene has one ``[[finger]]`` beside the pusher. The x-axes of both point from the pusher to
    it.
    """
    if scene.fingers != 1:
        raise Error(f"the scene has {scene.fingers} [[finger]] tables; a jaw has one beside the pusher")
    bodies = outlines(scene)
    ahead = max(part[:, 0].max() for part in bodies.pusher)
    behind = max(-part[:, 0].min() for part in bodies.fingers[0])
    return _radius(bodies.object) + max(ahead, behind) + clearance, float(ahead + behind) / 2


def grasp(
    tracker: Tracker, closings: ArrayLike, *, wanted: str | Sequence[str] = "held", h: float = 1.0 / 30.0
) -> tuple[int, list[Outcomes]]:
    """Returns the closing that ends as ``wanted`` with the highest probability, and how each ends.

    ``closings``: paths of the fingers (N, T + 1, 3 F), ``h`` (s) apart, as from
    :func:`jaw_closings`. ``wanted``: a key of :class:`stickslip.Outcomes`, or several, as
    ``("held", "jammed")`` where the fingers are too smooth for form closure. Every path is rolled out
    by the tracker's particles (see :meth:`stickslip.Tracker.outcomes`).
    """
    ends = [tracker.outcomes(path, h=h) for path in numbers(closings, "closings")]
    names = [wanted] if isinstance(wanted, str) else wanted
    if not ends or not set(names) <= {"held", "jammed", "resting", "moving", "lost"}:
        raise Error(f"wanted is {wanted!r}; it must be held, jammed, resting, moving or lost, and closings not empty")
    chances = [sum((float(end[name]) for name in names), 0.0) for end in ends]  # type: ignore[literal-required]
    return int(np.argmax(chances)), ends


def _radius(polygons: list[NDArray[np.float64]]) -> float:
    return float(max(np.hypot(*polygon.T).max() for polygon in polygons))
