"""Gymnasium environments: push an object to a goal, or grasp it, with a camera that does not always see it.

Needs ``pip install 'stickslip[gym]'``.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from stickslip._columns import numbers
from stickslip._native import Error, Scene
from stickslip._outline import outlines
from stickslip._rollout import rollout
from stickslip._toml import tomllib
from stickslip._tracker import Tracker
from stickslip.plan import jaw_openings, prior

__all__ = ["GraspEnv", "PushEnv"]

#: Step of the simulations (s).
_STEP = 1.0 / 30.0

#: Distance between object and pusher at the start (m).
_CLEARANCE = 2e-3

#: Length of an observation.
_SEEN = 8


class PushEnv(VectorEnv[NDArray[np.float32], NDArray[np.float32], NDArray[Any]]):
    """``num_envs`` objects, each with its own goal and its own friction from the scene's prior.

    Observation (8,), with the object's pose as last seen:

    - object relative to the goal: x, y (m), cos and sin of the angle
    - pusher relative to the object: x, y (m)
    - 1 if the camera is on, else 0
    - time left, from 1 to 0

    Action (2,): velocity of the pusher as a share of ``speed`` (m/s), each from -1 to 1. The pusher
    keeps its angle. Reward: decrease of the distance to the goal (in tolerances; angles times the
    radius of gyration), and 10 on arrival. All environments are one rollout.

    An episode ends if the distance is at most ``tolerance`` (m). It is truncated after ``actions``
    actions of ``frames`` steps of 1/30 s. The next step then resets the environment
    (``AutoresetMode.NEXT_STEP``). ``goal_distance``: nearest and farthest goals (m). ``dark``:
    probability per action that the camera turns off for the rest of the episode.
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012 (as the base class has it)

    def __init__(
        self,
        scene: Scene,
        num_envs: int = 1,
        *,
        actions: int = 100,
        frames: int = 3,
        speed: float = 0.05,
        tolerance: float = 5e-3,
        goal_distance: tuple[float, float] = (0.03, 0.08),
        dark: float = 0.02,
        threads: int | None = None,
    ) -> None:
        if num_envs < 1 or actions < 1 or frames < 1 or not (speed > 0 and tolerance > 0 and 0 <= dark <= 1):
            raise Error("num_envs, actions, frames, speed and tolerance must be above 0, and dark from 0 to 1")
        self.num_envs = num_envs
        self.single_observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (_SEEN,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._scene, self._threads = scene, threads
        self._actions, self._frames, self._speed = actions, frames, speed
        self._tolerance, self._goal_distance, self._dark = tolerance, goal_distance, dark
        bodies = outlines(scene)
        self._away = _reach(bodies.object) + _reach(bodies.pusher) + _CLEARANCE
        self._state = np.zeros((num_envs, 6))
        self._pusher = np.zeros((num_envs, 3))
        self._goal = np.zeros((num_envs, 3))
        self._seen = np.zeros((num_envs, 3))
        self._visible = np.ones(num_envs, dtype=np.bool_)
        self._taken = np.zeros(num_envs, dtype=np.int64)
        self._over = np.ones(num_envs, dtype=np.bool_)
        self._friction = prior(scene, num_envs)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts an episode in every environment."""
        if isinstance(seed, list):
            seed = seed[0]
        super().reset(seed=seed)
        self._begin(np.ones(self.num_envs, dtype=np.bool_))
        return self._observe(), {}

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Moves every pusher for ``frames`` steps."""
        share = numbers(actions, "actions")
        if share.shape != (self.num_envs, 2) or not np.isfinite(share).all():
            raise Error(f"actions has the shape {share.shape}; it must be ({self.num_envs}, 2), all finite")
        fresh = self._over.copy()
        self._begin(fresh)
        share = np.where(fresh[:, None], 0.0, share.clip(-1, 1))
        before = self._distance()
        self._move(share)
        after = self._distance()
        self._taken += ~fresh
        arrived = ~fresh & (after <= self._tolerance)
        cut = ~fresh & ~arrived & (self._taken >= self._actions)
        self._over = arrived | cut
        self._visible &= (self.np_random.random(self.num_envs) >= self._dark) | fresh
        self._seen[self._visible] = self._state[self._visible, :3]
        reward = np.where(fresh, 0.0, (before - after) / self._tolerance + 10.0 * arrived)
        return self._observe(), reward, arrived, cut, {"distance": after}

    def _begin(self, which: NDArray[np.bool_]) -> None:
        """Starts an episode in some environments."""
        count = int(which.sum())
        if not count:
            return
        rng = self.np_random
        side, turn = rng.uniform(-np.pi, np.pi, count), rng.uniform(-np.pi, np.pi, count)
        way, far = rng.uniform(-np.pi, np.pi, count), rng.uniform(*self._goal_distance, count)
        self._state[which] = 0.0
        self._state[which, 2] = turn
        self._pusher[which] = np.column_stack([self._away * np.cos(side), self._away * np.sin(side), np.zeros(count)])
        turn = turn + rng.uniform(-0.5, 0.5, count)
        self._goal[which] = np.column_stack([far * np.cos(way), far * np.sin(way), turn])
        drawn = prior(self._scene, count, seed=int(rng.integers(2**31)))
        for name, values in drawn.items():
            self._friction[name][which] = values
        self._seen[which] = self._state[which, :3]
        self._visible[which], self._taken[which], self._over[which] = True, 0, False

    def _move(self, share: NDArray[np.float64]) -> None:
        way = np.zeros((self.num_envs, 3))
        way[:, :2] = self._speed * _STEP * share
        path = self._pusher[:, None, :] + np.arange(self._frames + 1)[None, :, None] * way[:, None, :]
        result = rollout(self._scene, self._state, path, self._friction, h=_STEP, threads=self._threads)
        self._state = np.concatenate([result["pose"][:, -1], result["twist"][:, -1]], axis=1)
        self._pusher = path[:, -1].copy()
        self._pusher[:, :2] -= result["pusher_lag"]

    def _distance(self) -> NDArray[np.float64]:
        away = self._state[:, :3] - self._goal
        turn = np.angle(np.exp(1j * away[:, 2]))
        return np.asarray(np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2 + (self._scene.virtual_radius * turn) ** 2))

    def _observe(self) -> NDArray[np.float32]:
        away = self._seen - self._goal
        left = 1.0 - self._taken / self._actions
        columns = [away[:, 0], away[:, 1], np.cos(away[:, 2]), np.sin(away[:, 2])]
        columns += [*(self._pusher[:, :2] - self._seen[:, :2]).T, self._visible, left]
        return np.column_stack(columns).astype(np.float32)


class GraspEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """A jaw grasps an object that its fingers hide from the camera.

    The scene has one ``[[finger]]`` beside the pusher, and ``[camera]``. Friction is drawn from the
    scene's prior. A tracker gets the camera's noisy poses and those of the fingers. The camera sees
    the object while the distance of the jaw's middle from it is above ``hidden`` times that at which
    the circle around the open fingers touches the circle around the object.

    Observation (12,), in the jaw's frame (origin in the middle of the fingers, x from the pusher to
    the other finger):

    - estimated pose of the object: x, y (m), cos and sin of the angle
    - standard deviations of x, y (m) and of the angle (rad)
    - half the distance of the fingers (m)
    - probabilities of contact with the pusher and with the other finger
    - 1 if the camera sees the object, else 0
    - time left, from 1 to 0

    Action (4,), each from -1 to 1: velocity of the jaw along x and y of its frame and speed of each
    finger toward the other one, as shares of ``speed`` (m/s); in between, the turn: at 1 the open
    fingers have ``speed``. Reward: decrease of the distance between object and jaw's middle, over
    the radius of the circle around the object, and 10 if it is held.

    An episode ends if the object is held (the drive yields while the jaw closes, and the object
    rests: less than 1 mm/s and 0.03 rad/s) or if the fingers meet. It is truncated after ``actions``
    actions of ``frames`` steps of 1/30 s. ``particles``: of the tracker. ``info["held"]`` is true in
    the first case. ``tracker`` is for plans (:func:`stickslip.plan.grasp`), and ``fingers`` their
    poses (2, 3).
    """

    metadata = {"render_modes": []}  # noqa: RUF012 (as the base class has it)

    def __init__(
        self,
        scene: Scene,
        *,
        actions: int = 100,
        frames: int = 3,
        speed: float = 0.05,
        hidden: float = 1.0,
        particles: int = 200,
    ) -> None:
        if actions < 1 or frames < 1 or not (speed > 0 and hidden >= 0):
            raise Error("actions, frames and speed must be above 0, and hidden at least 0")
        camera = tomllib.loads(scene.text).get("camera")
        if camera is None:
            raise Error(f"{scene.name} has no table [camera]; a grasp needs one")
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (12,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        self._noise = [camera["position_std"], camera["position_std"], camera["orientation_std"]]
        self._scene, self._particles = scene, particles
        self._actions, self._frames, self._speed = actions, frames, speed
        self._open, self._closed = jaw_openings(scene)
        self._radius = _reach(outlines(scene).object)
        self._apart = self._open + self._radius
        self._hidden = hidden * self._apart

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts an episode: the jaw is open beside the object, and the camera has seen it for a second."""
        super().reset(seed=seed)
        rng = self.np_random
        way, turn, self._angle = rng.uniform(-np.pi, np.pi, 3)
        self._state = np.array([0.0, 0.0, turn, 0.0, 0.0, 0.0])
        far = rng.uniform(1.0, 2.0) * max(self._apart, self._hidden)
        self._place(far * np.array([np.cos(way), np.sin(way)]), self._open)
        drawn = prior(self._scene, 1, seed=int(rng.integers(2**31)))
        self._friction = {name: float(values[0]) for name, values in drawn.items()}
        self.tracker = Tracker(self._scene, particles=self._particles, seed=int(rng.integers(2**31)))
        self._frame = self._taken = 0
        for _ in range(30):
            self._look()
        return self._observe(), {"held": False}

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Moves the jaw for ``frames`` steps."""
        share = numbers(action, "action")
        if share.shape != (4,) or not np.isfinite(share).all():
            raise Error(f"action has the shape {share.shape}; it must be (4,), all finite")
        *velocity, turn, closing = self._speed * _STEP * share.clip(-1, 1)
        before = self._distance()
        for _ in range(self._frames):
            held = self._move(np.array(velocity), turn / self._open, closing)
        self._taken += 1
        over = held or self._opening <= self._closed
        reward = (before - self._distance()) / self._radius + 10.0 * held
        return self._observe(), float(reward), over, not over and self._taken >= self._actions, {"held": held}

    def _place(self, middle: NDArray[np.float64], opening: float) -> None:
        ahead = opening * np.array([np.cos(self._angle), np.sin(self._angle)])
        self.fingers = np.array([[*(middle - ahead), self._angle], [*(middle + ahead), self._angle]])
        self._middle, self._opening = middle, opening

    def _move(self, velocity: NDArray[np.float64], turn: float, closing: float) -> bool:
        """Moves the jaw for one step; returns true if the object is held."""
        before, opening = self.fingers, self._opening
        way = _turned(self._angle) @ velocity
        self._angle += turn
        self._place(self._middle + way, min(max(opening - closing, self._closed), self._open))
        path = np.stack([before.ravel(), self.fingers.ravel()])
        result = rollout(self._scene, self._state[None], path, self._friction, h=_STEP, threads=1)
        self._state = np.concatenate([result["pose"][0, -1], result["twist"][0, -1]])
        lag = float(np.hypot(*result["pusher_lag"][0]))
        if lag > 0:
            # all fingers yield by the same length, each along its own motion
            motion = self.fingers[:, :2] - before[:, :2]
            moved = self.fingers[:, :2] - lag * motion / np.hypot(*motion.T).clip(1e-12)[:, None]
            self._place(moved.mean(axis=0), float(np.hypot(*(moved[1] - moved[0]))) / 2)
        self._look()
        rests = np.hypot(*self._state[3:5]) < 1e-3 and abs(self._state[5]) < 0.03
        return bool(lag > 0 and closing > 0 and rests)

    def _look(self) -> None:
        """Gives the tracker a row."""
        self._seen = self._distance() > self._hidden
        noise = self.np_random.normal(size=3) * self._noise
        pose = self._state[:3] + noise if self._seen else None
        self._estimate = self.tracker.push(self._frame * _STEP, pose, self.fingers[0], fingers=[self.fingers[1]])
        self._frame += 1

    def _distance(self) -> float:
        return float(np.hypot(*(self._state[:2] - self._middle)))

    def _observe(self) -> NDArray[np.float32]:
        here, to_jaw = self._estimate, _turned(self._angle).T
        spread = to_jaw @ [[here["std_x"] ** 2, here["cov_x_y"]], [here["cov_x_y"], here["std_y"] ** 2]] @ to_jaw.T
        turn = here["theta"] - self._angle
        place = to_jaw @ ([here["x"], here["y"]] - self._middle)
        columns = [*place, np.cos(turn), np.sin(turn), *np.sqrt(np.diag(spread).clip(0)), here["std_theta"]]
        columns += [self._opening, here["contact_pusher"], here["contact_1"], self._seen]
        return np.array([*columns, 1.0 - self._taken / self._actions], dtype=np.float32)


def _turned(angle: float) -> NDArray[np.float64]:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _reach(polygons: list[NDArray[np.float64]]) -> float:
    return float(max(np.hypot(*part.T).max() for part in polygons))
