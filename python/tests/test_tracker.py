"""Row by row is the causal filter."""

import numpy as np
import pytest

import stickslip
from stickslip import plan


def test_a_tracker_has_the_bits_of_the_causal_filter(demo, scene):
    log = stickslip.load_log(demo / "log.csv")
    log = {name: column[:160] for name, column in log.items()}
    for name in ("object_x", "object_y", "object_theta"):
        log[name][80:] = np.nan
    whole = stickslip.filter(log, scene, causal=True, particles=100, seed=3)
    tracker = stickslip.Tracker(scene, particles=100, seed=3, late=0.0)
    for row, measured in enumerate(stickslip.rows(log)):
        estimate = tracker.push(**measured)
        assert list(estimate) == list(whole)
        for name, value in estimate.items():
            np.testing.assert_array_equal(value, whole[name][row], err_msg=f"{name}, row {row}")
    np.testing.assert_equal(tracker.estimate, estimate)
    assert tracker.collapses == 0


def test_rows_that_cannot_be_used_are_refused_and_change_nothing(demo, scene):
    tracker = stickslip.Tracker(scene, particles=64)
    before = tracker.push(0.0, object=(0.0, 0.0, 0.0), pusher=(-0.1, 0.0, 0.0))
    for row, words in [
        ({"time": float("nan")}, "time is NaN"),
        ({"time": 0.03, "object": (float("nan"), 0, 0)}, "all three must be finite"),
        ({"time": 0.03, "tactile": [True] * 9}, "9 tactile readings"),
        ({"time": 60.0}, "start a new tracker"),
        ({"time": -1.0, "object": (0, 0, 0)}, "remembers 0.2 s"),
    ]:
        with pytest.raises(stickslip.Error, match=words):
            tracker.push(**row)
    np.testing.assert_equal(tracker.estimate, before)
    with pytest.raises(stickslip.Error, match="model is `x`"):
        stickslip.Tracker(scene, model="x")


def test_a_reading_is_0_or_1_as_a_bool_an_int_or_a_numpy_number(scene):
    tracker = stickslip.Tracker(scene, particles=64)
    readings = [[True, False, None], [1, 0, None], [1.0, 0.0, None], np.array([1, 0, 1]), np.array([True, False, True])]
    for k, tactile in enumerate(readings):
        tracker.push(0.03 * k, object=(1e-6 * k, 0.0, 0.0), pusher=(-0.1, 0.0, 0.0), tactile=tactile)
    for row, words in [
        ({"tactile": [2, 0, 0]}, r"tactile is \[2, 0, 0\]: a reading is 2; it must be 0 or 1"),
        ({"object": (0.0, 0.0)}, r"object is \[0.0, 0.0\]: "),
    ]:
        with pytest.raises(stickslip.Error, match=words):
            tracker.push(1.0, **row)


def test_hand_is_tracked_and_rolled_out() -> None:
    finger = {"shape": [{"disc": {"radius": 0.005}}]}
    jaw = stickslip.Scene.from_numbers(
        gravity=9.81,
        object={"mass": 0.5, "inertia": 2e-4, "shape": [{"disc": {"radius": 0.03}}]},
        support={"friction": 0.3, "tripod_radius": 0.02},
        pusher={**finger, "friction": 0.3, "stall_force": 20.0},
        finger=[finger],
        fixels={"friction": 0.25},
        camera={"position_std": 3e-4, "orientation_std": 5e-3},
    )
    assert jaw.fingers == 1
    way = np.linspace(0.0, 0.015, 46)
    zero = np.zeros_like(way)
    # both close on a disc that is 6 mm off their middle, and bring it there
    fingers = np.stack([way - 0.05, zero, zero, 0.05 - way, zero, zero], axis=1)
    end = stickslip.rollout(jaw, [[0.006, 0.0, 0.0]], fingers)["pose"][0, -1]
    assert abs(end[0]) < 1e-4
    tracker = stickslip.Tracker(jaw, particles=64)
    for row, place in enumerate(fingers):
        seen = (0.006 + 1e-9 * row, 0.0, 0.0) if row < 10 else None
        estimate = tracker.push(row / 30, object=seen, pusher=place[:3], fingers=[place[3:]])
    assert abs(estimate["x"]) < 1e-3 and estimate["contact_1"] > 0.5
    with pytest.raises(stickslip.Error, match=r"\(1, T \+ 1, 6\)"):
        stickslip.rollout(jaw, [[0.0, 0.0, 0.0]], fingers[:, :3])


