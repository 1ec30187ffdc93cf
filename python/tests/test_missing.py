"""Masked values are missing, in every function that takes arrays."""

import numpy as np
import pandas as pd
import pytest

import stickslip
from stickslip import datasets

POSE = ("object_x", "object_y", "object_theta")


def _wrong_under_the_mask(demo):
    """The demo's log with wrong object poses from row 200 on, and their mask."""
    log = stickslip.load_log(demo / "log.csv")
    mask = np.arange(len(log["time"])) >= 200
    log["object_y"][mask] += 0.02
    log["tactile_1"][mask] = 1 - log["tactile_1"][mask]
    return log, mask


@pytest.mark.parametrize("kind", ["masked", "lists", "pandas", "objects"])
def test_filter_takes_masked_values_as_missing(demo, scene, kind):
    log, mask = _wrong_under_the_mask(demo)
    hidden = (*POSE, "tactile_1")
    make = {
        "masked": lambda values: np.ma.masked_array(values, mask),
        "lists": lambda values: [None if gone else value for value, gone in zip(values, mask, strict=True)],
        "pandas": lambda values: pd.Series(values, dtype="Float64").mask(mask),
        "objects": lambda values: [pd.NA if gone else value for value, gone in zip(values, mask, strict=True)],
    }[kind]
    given = log | {name: make(log[name]) for name in hidden}
    given["tactile_1"] = make(log["tactile_1"].astype(int)) if kind == "masked" else given["tactile_1"]
    expected = log | {name: np.where(mask, np.nan, log[name]) for name in hidden}
    found, wanted = (stickslip.filter(one, scene, particles=64) for one in (given, expected))
    np.testing.assert_array_equal(found["x"], wanted["x"])
    assert (found["visual"][200:] == 0).all()


def test_score_check_and_write_take_masked_values_as_missing(demo, scene, tmp_path):
    log, mask = _wrong_under_the_mask(demo)
    masked = log | {name: np.ma.masked_array(log[name], mask) for name in POSE}
    empty = log | {name: np.where(mask, np.nan, log[name]) for name in POSE}
    estimate = stickslip.filter(empty, scene, particles=16)
    np.testing.assert_equal(stickslip.score(estimate, masked, scene), stickslip.score(estimate, empty, scene))
    assert stickslip.check(masked, scene) == stickslip.check(empty, scene)
    folder = datasets.write_experiment(tmp_path / "out", scene.text, masked)
    np.testing.assert_array_equal(stickslip.load_log(folder / "log.csv")["object_y"], empty["object_y"])


def test_rows_and_tracker_take_masked_values_as_missing(demo, scene):
    log, mask = _wrong_under_the_mask(demo)
    masked = log | {name: np.ma.masked_array(log[name], mask) for name in (*POSE, "tactile_1")}
    (row,) = (row for k, row in enumerate(stickslip.rows(masked)) if k == 200)
    assert row["object"] is None and row["tactile"][0] is None
    estimates = []
    for pose in (None, np.ma.masked_all(3), pd.NA):
        tracker = stickslip.Tracker(scene, particles=64)
        tracker.push(0.0, object=np.ma.array([0.0, 0.0, 0.0]), pusher=(-0.1, 0.0, 0.0))
        touch = np.ma.array([1, 0, 0], mask=[True, False, False])
        estimates.append(tracker.push(0.03, object=pose, pusher=(-0.1, 0.0, 0.0), tactile=touch))
    assert [estimate["visual"] for estimate in estimates] == [0, 0, 0]
    with pytest.raises(stickslip.Error, match="all three must be finite"):
        tracker.push(0.06, object=np.ma.array([0.0, 0.0, 0.0], mask=[True, False, False]))


def test_rollout_refuses_masked_starts_and_frictions(scene):
    push = np.linspace([-0.1, 0, 0], [-0.05, 0, 0], 9)
    starts = np.ma.array(np.zeros((2, 3)), mask=[[False] * 3, [False, True, False]])
    for given in (starts, list(starts)):
        with pytest.raises(stickslip.Error, match="start 0 of trajectory 1 is not finite"):
            stickslip.rollout(scene, given, push)
    with pytest.raises(stickslip.Error, match="negative or not finite"):
        stickslip.rollout(scene, np.zeros((2, 3)), push, {"mu_s": np.ma.array([0.3, 0.3], mask=[True, False])})
