"""The environments are deterministic rollouts, and simple policies solve them."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from test_plan import SCENE

import stickslip
from stickslip.gym import GraspEnv, PushEnv


@pytest.fixture
def env():
    return PushEnv(stickslip.Scene(SCENE), 32, dark=0.0)


def test_spaces_and_shapes_are_gymnasium_s(env):
    observation, _ = env.reset(seed=3)
    assert isinstance(env, gymnasium.vector.VectorEnv)
    assert env.observation_space.contains(observation)
    observation, reward, arrived, cut, _ = env.step(env.action_space.sample())
    assert env.observation_space.contains(observation)
    assert reward.shape == arrived.shape == cut.shape == (32,)
    with pytest.raises(stickslip.Error, match="must be \\(32, 2\\)"):
        env.step(np.zeros((3, 2)))


def test_the_same_seed_is_the_same_episode_and_another_is_not(env):
    def run(seed):
        observations = [env.reset(seed=seed)[0]]
        rng = np.random.default_rng(0)
        observations += [env.step(rng.uniform(-1, 1, (32, 2)))[0] for _ in range(30)]
        return np.stack(observations)

    np.testing.assert_array_equal(run(1), run(1))
    assert not np.array_equal(run(1), run(2))


def test_an_episode_is_cut_and_begins_anew(env):
    env = PushEnv(stickslip.Scene(SCENE), 4, actions=5)
    first, _ = env.reset(seed=0)
    still = np.zeros((4, 2))
    for k in range(5):
        last, reward, arrived, cut, _ = env.step(still)
        assert cut.all() == (k == 4) and not arrived.any()
        np.testing.assert_allclose(reward, 0, atol=1e-12)
    assert (last[:, 7] == 0).all()
    fresh, reward, _, cut, _ = env.step(still)
    assert (fresh[:, 7] == 1).all() and not cut.any() and (reward == 0).all()
    assert not np.array_equal(fresh[:, :2], first[:, :2])


def test_a_dark_camera_shows_the_last_pose(env):
    env = PushEnv(stickslip.Scene(SCENE), 8, dark=1.0)
    first, _ = env.reset(seed=0)
    # toward the object, so that it moves
    toward = -first[:, 4:6] / np.linalg.norm(first[:, 4:6], axis=1, keepdims=True)
    for _ in range(6):
        seen, *_, info = env.step(toward)
    assert (seen[:, 6] == 0).all()
    np.testing.assert_array_equal(seen[:, :4], first[:, :4])
    # what is seen is not where the object is
    assert (np.abs(info["distance"] - np.hypot(first[:, 0], first[:, 1])) > 1e-4).any()


def test_going_round_and_pushing_toward_the_goal_brings_the_object_nearer():
    env = PushEnv(stickslip.Scene(SCENE), 64, dark=0.0, actions=150, goal_distance=(0.04, 0.06))
    seen, _ = env.reset(seed=0)
    start = np.hypot(seen[:, 0], seen[:, 1])
    best = start.copy()
    for _ in range(140):
        to_goal, pusher = -seen[:, :2], seen[:, 4:6]
        ahead = to_goal / np.linalg.norm(to_goal, axis=1, keepdims=True)
        across = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        along, aside = (pusher * ahead).sum(1), (pusher * across).sum(1)
        # behind and in line: push, with a correction; else round the object at 4.5 cm
        radius = np.hypot(along, aside)
        round_it = np.sign(aside + 1e-9)[:, None] * np.column_stack([-pusher[:, 1], pusher[:, 0]]) / radius[:, None]
        keep = (0.045 - radius)[:, None] / 0.01 * pusher / radius[:, None]
        behind = (along < -0.02) & (np.abs(aside) < 0.012)
        action = np.where(behind[:, None], ahead - across * aside[:, None] / 0.01, round_it + keep)
        seen, _, arrived, _, _ = env.step(action.clip(-1, 1))
        best = np.where(arrived, 0.0, np.minimum(best, np.hypot(seen[:, 0], seen[:, 1])))
    assert np.median(best / start) < 0.5


@pytest.mark.parametrize("wrong", [{"num_envs": 0}, {"speed": 0.0}, {"dark": 2.0}])
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(stickslip.Error, match="must be above 0"):
        PushEnv(stickslip.Scene(SCENE), **wrong)


FINGER = "[[finger]]\nshape = [ { disc = { radius = 0.005 } } ]\n"
CAMERA = "[camera]\nposition_std = 3e-4\norientation_std = 5e-3\n"
BAR = "polygon = [[-0.035, -0.012], [0.035, -0.012], [0.035, 0.012], [-0.035, 0.012]]"


def _jaw():
    """A jaw and a bar, which is held across and slips out along."""
    return stickslip.Scene(SCENE.replace("disc = { radius = 0.03 }", BAR, 1) + FINGER + CAMERA)


def _grasped(env, seed, side):
    """Turns the bar's long side by `side` (rad) to the jaw's x-axis, comes over it along the jaw's y-axis, closes."""
    seen, _ = env.reset(seed=seed)
    turned = over = False
    observations, ended = [seen], False
    while not ended:
        x, y = seen[:2]
        turn = np.angle(np.exp(2j * (np.arctan2(seen[3], seen[2]) - side))) / 2
        turned |= abs(turn) < 0.02
        over |= abs(x) < 1e-3
        if not turned:
            action = [0, 0, turn / 0.2, 0]
        elif not over:
            # out of the object's reach first
            action = [x / 0.01, 0, 0, 0] if abs(y) > 0.08 else [0, -np.sign(y), 0, 0]
        else:
            action = [0, y / 0.01, 0, 0] if abs(y) > 2e-3 else [0, 0, 0, 1]
        seen, reward, terminated, cut, info = env.step(np.clip(action, -1, 1))
        observations.append(seen)
        ended = terminated or cut
    assert (reward > 9) == info["held"] and not cut
    return info["held"], np.array(observations)


