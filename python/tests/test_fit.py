"""What many pushes teach: the numbers of the program, and the truth of simulated pushes."""

import json
import shutil
import subprocess

import numpy as np
import pytest
import study_functions

import stickslip
from stickslip import study

SCENE = """
gravity = 9.81
object  = {{ mass = 0.5, inertia = 3.3e-4, shape = [{{ polygon = [[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]] }}] }}
support = {{ friction = 0.3, tripod_radius = 0.025 }}
pusher  = {{ friction = 0.3, stall_force = 100.0, shape = [{{ disc = {{ radius = 0.005 }} }}] }}
fixels  = {{ friction = 0.25 }}
camera  = {{ position_std = 3.0e-4, orientation_std = 5.0e-3 }}
start   = {{ object = [0, 0, 0], pusher = [{x}, -0.0285, 0], direction = {direction}, speed = 0.02, duration = 1.5 }}
"""  # noqa: E501
PUSHES = [(-0.025, 2.07), (0.015, 0.97), (-0.01, 1.87), (0.028, 1.17)]
TRUE_MU_P = 0.5


@pytest.fixture(scope="module")
def pushes() -> list[stickslip.Simulation]:
    scenes = [stickslip.Scene(SCENE.format(x=x, direction=direction)) for x, direction in PUSHES]
    return [
        stickslip.simulate(scene, physics="model", seed=k, friction={"mu_p": TRUE_MU_P})
        for k, scene in enumerate(scenes)
    ]


@pytest.fixture(scope="module")
def fitted(pushes) -> stickslip.Fit:
    return stickslip.fit(pushes, ["mu_p", "mu_f"])


@pytest.fixture(scope="module")
def folder(pushes, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    for k, push in enumerate(pushes):
        push.write(folder / "pushes" / f"push {k}")
    return folder


def test_the_truth_is_within_the_spread_and_what_no_push_shows_keeps_its_guess(fitted):
    assert fitted.names == ("mu_p", "mu_f") and fitted.determined == {"mu_p": True, "mu_f": False}
    assert abs(fitted.values["mu_p"] - TRUE_MU_P) < 3 * fitted.stds["mu_p"] < 0.15 * TRUE_MU_P
    assert fitted.values["mu_f"] == pytest.approx(fitted.prior_values["mu_f"], rel=0.2)
    assert fitted.stds["mu_f"] == pytest.approx(fitted.prior_stds["mu_f"], rel=0.2)
    assert fitted.scene.friction["mu_p"] == pytest.approx(fitted.values["mu_p"], rel=1e-5)
    unfitted, error = fitted.cross_validation["median_final_mm"]
    assert error < 0.6 * unfitted


def test_draws_have_the_spreads_and_the_correlation_of_the_posterior(fitted):
    assert {draws.shape for draws in fitted.draws.values()} == {(512,)}
    mu_p = fitted.draws["mu_p"]
    assert np.std(mu_p) == pytest.approx(fitted.stds["mu_p"], rel=0.25)
    assert abs(np.median(mu_p) - fitted.values["mu_p"]) < fitted.stds["mu_p"]
    logs = [np.log(fitted.draws[name]) for name in fitted.names]
    np.testing.assert_allclose(np.corrcoef(logs), fitted.correlation, atol=0.15)


def test_numbers_are_those_of_the_program(fitted, folder, program):
    command = [program, "fit", "pushes", "--free", "mu_f,mu_p", "--out", "out"]
    subprocess.run(command, check=True, capture_output=True, cwd=folder)
    theirs = json.loads((folder / "out/fit.json").read_text())
    of_folders = stickslip.fit(folder / "pushes", ["mu_p", "mu_f"], threads=1)
    assert {"folders": theirs["folders"], "seed": 0, **of_folders.result} == theirs
    assert (folder / "out/scene.toml").read_text() == of_folders.scene.text
    names = [push["push"] for push in of_folders.cross_validation["pushes"]]
    assert names == [f"push {k}" for k in range(4)]
    # simulations and their files are the same pushes
    assert fitted.result == of_folders.result


def test_a_notebook_shows_the_page_of_the_program(fitted):
    page = fitted.page()
    assert "<title>Fit to 4 pushes</title>" in page and "Predictions of pushes left out" in page
    assert "predicted - measured (mm)" in page and ": largest error of pushes left out" in page
    assert "srcdoc" in fitted._repr_html_()
    assert "_page" not in repr(fitted)


def test_pushes_of_two_objects_are_refused(pushes):
    heavy = pushes[1].scene.text.replace("mass = 0.5", "mass = 0.7")
    with pytest.raises(stickslip.Error, match="push 1 has another object than push 0"):
        stickslip.fit([pushes[0], (stickslip.Scene(heavy), pushes[1].log)])


def test_pairs_of_a_scene_and_a_log_are_pushes_too(pushes, fitted, folder):
    pairs = [(push.scene, push.log) for push in pushes]
    assert stickslip.fit(pairs, ["mu_p", "mu_f"]).values == fitted.values
    paths = [(folder / f"pushes/push {k}/scene.toml", folder / f"pushes/push {k}") for k in range(4)]
    assert stickslip.fit(paths, ["mu_p", "mu_f"]).values == fitted.values
    with pytest.raises(stickslip.Error, match="topics are for MCAP logs"):
        stickslip.fit(paths, topics={"object": "/box"})


def test_the_fit_of_an_object_is_a_task_of_a_study(folder, tmp_path):
    objects = [tmp_path / name for name in ("box", "cup")]
    for path in objects:
        shutil.copytree(folder / "pushes", path)
    tasks = [{"folder": str(path)} for path in objects]

    def run():
        function = study_functions.fit_object
        rows = study.run(tasks, tmp_path / "fits", function=function, backend="threading", progress=False)
        return [row["parameters"][0]["value"] for row in rows]

    first, second = run()
    assert first == second == stickslip.fit(objects[0], ["mu_p"], folds=0).values["mu_p"]
    for file in (tmp_path / "fits").glob("*.json"):
        file.write_text('{"parameters": [{"value": -1}]}')  # a result that only a file can have
    with (objects[1] / "push 0/log.csv").open("a") as log:
        log.write("\n")
    assert run() == [-1, second]


def test_what_cannot_be_learnt_from_is_refused(pushes, folder):
    with pytest.raises(stickslip.Error, match="`mu_q` is no parameter that can be learnt"):
        stickslip.fit(pushes, ["mu_q"])
    with pytest.raises(stickslip.Error, match="1 push given; at least 2"):
        stickslip.fit(pushes[:1])
    with pytest.raises(stickslip.Error, match="0 pushes given"):
        stickslip.fit([])
    blind = pushes[1].log | {
        name: np.full(len(pushes[1].log["time"]), np.nan) for name in ("object_x", "object_y", "object_theta")
    }
    with pytest.raises(stickslip.Error, match="push 1: "):
        stickslip.fit([pushes[0], (pushes[1].scene, blind)])
    with pytest.raises(FileNotFoundError):
        stickslip.fit(folder / "none")
