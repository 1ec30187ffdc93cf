"""Planning: outcomes are rollouts, and what they say of goals, jams and friction is what can be worked out by hand."""

import numpy as np
import pytest

import stickslip
from stickslip import plan

SCENE = """
gravity = 9.81
[object]
mass = 0.5
inertia = 2.1e-4
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.3
tripod_radius = 0.02
[pusher]
friction = 0.3
stall_force = 20.0
shape = [ { disc = { radius = 0.005 } } ]
[fixels]
friction = 0.3
"""
WALL = "[[fixel]]\nposition = [0.05, 0.0]\nshape = [ { disc = { radius = 0.005 } } ]\n"


@pytest.fixture(scope="module")
def free():
    return stickslip.Scene(SCENE)


def _along_x(lengths, y=0.0):
    """Pushes along x from 2 mm before the disc (N, 61, 3), of these lengths beyond the touch."""
    share = np.linspace(0, 1, 61)
    x = -0.037 + share * (np.asarray(lengths)[:, None] + 0.002)
    return np.stack([x, np.full_like(x, y), np.zeros_like(x)], axis=-1)


def test_the_nearest_push_is_the_one_that_goes_as_far_as_the_goal(free):
    outcome = plan.predict(free, (0, 0, 0), _along_x([0.01, 0.02, 0.03]))
    np.testing.assert_allclose(outcome.pose[:, 0, 0], [0.01, 0.02, 0.03], atol=1e-4)
    assert outcome.nearest((0.021, 0, 0)) == 1
    np.testing.assert_allclose(outcome.distance((0.02, 0, 2 * np.pi)), [0.01, 0.0, 0.01], atol=1e-4)
    assert (outcome.jam_probability == 0).all()


def test_pushes_against_a_wall_jam_and_can_be_shunned():
    outcome = plan.predict(stickslip.Scene(SCENE + WALL), (0, 0, 0), _along_x([0.01, 0.03]))
    np.testing.assert_array_equal(outcome.jam_probability, [0, 1])
    np.testing.assert_allclose(outcome.pose[1, 0, :2], [0.015, 0], atol=1e-3)
    assert outcome.nearest((0.015, 0, 0)) == 1
    assert outcome.nearest((0.015, 0, 0), jam_below=0.5) == 0
    with pytest.raises(stickslip.Error, match="every push jams"):
        plan.predict(stickslip.Scene(SCENE + WALL), (0, 0, 0), _along_x([0.03])).nearest((0, 0, 0), jam_below=0.1)


def test_a_push_off_centre_tells_of_friction_and_one_through_the_centre_does_not(free):
    friction = plan.prior(free, 64, seed=1)
    pushes = np.concatenate([_along_x([0.02]), _along_x([0.02], y=0.015)])
    outcome = plan.predict(free, (0, 0, 0), pushes, friction)
    straight, off = outcome.information(position_std=3e-4, orientation_std=5e-3)
    assert straight < 0.05 and off > 1.0
    # by the definition: half of ln det(I + C / noise)
    scaled = outcome.pose[1] / [3e-4, 3e-4, 5e-3]
    expected = 0.5 * np.log(np.linalg.det(np.eye(3) + np.cov(scaled.T)))
    assert off == pytest.approx(expected)
    alone = stickslip.rollout(free, [[0, 0, 0]], pushes[1], {name: value[5] for name, value in friction.items()})
    np.testing.assert_array_equal(outcome.pose[1, 5], alone["pose"][0, -1])


def test_the_prior_is_log_normal_about_the_scene_s_friction(free):
    drawn = plan.prior(free, 20000)
    for name, std in (("mu_s", 0.35), ("mu_p", 0.45), ("mu_f", 0.45), ("d_tri", 0.25)):
        logs = np.log(drawn[name] / free.friction[name])
        assert np.median(logs) == pytest.approx(0, abs=0.02)
        # quartiles, which the limits do not reach
        assert np.subtract(*np.quantile(logs, [0.75, 0.25])) == pytest.approx(1.349 * std, rel=0.05)


def test_straight_pushes_begin_clear_of_the_object_and_most_move_it(free):
    pushes = plan.straight_pushes(free, (0.1, 0.2, 0.3), 200, length=0.03)
    away = np.hypot(*(pushes[:, 0, :2] - [0.1, 0.2]).T)
    assert (away > 0.035).all()
    way = np.hypot(*np.diff(pushes[:, :, :2], axis=1).transpose(2, 0, 1))
    np.testing.assert_allclose(way, 0.02 / 30)
    outcome = plan.predict(free, (0.1, 0.2, 0.3), pushes)
    moved = np.hypot(*(outcome.pose[:, 0, :2] - [0.1, 0.2]).T)
    assert (moved > 1e-3).mean() > 0.9
    with pytest.raises(stickslip.Error, match="above 0"):
        plan.straight_pushes(free, (0, 0, 0), 0, length=0.03)


def test_a_jaw_closes_until_its_fingers_meet():
    bar = "shape = [ { polygon = [[-0.004, -0.02], [0.004, -0.02], [0.004, 0.02], [-0.004, 0.02]] } ]"
    disc = "shape = [ { disc = { radius = 0.005 } } ]"
    jaw = stickslip.Scene(SCENE.replace(disc, bar) + f"[[finger]]\n{bar}\n")
    first, last = plan.jaw_closings(jaw, (0.1, 0, 0), angles=[0.0])[0][[0, -1]]
    np.testing.assert_allclose(first, [0.064, 0, 0, 0.136, 0, 0], atol=1e-12)  # 2 mm from a disc of 30 mm
    np.testing.assert_allclose(last, [0.096, 0, 0, 0.104, 0, 0], atol=1e-12)
