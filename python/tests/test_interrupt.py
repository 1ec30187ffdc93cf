"""Long calls hear Ctrl-C and show their progress."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import stickslip

BEGIN = """
import signal, sys, numpy as np, stickslip
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
folder = sys.argv[1]
scene = stickslip.load_scene(folder + "/scene.toml")
progress = lambda done, total: print("begun", flush=True)
push = np.linspace([-0.06, 0, 0], [0.02, 0, 0], 3001)
START = {"object": [0, 0, 0], "pusher": [-0.06, 0, 0], "speed": 1e-5, "duration": 3000.0}
try:
    CALL
except KeyboardInterrupt:
    print("heard")
"""

#: Calls that take minutes.
CALLS = {
    "filter": "stickslip.filter(folder + '/log.csv', scene, particles=300_000, progress=progress)",
    "particles": "stickslip.particles(folder + '/log.csv', scene, rows=[3], particles=300_000, progress=progress)",
    "compare": "stickslip.compare([folder], variants=['nominal', 'particle'], particles=300_000, progress=progress)",
    "rollout": "stickslip.rollout(scene, np.zeros((6400, 3)), push, progress=progress)",
    "simulate": "stickslip.simulate(scene.replace(start=START), progress=progress)",
    "fit": "stickslip.fit(20 * [(scene, folder + '/log.csv')], ['mu_p', 'outline_scale'], progress=progress)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("call", CALLS)
def test_interrupted_call_ends_as_a_keyboard_interrupt(demo, call):
    script = BEGIN.replace("CALL", CALLS[call])
    process = subprocess.Popen([sys.executable, "-c", script, demo], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    try:
        printed, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert printed.splitlines()[-1] == "heard" and process.returncode == 0


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("call", ["load_log", "info"])
def test_interrupted_reader_of_a_file_that_does_not_come_ends(tmp_path, call):
    os.mkfifo(tmp_path / "push.mcap")
    script = f"""import signal, sys, stickslip
signal.signal(signal.SIGINT, signal.default_int_handler)
print('begun', flush=True)
stickslip.{call}(sys.argv[1])"""
    command = [sys.executable, "-c", script, tmp_path / "push.mcap"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    try:
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert said.rstrip().endswith("KeyboardInterrupt")


@pytest.fixture
def shown():
    """A callback that keeps its arguments, and them."""
    kept = []

    def progress(done, total):
        kept.append((done, total))

    progress.kept = kept
    return progress


def _check(shown, total):
    assert shown.kept[-1] == (total, total)
    assert shown.kept == sorted(shown.kept)


def test_progress_ends_with_the_total(demo, scene, shown):
    rows = len(stickslip.load_log(demo / "log.csv")["time"])
    stickslip.filter(demo / "log.csv", scene, particles=2000, progress=shown)
    _check(shown, rows)
    shown.kept.clear()
    stickslip.rollout(scene, np.zeros((70, 3)), np.linspace([-0.1, 0, 0], [-0.05, 0, 0], 9), progress=shown)
    _check(shown, 70)
    shown.kept.clear()
    stickslip.compare([demo], variants=["nominal", "kalman"], progress=shown)
    assert shown.kept == [(1, 2), (2, 2)]


def test_progress_of_a_fit_rises_over_all_folds(demo, scene, shown):
    log = stickslip.load_log(demo / "log.csv")
    short = {name: column[:200] for name, column in log.items()}
    stickslip.fit(4 * [(scene, short)], ["mu_p"], progress=shown)
    assert shown.kept == sorted(shown.kept) and len({total for _, total in shown.kept}) == 1
    assert shown.kept[-1][0] == shown.kept[-1][1] > 0


def test_exception_of_a_callback_ends_the_call(demo, scene):
    def fails(done, total):
        raise ZeroDivisionError(f"{done} of {total}")

    with pytest.raises(ZeroDivisionError, match="of 6"):
        stickslip.filter(demo / "log.csv", scene, particles=300_000, progress=fails)
    # the threads are free for the next call
    stickslip.filter(demo / "log.csv", scene, particles=16)
