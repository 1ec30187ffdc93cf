"""Simulated experiments are those of the program, and files of them read back."""

import json
import subprocess

import numpy as np
import pytest

import stickslip

START = "\n[start]\nobject = [0.0, 0.0, 0.0]\npusher = [-0.032, -0.0033, 0.0]\nspeed = 0.02\nduration = 2.0\n"


@pytest.fixture(scope="module")
def scene(data) -> stickslip.Scene:
    text = (data / "bench-scene/scene.toml").read_text().replace("[pusher]", "[pusher]\nstall_force = 20.0")
    camera = "\n[camera]\nposition_std = 3e-4\norientation_std = 5e-3\n"
    return stickslip.Scene(text + camera + START)


@pytest.mark.parametrize("physics", ["model", "testbed"])
def test_a_simulation_is_that_of_the_program(program, scene, tmp_path, physics):
    ours = stickslip.simulate(scene, physics=physics, seed=4)
    ours.write(tmp_path / "ours")
    path = tmp_path / "scene.toml"
    path.write_text(scene.text)
    theirs = tmp_path / "theirs"
    command = [program, "simulate", path, "--out", theirs, "--physics", physics, "--seed", "4"]
    subprocess.run(command, check=True, capture_output=True)
    for name in ("log.csv", "scene.toml"):
        assert (tmp_path / "ours" / name).read_bytes() == (theirs / name).read_bytes()
    expected = stickslip.load_truth(theirs / "truth.csv")
    found = stickslip.load_truth(tmp_path / "ours/truth.csv")
    assert list(found) == list(expected)
    for name in expected:
        np.testing.assert_array_equal(found[name], expected[name])
        np.testing.assert_array_equal(ours.truth[name], expected[name])
    assert json.loads((theirs / "truth.json").read_text()) == ours.facts


def test_one_rig_has_many_noises(scene):
    first, other = (stickslip.simulate(scene, seed=4, noise_seed=seed) for seed in (4, 5))
    np.testing.assert_array_equal(first.truth["x"], other.truth["x"])
    assert not np.array_equal(first.log["object_x"], other.log["object_x"])
    rig = stickslip.simulate(scene, rig_seed=5, noise_seed=4)
    assert not np.array_equal(first.truth["x"], rig.truth["x"])


def test_true_friction_is_what_was_asked_for(scene):
    ours = stickslip.simulate(scene, physics="model", friction={"mu_s": 0.2})
    assert ours.facts["mu_s"] == 0.2
    other = stickslip.simulate(scene, physics="model")
    assert not np.array_equal(ours.truth["x"], other.truth["x"])


def test_what_cannot_be_simulated_is_refused(scene, data, tmp_path):
    with pytest.raises(stickslip.Error, match="no table"):
        stickslip.simulate(stickslip.load_scene(data / "bench-scene/scene.toml"))
    with pytest.raises(stickslip.Error, match="physics is `x`"):
        stickslip.simulate(scene, physics="x")
    with pytest.raises(stickslip.Error, match="friction has a `mu`"):
        stickslip.simulate(scene, friction={"mu": 0.1})
    (tmp_path / "log.csv").write_text("")
    with pytest.raises(stickslip.Error, match="is not empty"):
        stickslip.simulate(scene, physics="model").write(tmp_path)


def test_scores_are_their_formula(scene):
    ours = stickslip.simulate(scene, physics="model")
    estimate = stickslip.filter(ours.log, scene, particles=100, occlude=20)
    scores = stickslip.score(estimate, ours.log, scene, truth=ours.truth, occlude=20, virtual_radius=0.03)
    turn = np.angle(np.exp(1j * (estimate["theta"] - ours.truth["theta"])))
    square = (estimate["x"] - ours.truth["x"]) ** 2 + (estimate["y"] - ours.truth["y"]) ** 2 + (0.03 * turn) ** 2
    assert scores["wmse_mm"] == pytest.approx(1e3 * np.sqrt(square.mean()))
    assert scores["wmse_occluded_mm"] == pytest.approx(1e3 * np.sqrt(square[20:].mean()))
