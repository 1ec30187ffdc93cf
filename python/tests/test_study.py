"""Studies give the same numbers on every backend, go on where they stopped, and lose no more than a task."""

import json
import os
import shutil
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest
import study_functions

import stickslip
from stickslip import study


def _by_task(rows):
    return [{name: row.get(name) for name in ("x", "square")} for row in rows]


def test_threads_and_processes_give_the_numbers_of_compare(demo, tmp_path):
    tasks = study.grid([demo], {"particles": [50], "occlude": [200]}, seeds=3)
    threads = study.run(tasks, tmp_path / "threads", backend="threading", workers=2, progress=False)
    processes = study.run(tasks, tmp_path / "processes", backend="loky", workers=2, progress=False)
    assert threads == processes
    expected = stickslip.compare([demo], seeds=3, variants=["particle"], particles=50, occlude=200)
    assert [row["wmse_occluded_mm"] for row in threads] == [row["wmse_occluded_mm"] for row in expected]
    assert len({row["wmse_occluded_mm"] for row in threads}) == 3


def test_a_study_goes_on_where_it_stopped(tmp_path, capfd):
    tasks = [{"x": x} for x in range(20)]
    study.run(tasks[:5], tmp_path, function=study_functions.square, backend="threading", progress=False)
    (kept,) = [file for file in tmp_path.glob("*.json") if json.loads(file.read_text()) == {"square": 9}]
    kept.write_text('{"square": 10}')  # a result that only a file can have
    rows = study.run(tasks, tmp_path, function=study_functions.square, backend="threading")
    assert [row.get("square") for row in rows] == [{3: 10, 13: None}.get(x, x * x) for x in range(20)]
    assert rows[13]["error"] == "ValueError: 13 is unlucky" and "raise ValueError" in rows[13]["traceback"]
    assert "5 of 20 tasks are done" in capfd.readouterr().err
    study.to_parquet(rows, tmp_path / "rows.parquet")
    table = pq.read_table(tmp_path / "rows.parquet").to_pylist()
    assert table[4]["square"] == 16 and table[13]["square"] is None and "unlucky" in table[13]["error"]


def test_a_dead_worker_costs_no_result(tmp_path):
    (tmp_path / "marks").mkdir()
    tasks = [{"x": x, "folder": str(tmp_path / "marks")} for x in range(8)]
    rows = study.run(tasks, tmp_path / "s", function=study_functions.die_once, workers=2, progress=False)
    assert [row["square"] for row in rows] == [x * x for x in range(8)]


def test_a_task_that_kills_its_workers_costs_itself_only(tmp_path):
    tasks = [{"x": x} for x in range(40)]
    rows = study.run(tasks, tmp_path, function=study_functions.die, workers=2, progress=False)
    assert rows[3] == {"x": 3, "error": "its worker died 3 times"}
    assert [row["square"] for row in rows if row["x"] != 3] == [x * x for x in range(40) if x != 3]


def test_a_backend_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(stickslip.Error, match="the backend `nowhere` ran no task"):
        study.run([{"x": 1}], tmp_path, function=study_functions.square, backend="nowhere", progress=False)


def test_a_task_twice_is_refused(tmp_path):
    with pytest.raises(stickslip.Error, match="is there twice"):
        study.run([{"x": 1}, {"x": 1}], tmp_path, function=study_functions.square)


def test_ray_gives_the_same_numbers_and_survives_a_killed_worker(demo, tmp_path):
    ray = pytest.importorskip("ray")
    (tmp_path / "marks").mkdir()
    tasks = study.grid([demo], {"particles": [50], "occlude": [200]}, seeds=3)
    here = study.run(tasks, tmp_path / "threads", backend="threading", workers=2, progress=False)
    path = {"env_vars": {"PYTHONPATH": os.pathsep.join(sys.path)}}
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env=path)
    try:
        assert study.run(tasks, tmp_path / "ray", backend="ray", workers=2, progress=False) == here
        tasks = [{"x": x, "folder": str(tmp_path / "marks")} for x in range(8)]
        rows = study.run(tasks, tmp_path / "dies", function=study_functions.die_once, backend="ray", workers=2)
        assert _by_task(rows) == [{"x": x, "square": x * x} for x in range(8)]
    finally:
        ray.shutdown()


def _experiment(demo, folder):
    shutil.copytree(demo, folder)
    return folder


def test_a_changed_scene_log_or_version_runs_again(demo, tmp_path, monkeypatch):
    folder = _experiment(demo, tmp_path / "exp")
    tasks = study.grid([folder], {"particles": [16], "occlude": [200]})

    def run():
        return study.run(tasks, tmp_path / "s", backend="threading", progress=False)[0]["wmse_mm"]

    first = run()
    kept = next((tmp_path / "s").glob("*.json"))
    kept.write_text('{"wmse_mm": -1}')  # a result that only a file can have
    assert run() == -1
    scene = folder / "scene.toml"
    original = scene.read_text()
    scene.write_text(stickslip.Scene(original).replace(mu_p=0.9).text)
    changed = run()
    assert changed not in (-1, first)
    scene.write_text(original)
    assert run() == -1
    with (folder / "log.csv").open("a") as log:
        log.write("\n")
    assert run() == first
    (folder / "log.csv").write_bytes((demo / "log.csv").read_bytes())
    monkeypatch.setattr("stickslip._study_key.__version__", "another")
    assert run() == first


