"""Estimates from Python are those of the program, and logs may come as files, dicts or data frames."""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import stickslip


def _read(path: Path) -> pd.DataFrame:
    """A file of columns, every number by Python's own reader; NaN where a cell is empty."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return pd.DataFrame({name: [float(row[name] or "nan") for row in rows] for name in rows[0]})


def _by_program(program: str, folder: Path, out: Path, *options: str) -> pd.DataFrame:
    command = [program, "filter", folder / "log.csv", "--scene", folder / "scene.toml", "--out", out, "--json"]
    done = subprocess.run([*command, *options], check=True, capture_output=True, text=True)
    frame = _read(out / "estimate.csv")
    frame.attrs = json.loads(done.stdout)
    return frame


@pytest.mark.parametrize(
    ("flags", "options"),
    [
        (["--occlude", "200"], {"occlude": 200}),
        (["--model", "paper", "--seed", "7", "--particles", "96", "--no-tactile", "--occlude", "150:300"],
         {"model": "paper", "seed": 7, "particles": 96, "tactile": False, "occlude": (150, 300)}),
        (["--causal", "--occlude-middle", "1"], {"causal": True, "occlude_middle": 1.0, "threads": 2}),
        (["--method", "kalman"], {"method": "kalman"}),
        (["--method", "extended-kalman", "--occlude", "200"], {"method": "extended-kalman", "occlude": 200}),
        (["--method", "nominal", "--substeps", "2"], {"method": "nominal", "substeps": 2}),
    ],
)  # fmt: skip
def test_estimates_have_the_bits_of_the_program(program, demo, scene, tmp_path, flags, options):
    expected = _by_program(program, demo, tmp_path, *flags)
    found = stickslip.filter(demo / "log.csv", scene, **options)
    assert list(found) == list(expected.columns)
    for name, column in found.items():
        np.testing.assert_array_equal(column, expected[name].to_numpy(np.float64), err_msg=name)
    hidden = {name: options[name] for name in ("occlude", "occlude_middle") if name in options}
    scores = stickslip.score(
        found, demo / "log.csv", scene, truth=stickslip.load_truth(demo / "truth.csv"),
        first_pusher_contact=json.loads((demo / "truth.json").read_text())["first_pusher_contact"], **hidden,
    )  # fmt: skip
    for name in ("wmse_mm", "wmse_occluded_mm", "wmse_moving_mm", "final_error_mm", "final_error_deg"):
        expected_score = expected.attrs[name]
        assert (np.isnan(scores[name]) and expected_score is None) or scores[name] == expected_score, name


def test_logs_as_dicts_and_data_frames_are_the_file(demo, scene):
    path = demo / "log.csv"
    options = {"particles": 64, "occlude": 100}
    from_file = stickslip.filter(path, scene, **options)
    frame = _read(path)
    as_lists = {name: list(column) for name, column in stickslip.load_log(path).items()}
    integers = frame.astype({name: "Int64" for name in frame if name.startswith("tactile")})
    for log in (str(path), frame, as_lists, frame[list(reversed(frame.columns))], integers):
        found = stickslip.filter(log, scene, **options)
        for name, column in from_file.items():
            np.testing.assert_array_equal(found[name], column, err_msg=name)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda log: log.pop("pusher_y"), "the column `pusher_y` is missing"),
        (lambda log: log.update(time=log["time"][:-1]), "entries and `time`"),
        (lambda log: log["object_x"].__setitem__(5, np.nan), "row 5: `object_x` is NaN and `object_y` is not"),
        (lambda log: log["time"].__setitem__(7, 0.0), "row 7 is at 0 s"),
        (lambda log: log["time"].__setitem__(7, np.nan), "row 7: `time` is NaN"),
        (lambda log: log["tactile_1"].__setitem__(3, 0.5), "row 3: `tactile_1` is 0.5; it must be 0, 1 or NaN"),
        (lambda log: log.update(tactile_9=log["tactile_1"]), "a column `tactile_9` and no `tactile_4`"),
        (lambda log: log["object_x"].__setitem__(5, np.inf), "must be finite"),
        (lambda log: log.update(object_x=np.zeros((3, 3))), "has the shape (3, 3)"),
        (lambda log: log.update(object_x=["a"] * 3), "no number"),
        (lambda log: [log[f"object_{c}"].fill(np.nan) for c in ("x", "y", "theta")], "no visible object pose"),
    ],
)
def test_logs_that_cannot_be_used_are_refused(demo, scene, change, words):
    log = stickslip.load_log(demo / "log.csv")
    change(log)
    with pytest.raises(stickslip.Error) as refusal:
        stickslip.filter(log, scene)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"particles": 0}, "0 particles"),
        ({"model": "fast"}, "model is `fast`; it must be `robust` or `paper`"),
        ({"method": "ekf"}, "method is `ekf`"),
        ({"occlude": (9, 3)}, "occlude is (9, 3)"),
        ({"occlude": "10:20"}, "occlude is '10:20'"),
        ({"particles": -1}, "particles is -1"),
        ({"occlude": 9, "occlude_middle": 1.0}, "both given"),
        ({"threads": 0}, "0 threads"),
        ({"substeps": 0}, "0 substeps"),
    ],
)
def test_options_that_cannot_be_are_refused(demo, scene, options, words):
    with pytest.raises(stickslip.Error) as refusal:
        stickslip.filter(demo / "log.csv", scene, **options)
    assert words in str(refusal.value)


def test_columns_that_a_log_does_not_have_are_warned_of(demo, scene):
    log = stickslip.load_log(demo / "log.csv") | {
        "humidity": np.zeros(len(stickslip.load_log(demo / "log.csv")["time"]))
    }
    with pytest.warns(UserWarning, match="humidity"):
        stickslip.filter(log, scene, particles=8)


def test_scenes_are_refused_with_their_place(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("gravity = 0\n")
    with pytest.raises(ValueError, match=r"scene\.toml:1:11: gravity is 0") as refusal:
        stickslip.load_scene(path)
    assert isinstance(refusal.value, stickslip.Error)
    with pytest.raises(FileNotFoundError):
        stickslip.load_scene(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("model", "means"),
    [
        ("paper", ("x", "y", "mu_s", "mu_p", "mu_f", "d_tri")),
        # whose pose is no mean, but the one that is nearest to the particles
        ("robust", ("mu_s", "mu_p", "mu_f", "d_tri")),
    ],
)
def test_particles_have_the_means_of_the_estimate(demo, scene, model, means):
    options = {"particles": 200, "occlude": 200, "model": model}
    estimate = stickslip.filter(demo / "log.csv", scene, **options)
    cloud = stickslip.particles(demo / "log.csv", scene, rows=[250, 10], **options)
    np.testing.assert_array_equal(cloud["row"], [10, 250])
    assert cloud["x"].shape == (2, 200)
    np.testing.assert_allclose(cloud["weight"].sum(axis=1), 1)
    for name in means:
        mean = (cloud["weight"] * cloud[name]).sum(axis=1)
        np.testing.assert_allclose(mean, estimate[name][[10, 250]], rtol=1e-9, atol=1e-12, err_msg=name)
    for name in ("x", "y"):
        square = (cloud["weight"] * (cloud[name] - estimate[name][[10, 250], None]) ** 2).sum(axis=1)
        np.testing.assert_allclose(np.sqrt(square), estimate[f"std_{name}"][[10, 250]], rtol=1e-5, err_msg=name)


def test_samples_have_equal_weight_and_the_posterior_s_moments(demo, scene):
    options = {"particles": 400, "occlude": 200}
    posterior = stickslip.samples(demo / "log.csv", scene, rows=[250, 100], chains=2, draws=40000, **options)
    assert posterior["mu_p"].shape == (2, 40000, 2)
    for chain, seed in enumerate((0, 1)):
        estimate = stickslip.filter(demo / "log.csv", scene, seed=seed, **options)
        cloud = stickslip.particles(demo / "log.csv", scene, rows=[100, 250], seed=seed, **options)
        for draw, row in enumerate((250, 100)):
            # systematic resampling: each particle's share is off by less than 1 / draws
            values, weight, x = posterior["x"][chain, :, draw], cloud["weight"][1 - draw], cloud["x"][1 - draw]
            mean = (weight * x).sum()
            std = np.sqrt((weight * (x - mean) ** 2).sum())
            assert abs(values.mean() - mean) < 0.05 * std
            assert values.std() == pytest.approx(std, rel=0.05)
            off = values - estimate["x"][row]
            assert np.sqrt((off**2).mean()) == pytest.approx(estimate["std_x"][row], rel=0.05)
            values = posterior["mu_p"][chain, :, draw]
            assert abs(values.mean() - estimate["mu_p"][row]) < 0.05 * estimate["std_mu_p"][row]
