"""Importers give back a motion that is known, whatever clock, unit and frame a file has it in."""

import dataclasses
import json
import shutil
import subprocess

import h5py
import numpy as np
import pytest

import stickslip
from stickslip import datasets
from stickslip.datasets import _zhou

SCENE = datasets.scene_text("{ disc = { radius = 0.03 } }", mass=0.5, inertia=2.1e-4, pusher_radius=0.005)


def _motion(time):
    """A pose at each time (n, 3): a curve, turning."""
    return np.column_stack([0.1 + 0.02 * time, 0.05 * np.sin(time), 3.0 + 0.8 * time])


def _streams():
    """Object at 250 Hz whose angle jumps by quarter turns, finger at 100 Hz, unlike clocks' starts."""
    rng = np.random.default_rng(0)
    objects = np.arange(5.0, 9.0, 1 / 250)
    jumps = 0.5 * np.pi * np.repeat(rng.integers(-2, 3, 40), 25)
    pose = _motion(objects - 5.0)
    pose[:, 2] = np.angle(np.exp(1j * (pose[:, 2] + jumps)))
    fingers = np.arange(4.9, 9.1, 1 / 100)
    force = np.column_stack([fingers, np.full(len(fingers), 0.5), fingers, np.zeros(len(fingers))])
    return {
        "object_pose": np.column_stack([objects, pose]).tolist(),
        "tip_pose": np.column_stack([fingers, _motion(fingers - 5.0)]).tolist(),
        "ft_wrench": force.tolist(),
    }


def _check_motion(folder, quarter=True):
    scene, log = stickslip.load_scene(folder / "scene.toml"), stickslip.load_log(folder / "log.csv")
    expected = _motion(log["time"])
    for k, name in enumerate(("x", "y", "theta")):
        np.testing.assert_allclose(log[f"pusher_{name}"], expected[:, k], atol=2e-5)
        away = log[f"object_{name}"] - expected[:, k]
        if name == "theta":
            turns = away[0] / (0.5 * np.pi)
            assert turns == pytest.approx(round(turns), abs=1e-4)
            away -= away[0]
        np.testing.assert_allclose(away, 0, atol=2e-5)
    assert scene.fixels == 0
    return log


def test_mit_json_of_unlike_clocks_and_jumping_angles_is_the_motion(tmp_path):
    file = tmp_path / "push.json"
    file.write_text(json.dumps(_streams()))
    log = _check_motion(datasets.import_mit(file, SCENE, tmp_path / "out", force_sign=-1.0))
    np.testing.assert_allclose(np.diff(log["time"]), 1 / 30, atol=1e-12)
    np.testing.assert_allclose(log["pusher_force_x"], -0.5)
    # the mean of a force that rises with time is its value in the middle of the interval
    np.testing.assert_allclose(-log["pusher_force_y"], log["time"] + 5.0 - 1 / 60, atol=6e-3)
    # a finger in the middle of the object is no push
    stickslip.filter(log, stickslip.Scene(SCENE), particles=16, force=True)


def test_omnipush_hdf5_is_the_motion(tmp_path):
    streams = _streams()
    with h5py.File(tmp_path / "push.h5", "w") as file:
        objects = np.asarray(streams["object_pose"])
        objects[:, 3] = np.angle(np.exp(1j * _motion(objects[:, 0] - 5.0)[:, 2]))
        file["object_pose"], file["tip_pose"] = objects, np.asarray(streams["tip_pose"])
    log = _check_motion(datasets.import_omnipush(tmp_path / "push.h5", SCENE, tmp_path / "out"))
    assert "pusher_force_x" not in log


def test_gaps_stay_empty(tmp_path):
    streams = _streams()
    streams["object_pose"] = [row for row in streams["object_pose"] if not 6.001 < row[0] < 6.499]
    file = tmp_path / "push.json"
    file.write_text(json.dumps(streams))
    log = stickslip.load_log(datasets.import_mit(file, SCENE, tmp_path / "out") / "log.csv")
    gone = np.isnan(log["object_x"])
    np.testing.assert_array_equal(gone, (log["time"] > 1.0 + 1e-9) & (log["time"] < 1.5 - 1e-9))


