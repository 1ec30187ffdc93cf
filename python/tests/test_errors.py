"""Input that cannot be used raises ``stickslip.Error`` and nothing else."""

import threading

import numpy as np
import pytest

import stickslip
from stickslip import datasets, plan, study

PUSH = np.linspace([-0.06, 0, 0], [0.0, 0, 0], 31)


def _rollout(scene, **changes):
    first = stickslip.rollout(scene, np.zeros((5, 3)), PUSH)
    return stickslip.rollout(scene, np.zeros((5, 3)), PUSH, out={**first, **{k: v(first) for k, v in changes.items()}})


#: What is called with a scene and a log, and words of its refusal.
CASES = {
    "out float32": (lambda s, _: _rollout(s, pose=lambda f: f["pose"].astype("f4")), "`pose` is float32 of the shape"),
    "out no array": (lambda s, _: _rollout(s, twist=lambda f: None), "`twist` is NoneType"),
    "out read-only": (lambda s, _: _rollout(s, pose=lambda f: np.broadcast_to(0.0, (5, 31, 3))), "must be writable"),
    "out twice": (lambda s, _: _rollout(s, twist=lambda f: f["pose"]), "memory in common"),
    "h text": (lambda s, _: stickslip.rollout(s, np.zeros((5, 3)), PUSH, h="x"), "h is 'x'"),
    "h huge": (lambda s, _: stickslip.rollout(s, np.zeros((5, 3)), PUSH, h=1e300), "the step is"),
    "threads negative": (lambda s, _: stickslip.rollout(s, np.zeros((5, 3)), PUSH, threads=-1), "threads is -1"),
    "scene none": (lambda s, _: stickslip.rollout(None, np.zeros((5, 3)), PUSH), "the scene is None; give a path"),
    "scene bytes": (lambda s, _: stickslip.Scene(b"gravity = 1"), "the scene is bytes"),
    "log number": (lambda s, _: stickslip.load_log(5), "the log is 5; give a path"),
    "topics text": (lambda s, log: stickslip.load_log("x", topics="object=/a"), "topics is 'object=/a'"),
    "occlude (None, None)": (lambda s, log: stickslip.filter(log, s, occlude=(None, None)), "occlude is (None, None)"),
    "occlude text pair": (lambda s, log: stickslip.filter(log, s, occlude=(1, "2")), "occlude is (1, '2')"),
    "unknown option": (lambda s, log: stickslip.filter(log, s, partices=3), "there is no option `partices`"),
    "old option": (lambda s, log: stickslip.filter(log, s, mode="contact"), "is called `model`"),
    "row -1": (lambda s, log: stickslip.particles(log, s, rows=[-1]), "rows has -1; the log's rows go from 0 to"),
    "row 10**12": (lambda s, log: stickslip.particles(log, s, rows=[10**12]), "rows has 1000000000000"),
    "row text": (lambda s, log: stickslip.particles(log, s, rows="a"), "rows is 'a'"),
    "fit numbers": (lambda s, log: stickslip.fit([1, 2], "mu_p"), "a push is 1; give a folder"),
    "fit seed": (lambda s, log: stickslip.fit([(s, log)] * 2, ["mu_p"], seed=-1), "seed is -1"),
    "score contact": (
        lambda s, log: stickslip.score({"time": [0.0]}, log, s, first_pusher_contact=-3),
        "first_pusher_contact is -3",
    ),
    "simulate rate": (lambda s, _: stickslip.simulate(s, rate="fast"), "rate is 'fast'"),
    "compare number": (lambda s, _: stickslip.compare([3]), "a folder is 3"),
    "tracker tactile": (lambda s, _: stickslip.Tracker(s).push(0.0, tactile=5), "tactile is 5"),
    "tracker time": (lambda s, _: stickslip.Tracker(s).push("x"), "time is 'x'"),
    "tracker object": (lambda s, _: stickslip.Tracker(s).push(0.0, object="abc"), "object holds something that is no"),
    "plan pushes": (lambda s, _: plan.predict(s, (0, 0, 0), "x"), "pushes holds something that is no number"),
    "task": (lambda s, _: study.status([{"x": object()}], "nowhere"), "a task has <object"),
    "plate": (lambda s, _: datasets.uniform_plate("x", 1.0), "polygon holds something that is no number"),
}


@pytest.mark.parametrize("case", CASES)
def test_wrong_input_raises_the_error_of_the_package(demo, scene, case):
    call, words = CASES[case]
    with pytest.raises(stickslip.Error) as refusal:
        call(scene, stickslip.load_log(demo / "log.csv"))
    assert words in str(refusal.value)


def test_unaligned_columns_are_read(demo, scene):
    log = stickslip.load_log(demo / "log.csv")
    unaligned = np.frombuffer(b"\0" + log["time"].tobytes(), "u1")[1:].view("f8")
    assert not unaligned.flags.aligned
    found = stickslip.filter({**log, "time": unaligned}, scene, particles=8)
    np.testing.assert_array_equal(found["x"], stickslip.filter(log, scene, particles=8)["x"])


def test_tracker_on_four_threads_takes_rows_in_turn(scene):
    tracker, failures = stickslip.Tracker(scene, particles=64, late=2.0), []

    def work(thread):
        for k in range(100):
            try:
                tracker.push(0.01 * k + 0.001 * thread, object=(0, 0, 0), pusher=(-0.1, 0, 0))
            except Exception as error:
                failures.append(error)

    threads = [threading.Thread(target=work, args=(thread,)) for thread in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert failures == [] and tracker.estimate["time"] == 0.01 * 99 + 0.001 * 3
