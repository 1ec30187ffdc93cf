"""Doubts are those of the program: findings of ``check``, warnings and facts of runs."""

import json
import pickle
import subprocess
import warnings

import numpy as np
import pandas as pd
import pytest

import stickslip


def _in_millimetres(demo):
    """The demo's log with lengths in mm."""
    log = stickslip.load_log(demo / "log.csv")
    return {name: 1e3 * column if name[-2:] in ("_x", "_y") else column for name, column in log.items()}


def test_check_has_the_findings_of_the_program(program, demo, scene):
    done = subprocess.run([program, "check", demo, "--json"], check=True, capture_output=True, text=True)
    found = stickslip.check(demo / "log.csv", scene)
    assert [vars(finding) for finding in found] == json.loads(done.stdout)["findings"]
    assert stickslip.check(demo, demo / "scene.toml") == found


def test_check_log_in_millimetres_is_a_problem_with_advice(demo, scene):
    problems = [finding for finding in stickslip.check(_in_millimetres(demo), scene) if finding.severity == "problem"]
    assert [finding.subject for finding in problems] == ["units"] and "millimetres" in problems[0].found
    assert problems[0].advice and str(problems[0]).startswith("problem: units: ")


def test_filter_and_compare_refuse_a_log_in_millimetres_as_the_program_does(program, demo, scene, tmp_path):
    (tmp_path / "scene.toml").write_text(scene.text)
    pd.DataFrame(_in_millimetres(demo)).to_csv(tmp_path / "log.csv", index=False)
    done = subprocess.run([program, "filter", tmp_path], capture_output=True, text=True)
    (found,) = [line.removeprefix("error: ") for line in done.stderr.splitlines() if line.startswith("error: ")]
    calls = (
        lambda: stickslip.filter(tmp_path, scene, particles=16),
        lambda: stickslip.particles(tmp_path, scene, particles=16),
        lambda: stickslip.compare([tmp_path], variants=["nominal"]),
    )
    for call in calls:
        with pytest.raises(stickslip.Error, match=r"millimetres.*force=True runs all the same") as refusal:
            call()
        assert found.split(": ", 1)[1] in str(refusal.value)
    assert str(tmp_path) in str(refusal.value)


def test_forced_filter_of_a_log_in_millimetres_warns_as_the_program_does(program, demo, scene, tmp_path):
    pd.DataFrame(_in_millimetres(demo)).to_csv(tmp_path / "log.csv", index=False)
    with pytest.warns(stickslip.Warning, match="millimetres") as issued:
        estimate = stickslip.filter(tmp_path / "log.csv", scene, particles=16, force=True)
    assert [str(warning.message) for warning in issued] == list(estimate.warnings)
    assert {warning.filename for warning in issued} == {__file__}
    assert issubclass(stickslip.Warning, UserWarning)
    command = [program, "filter", tmp_path / "log.csv", "--scene", demo / "scene.toml", "--particles", "16"]
    done = subprocess.run([*command, "--force", "--json"], check=True, capture_output=True, text=True)
    assert json.loads(done.stdout)["warnings"] == list(estimate.warnings)


def test_facts_of_a_run_are_those_of_the_program(program, demo, scene):
    options = ["--occlude", "250", "--particles", "100", "--causal", "--json"]
    done = subprocess.run([program, "filter", demo, *options], check=True, capture_output=True, text=True)
    theirs = json.loads(done.stdout)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        estimate = stickslip.filter(demo / "log.csv", scene, occlude=250, particles=100, causal=True)
    assert estimate.warnings == () and estimate.collapses == theirs["collapses"]
    assert estimate.observed == {name: learned["observed"] for name, learned in theirs["friction"].items()}
    assert any(estimate.observed.values())
    assert estimate.log_evidence == theirs["log_evidence"]
    copy = pickle.loads(pickle.dumps(estimate))
    assert vars(copy) == vars(estimate) and list(pd.DataFrame(copy)) == list(estimate)
    nominal = stickslip.filter(demo / "log.csv", scene, method="nominal")
    assert (nominal.observed, nominal.log_evidence) == ({}, None)


def test_filter_occlusion_that_hides_nothing_or_all_is_refused(demo, scene):
    for occlude, words in [(100_000, "hides no object pose"), (0, "hides all")]:
        with pytest.raises(stickslip.Error, match=words):
            stickslip.filter(demo / "log.csv", scene, occlude=occlude)


def test_compare_rows_have_the_facts_of_their_runs(demo):
    rows = stickslip.compare([demo], variants=["kalman", "particle"], particles=50, occlude=200)
    kalman, particle = rows
    assert (kalman["observed"], kalman["log_evidence"]) == ({}, None)
    estimate = stickslip.filter(demo, demo / "scene.toml", particles=50, occlude=200)
    for name in ("observed", "log_evidence", "collapses"):
        assert particle[name] == getattr(estimate, name)
    assert particle["warnings"] == []


def test_tracker_facts_are_those_of_the_causal_filter(demo, scene):
    log = stickslip.load_log(demo / "log.csv")
    log = {name: column[:250] for name, column in log.items()}
    whole = stickslip.filter(log, scene, causal=True, particles=100)
    tracker = stickslip.Tracker(scene, particles=100, late=0.0)
    for row in stickslip.rows(log):
        tracker.push(**row)
    assert tracker.observed == whole.observed and any(whole.observed.values())
    assert tracker.log_evidence == whole.log_evidence
    assert tracker.warnings == ()


def test_tracker_warns_once_of_a_pusher_that_jumps(demo, scene):
    log = stickslip.load_log(demo / "log.csv")
    log["pusher_x"][[20, 40]] += 0.5
    tracker = stickslip.Tracker(scene, particles=16)
    with pytest.warns(stickslip.Warning, match="1 pusher pose that the pusher cannot have reached") as issued:
        for row in list(stickslip.rows(log))[:60]:
            tracker.push(**row)
    assert len(issued) == 1 and issued[0].filename == __file__
    assert len(tracker.warnings) == 1 and tracker.warnings[0].startswith("2 pusher poses")


def test_fit_of_a_push_in_millimetres_names_the_push(demo, scene):
    pushes = [(scene, demo / "log.csv"), (scene, _in_millimetres(demo))]
    with pytest.warns(stickslip.Warning, match="push 1: .*millimetres"):
        fitted = stickslip.fit(pushes, ["mu_p"])
    assert fitted.result["warnings"] == list(fitted.warnings)
    assert np.isfinite(fitted.values["mu_p"])