@pytest.mark.filterwarnings("ignore:.*(infinity|spec):UserWarning")
def test_the_grasp_is_an_environment_of_gymnasium():
    check_env(GraspEnv(_jaw(), particles=50))


def test_a_jaw_across_the_bar_holds_it_where_the_camera_does_not_see_it():
    env = GraspEnv(_jaw(), particles=50, actions=200)
    ends = [_grasped(env, seed, np.pi / 2) for seed in range(6)]
    assert all(held for held, _ in ends)
    for _, seen in ends:
        hidden = seen[:, 10] == 0
        away = np.hypot(seen[:, 0], seen[:, 1])
        assert away[hidden].max() < away[~hidden].min() and hidden[-1] and not hidden[0]
        # both fingers touch, and the bar is between them: 12 mm and a finger's radius from the middle
        np.testing.assert_allclose(seen[-1, 7:10], [0.017, 1, 1], atol=0.1)
        assert abs(seen[-1, 7] - 0.017) < 1e-3


def test_a_jaw_beside_the_object_closes_on_nothing():
    env = GraspEnv(_jaw(), particles=50)
    seen, _ = env.reset(seed=0)
    terminated = False
    while not terminated:
        seen, _, terminated, _, info = env.step(np.array([0, 0, 0, 1]))
    assert not info["held"] and abs(seen[7] - 0.005) < 1e-6


def test_what_cannot_be_grasped_is_refused():
    with pytest.raises(stickslip.Error, match="one beside the pusher"):
        GraspEnv(stickslip.Scene(SCENE + CAMERA))
    with pytest.raises(stickslip.Error, match=r"no table \[camera\]"):
        GraspEnv(stickslip.Scene(SCENE + FINGER))
    with pytest.raises(stickslip.Error, match="frames and speed must be above 0"):
        GraspEnv(_jaw(), frames=0)
    env = GraspEnv(_jaw(), particles=50)
    env.reset(seed=0)
    with pytest.raises(stickslip.Error, match=r"must be \(4,\)"):
        env.step(np.zeros(3))