def test_a_copy_goes_on_by_itself(demo, scene):
    log = stickslip.load_log(demo / "log.csv")
    rows = list(stickslip.rows(log))
    tracker = stickslip.Tracker(scene, particles=64, late=0.0)
    assert tracker.particles()["x"].shape == (0,)
    for row in rows[:120]:
        tracker.push(**row)
    twin = tracker.copy()
    before = tracker.estimate
    for row in rows[120:140]:
        own = twin.push(**{**row, "object": None})
    # what the twin takes leaves the tracker as it was
    np.testing.assert_equal(tracker.estimate, before)
    for row in rows[120:140]:
        again = tracker.push(**{**row, "object": None})
    np.testing.assert_equal(again, own)
    # its particles are those of the whole log
    run = stickslip.particles(log, scene, rows=[139], particles=64, causal=True, occlude=(120, 140))
    cloud = tracker.particles()
    assert set(cloud) | {"row"} == set(run)
    for name, column in cloud.items():
        np.testing.assert_array_equal(column, run[name][0], err_msg=name)


def test_how_a_grasp_ends_is_predicted_and_the_best_one_chosen() -> None:
    finger = {"shape": [{"polygon": [[-0.004, -0.01], [0.004, -0.01], [0.004, 0.01], [-0.004, 0.01]]}]}
    bar = [{"polygon": [[-0.03, -0.01], [0.03, -0.01], [0.03, 0.01], [-0.03, 0.01]]}]
    jaw = stickslip.Scene.from_numbers(
        gravity=9.81,
        object={"mass": 0.5, "shape": bar},
        support={"friction": 0.3},
        pusher={**finger, "friction": 0.3, "stall_force": 20.0},
        finger=[finger],
        fixels={"friction": 0.25},
        camera={"position_std": 3e-4, "orientation_std": 5e-3},
    )
    tracker = stickslip.Tracker(jaw, particles=64)
    with pytest.raises(stickslip.Error, match="no pose of the object"):
        tracker.outcomes(np.zeros((2, 6)))
    for row in range(3):
        tracker.push(row / 30, object=(1e-9 * row, 0.0, 0.0), pusher=(-0.05, 0, 0), fingers=[(0.05, 0, 0)])
    before = tracker.estimate
    # across the bar, and past its end
    closings = plan.jaw_closings(jaw, (0.0, 0.0, 0.0), angles=[np.pi / 2], offsets=[0.0, 0.05])
    best, ends = plan.grasp(tracker, closings)
    assert best == 0 and ends[0]["held"] > 0.9 and ends[1]["lost"] > 0.9
    assert plan.grasp(tracker, closings, wanted=("moving", "lost"))[0] == 1
    assert ends[0]["contacts"][0] == (["pusher", "finger 1"], pytest.approx(1.0, abs=0.1))
    sums = [end["held"] + end["jammed"] + end["resting"] + end["moving"] + end["lost"] for end in ends]
    np.testing.assert_allclose(sums, 1.0)
    assert abs(ends[0]["y"]) < 1e-3 and ends[0]["std_y"] < 1e-3
    # the tracker stays as it is
    np.testing.assert_equal(tracker.estimate, before)
    for words, path in [("must be", closings), ("pusher and its", closings[0][:, :3])]:
        with pytest.raises(stickslip.Error, match=words):
            tracker.outcomes(path)
    with pytest.raises(stickslip.Error, match="wanted is 'kept'"):
        plan.grasp(tracker, closings, wanted="kept")