def test_a_study_varies_keys_of_the_scene(demo, tmp_path):
    tasks = study.grid([demo], {"variant": ["nominal"]}, scene={"pusher.friction": [0.1, 0.9]})
    assert [task["scene"] for task in tasks] == [{"pusher.friction": 0.1}, {"pusher.friction": 0.9}]
    rows = study.run(tasks, tmp_path, backend="threading", progress=False)
    expected = stickslip.compare([demo], variants=["nominal"], scene={"mu_p": 0.9})
    assert rows[1]["wmse_mm"] == expected[0]["wmse_mm"] != rows[0]["wmse_mm"]
    found = study.medians(rows, "wmse_mm", by=["scene.pusher.friction"])
    assert [row["median"] for row in found] == [row["wmse_mm"] for row in rows]
    study.to_parquet(rows, tmp_path / "rows.parquet")
    table = pq.read_table(tmp_path / "rows.parquet").to_pylist()
    assert table[1]["scene.pusher.friction"] == 0.9 and table[1]["warnings"] == []


def test_workers_do_not_touch_the_study_folder(tmp_path):
    tasks = [{"x": x, "folder": str(tmp_path / "s")} for x in range(6)]
    rows = study.run(tasks, tmp_path / "s", function=study_functions.writers, workers=2, progress=False)
    assert {row["files"] for row in rows} <= set(range(7)) and os.getpid() not in {row["pid"] for row in rows}
    assert sorted(path.suffix for path in (tmp_path / "s").iterdir()) == [".json"] * 6


def test_progress_of_a_study_is_seen_from_outside(tmp_path, capfd):
    tasks, shown = [{"x": x} for x in range(12, 15)], []
    options = {"function": study_functions.square}
    assert study.status(tasks, tmp_path, **options) == {"done": 0, "failed": 0, "missing": 3}
    study.run(tasks[:1], tmp_path, backend="threading", progress=False, **options)
    assert study.status(tasks, tmp_path, **options) == {"done": 1, "failed": 0, "missing": 2}
    study.run(tasks, tmp_path, backend="threading", progress=lambda *seen: shown.append(seen), **options)
    assert shown == [(2, 3), (3, 3)]
    assert study.watch(tasks, tmp_path, **options) == {"done": 2, "failed": 1, "missing": 0}
    assert "study: 2 of 3 tasks are done, 1 failed" in capfd.readouterr().err


def test_failures_of_the_driver_are_not_those_of_workers(tmp_path):
    def fails(done, total):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        study.run([{"x": 1}], tmp_path, function=study_functions.square, backend="threading", progress=fails)
    rows = study.run([{"x": 1}], tmp_path / "no", function=study_functions.no_json, workers=2, progress=False)
    assert "not JSON serializable" in rows[0]["error"]


def test_bootstrap_errors_are_those_of_normal_numbers():
    rng = np.random.default_rng(0)
    rows = [
        {"folder": str(k), "seed": 0, "method": method, "score": float(score)}
        for k in range(400)
        for method, score in (("a", rng.normal(1.0)), ("b", rng.normal(0.0)))
    ]
    rows += [{"folder": "lost", "seed": 0, "method": "a", "error": "?"}]
    a, b = study.medians(rows, "score", by=["method"])
    assert (a["method"], a["rows"], a["units"], a["left_out"], b["left_out"]) == ("a", 400, 400, 1, 0)
    assert abs(a["median"] - 1) < 4 * a["error"]
    # the median of n normal numbers has the standard error sqrt(pi / 2 n)
    assert a["error"] == pytest.approx(np.sqrt(np.pi / 800), rel=0.25)
    difference = study.paired(rows, "method", "a", "b", "score")
    assert (difference["rows"], difference["left_out"]) == (400, 1)
    assert abs(difference["median"] - 1) < 4 * difference["error"]
    assert difference["error"] == pytest.approx(np.sqrt(np.pi / 400), rel=0.3)


def test_bootstrap_of_dependent_rows_counts_experiments():
    rng = np.random.default_rng(1)
    offsets = rng.normal(size=30)
    rows = [
        {"folder": str(k), "seed": seed, "score": float(offset)}
        for k, offset in enumerate(offsets)
        for seed in range(50)
    ]
    (found,) = study.medians(rows, "score", by=[])
    (once,) = study.medians(rows[::50], "score", by=[])
    assert found["units"] == once["units"] == 30 and found["error"] == pytest.approx(once["error"], rel=0.2)
    (alone,) = study.medians(rows[:50], "score", by=[])
    assert alone["units"] == 1 and alone["error"] == 0
    with pytest.raises(stickslip.Error, match="have the same folder"):
        study.paired(rows, "folder", "0", "1", "score", on=["folder"])