def test_spatial_poses_are_made_planar_by_their_calibration():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    rng = np.random.default_rng(2)
    body = np.eye(4)
    body[:3, :3], body[:3, 3] = rotation.random(rng=rng).as_matrix(), [10.0, -5.0, 3.0]
    theta, place = rng.uniform(-3, 3, 20), rng.uniform(-100, 100, (20, 3))
    wanted = np.tile(np.eye(4), (20, 1, 1))
    wanted[:, :3, :3], wanted[:, :3, 3] = rotation.from_euler("z", theta[:, None]).as_matrix(), place
    tracked = wanted @ np.linalg.inv(body)
    x, y, z, w = rotation.from_matrix(tracked[:, :3, :3]).as_quat().T
    found = datasets.planar(tracked[:, :3, 3], np.column_stack([w, x, y, z]), body)
    np.testing.assert_allclose(found, np.column_stack([place[:, :2], theta]), atol=1e-9)


def test_two_finger_runs_are_cut_where_the_hand_is_lifted(tmp_path):
    time = 1495591820.0 + np.concatenate([np.arange(0, 2, 0.04), np.arange(4, 6, 0.04)])
    pose = _motion(time - 1495591820.0)
    pose[:, 2] = np.angle(np.exp(1j * pose[:, 2]))
    millimetres = pose * [1e3, 1e3, 1.0]
    rows = np.column_stack([time, millimetres, millimetres, np.repeat([3.0, 1.0], 50)])
    rows[10, 1:4] = 0
    np.savetxt(tmp_path / "log.txt", rows, delimiter=",", fmt="%.12g")
    (whole,) = datasets.import_two_finger(tmp_path / "log.txt", SCENE, tmp_path / "whole", shift=(0.001, 0.0))
    log = stickslip.load_log(whole / "log.csv")
    lifted = np.isnan(log["pusher_x"])
    assert log["time"][0] == 0 and lifted.sum() == pytest.approx(2.04 * 30, abs=2)
    assert np.isnan(log["object_x"][9]) and not np.isnan(log["pusher_x"][9])
    seen = ~np.isnan(log["object_x"])
    expected = _motion(log["time"] + time[1] - 1495591820.0)
    np.testing.assert_allclose(log["object_x"][seen], expected[seen, 0] + 0.001, atol=1e-6)
    np.testing.assert_allclose(np.diff(log["object_theta"][seen]), np.diff(expected[seen, 2]), atol=1e-6)
    np.savetxt(tmp_path / "one.txt", rows[:50], delimiter=",", fmt="%.12g")
    (one,) = datasets.import_two_finger(tmp_path / "one.txt", SCENE, tmp_path / "one")
    assert len(stickslip.load_log(one / "log.csv")["time"]) == 49
    pushes = datasets.import_two_finger(tmp_path / "log.txt", SCENE, tmp_path / "push", single_pushes=True)
    assert [len(stickslip.load_log(push / "log.csv")["time"]) for push in pushes] == [49, 50]


