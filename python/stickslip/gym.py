"""Gymnasium environment: push an object to a goal with a camera that may turn off.

Needs ``pip install 'stickslip[gym]'``. All environments of a vector are one rollout.
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
from stickslip.plan import prior

__all__ = ["PushEnv"]

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
    radius of gyration), and 10 on arrival.

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
        reach = [max(np.hypot(*part.T).max() for part in body) for body in (bodies.object, bodies.pusher)]
        self._away = sum(reach) + _CLEARANCE
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
        h = 1.0 / 30.0
        way = np.zeros((self.num_envs, 3))
        way[:, :2] = self._speed * h * share
        path = self._pusher[:, None, :] + np.arange(self._frames + 1)[None, :, None] * way[:, None, :]
        result = rollout(self._scene, self._state, path, self._friction, h=h, threads=self._threads)
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
