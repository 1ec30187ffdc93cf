"""Studies give the same numbers on every backend, go on where they stopped, and lose no more than a task."""

import json
import os
import sys

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