@pytest.fixture
def published(tmp_path):
    """A repository with a run of each rectangle and triangle of the published set, and its commit."""
    repository = tmp_path / "repository"
    motion = _motion(np.arange(0, 2, 0.04)) * [1e3, 1e3, 1.0]
    rows = np.column_stack([np.arange(0, 2, 0.04), motion, motion, np.ones(50)])
    for folder, runs in _zhou._RUNS.items():
        (repository / "logs" / folder).mkdir(parents=True)
        for time in runs:
            np.savetxt(repository / "logs" / folder / f"log2017-{time}.txt", rows, delimiter=",", fmt="%.12g")
    (repository / "other").mkdir()
    (repository / "other/large.bin").write_bytes(bytes(1000))
    identity = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    settings = [["uploadpack.allowAnySHA1InWant", "true"], ["uploadpack.allowFilter", "true"]]
    steps = [["init", "--quiet"], *[["config", *setting] for setting in settings], ["add", "."]]
    for step in [*steps, [*identity, "commit", "--quiet", "--message", "runs"]]:
        subprocess.run(["git", "-C", repository, *step], check=True)
    head = subprocess.run(["git", "-C", repository, "rev-parse", "HEAD"], check=True, capture_output=True, text=True)
    return datasets.Origin(repository.as_uri(), head.stdout.strip(), "logs", "CC0-1.0")


def test_published_runs_are_downloaded_and_converted(published, tmp_path):
    logs = datasets.fetch(published, tmp_path / "fetched")
    assert logs == tmp_path / "fetched/logs" and not (logs.parent / "other").exists()
    scene = datasets.two_finger_scene([[0, 0], [0.1, 0], [0, 0.1]], position_std=1e-3, orientation_std=0.01)
    assert len(datasets.import_two_finger_set(logs, tmp_path / "plates")) == 22
    pushes = datasets.import_two_finger_set(logs, tmp_path / "all", butter=scene)
    assert len(pushes) == 30 and "latency = 0.16" in (pushes[-1] / "scene.toml").read_text()
    (expected,) = datasets.import_two_finger(
        logs / "tri/tri_0_0_90/log2017-05-23_20-25-09.txt", scene, tmp_path / "one", single_pushes=True
    )
    found = tmp_path / "all/tri_0_0_90_1-1"
    assert (found / "log.csv").read_bytes() == (expected / "log.csv").read_bytes()
    with pytest.raises(stickslip.Error, match=r"bigrect_3pts_20_neg30_90.* is missing"):
        datasets.import_two_finger_set(tmp_path, tmp_path / "none")


def test_data_that_are_not_the_published_ones_are_refused(published, tmp_path):
    other = dataclasses.replace(published, commit="0" * 40)
    for origin, words in [
        ("three-finger", "no data `three-finger`; there are two-finger, mlab"),
        (other, "git fetch failed"),
        (dataclasses.replace(published, folder="nothing"), "no folder `nothing`"),
    ]:
        with pytest.raises(stickslip.Error, match=words):
            datasets.fetch(origin, tmp_path / "out")
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
    datasets.fetch(published, tmp_path / "out")
    with pytest.raises(stickslip.Error, match="is not empty"):
        datasets.fetch(published, tmp_path / "out")


def test_alternating_lines_are_read(tmp_path):
    file = tmp_path / "force1.txt"
    file.write_text("1.5\n0.1 0.2 0.3\n1.6\n0.4 0.5 0.6\n")
    stream = datasets.read_alternating(file)
    np.testing.assert_array_equal(stream.time, [1.5, 1.6])
    np.testing.assert_array_equal(stream.value, [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
    file.write_text("1.5\n0.1 0.2 0.3\n1.6\n")
    with pytest.raises(stickslip.Error, match="a time and numbers in turn"):
        datasets.read_alternating(file)


def test_tables_of_any_names_and_units_are_the_motion(tmp_path):
    time = np.arange(0, 2, 0.03)
    pose = _motion(time)
    lines = ["ms;x_mm;y_mm;deg;px;py"]
    for t, (x, y, theta) in zip(time, pose, strict=True):
        lines.append(f"{1e3 * t + 70};{1e3 * x};{1e3 * y};{np.rad2deg(theta) % 360};{x};{y}")
    lines[5] = ";".join([*lines[5].split(";")[:1], "", *lines[5].split(";")[2:]])
    (tmp_path / "t.csv").write_text("\n".join(lines))
    columns = {
        "time": ("ms", 1e-3),
        "object_x": ("x_mm", 1e-3),
        "object_y": ("y_mm", 1e-3),
        "object_theta": ("deg", np.pi / 180),
        "pusher_x": "px",
        "pusher_y": "py",
    }
    folder = datasets.import_csv(tmp_path / "t.csv", SCENE, tmp_path / "out", columns, delimiter=";")
    log = stickslip.load_log(folder / "log.csv")
    seen = ~np.isnan(log["object_x"])
    assert np.flatnonzero(~seen).tolist() == [4] and np.isnan(log["object_theta"][4])
    np.testing.assert_allclose(log["time"], time, atol=1e-9)
    np.testing.assert_allclose(log["object_theta"][seen] - log["object_theta"][0], (pose[:, 2] - pose[0, 2])[seen])
    assert (log["pusher_theta"] == 0).all()
    with pytest.raises(stickslip.Error, match="there is no column `z`; there are ms, x_mm"):
        datasets.import_csv(tmp_path / "t.csv", SCENE, tmp_path / "o", columns | {"time": "z"}, delimiter=";")
    with pytest.raises(stickslip.Error, match="is not empty"):
        datasets.import_csv(tmp_path / "t.csv", SCENE, tmp_path / "out", columns, delimiter=";")


def test_files_that_are_no_pushes_are_refused(tmp_path):
    file = tmp_path / "push.json"
    for text, words in [
        ("{", "no JSON"),
        ("[]", "is a list"),
        ('{"object_pose": [[0, 0, 0, 0]]}', "there is no `tip_pose`"),
        ('{"object_pose": [[0, 0]], "tip_pose": [[0, 0]]}', "rows of 2 numbers; they must have 4 or 8"),
        ('{"object_pose": [[0, 0, 0, NaN]], "tip_pose": []}', "row 0, number 3 is nan"),
        ('{"object_pose": [[0, 0, 0, 0]], "tip_pose": [[9, 0, 0, 0]]}', "they must overlap"),
    ]:
        file.write_text(text)
        with pytest.raises(stickslip.Error, match=words):
            datasets.import_mit(file, SCENE, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_plates_have_the_moments_of_their_shape():
    # a right triangle with legs a and b: J = m (a^2 + b^2) / 18; a rectangle: m (a^2 + b^2) / 12
    corners, centre, inertia = datasets.uniform_plate([[0, 0], [0.3, 0], [0, 0.15]], 2.0)
    np.testing.assert_allclose(centre, [0.1, 0.05])
    np.testing.assert_allclose(corners[0], [-0.1, -0.05])
    assert inertia == pytest.approx(2.0 * (0.3**2 + 0.15**2) / 18)
    square = np.array([[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]) + 5.0
    assert datasets.uniform_plate(square, 3.0)[2] == pytest.approx(3.0 * (0.2**2 + 0.1**2) / 12)
    with pytest.raises(stickslip.Error, match="counter-clockwise"):
        datasets.uniform_plate(square[::-1], 3.0)


def test_the_occlusion_benchmark_has_the_scores_of_the_program(program, data, tmp_path):
    folders = sorted((data / "real/zhou-two-finger-pushes").glob("bigrect*"))[:2]
    rows = datasets.occlusion_benchmark(folders, seconds=1.0, particles=100)
    variants = {"nominal", "kalman", "extended_kalman", "particle", "particle_always_on"}
    assert {row["variant"] for row in rows} == variants
    command = [program, "filter", folders[0] / "log.csv", "--scene", folders[0] / "scene.toml", "--particles", "100"]
    done = subprocess.run([*command, "--occlude-middle", "1", "--json"], check=True, capture_output=True, text=True)
    expected = json.loads(done.stdout)
    (found,) = [row for row in rows if row["folder"] == str(folders[0]) and row["variant"] == "particle"]
    assert found["wmse_occluded_mm"] == expected["wmse_occluded_mm"]
    assert found["wmse_mm"] == expected["wmse_mm"]
