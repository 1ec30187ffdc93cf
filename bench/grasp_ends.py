"""How a jaw's grasp ends, as predicted before the end, against what happens.

    python3 bench/grasp_ends.py make FIRST LAST OUT
    python3 bench/grasp_ends.py score FOLDER [FOLDER ...]

`make` simulates closings of a jaw on the testbed: the scenes of `mujoco_grasps.py --jaw` (needs mujoco and numpy), by
`stickslip.simulate`. `score` takes them and those of `mujoco_grasps.py --jaw` itself. The camera is off from just
before the first touch on. A tracker gets the rows up to 2 s and up to 0.5 s before the end, and predicts the end of a
plan that closes on at the same speed (`Tracker.outcomes`). The end is where the fingers stop, stalled or because they
would meet. Held means that both press and the object rests, 0.3 s later.

Compared are the particles' probability, the yes or no of one simulation with the scene's values from the estimated pose
(nominal), and the share of held grasps in the set (base rate). Brier score: mean square of probability minus outcome.
Calibration error: mean distance of probability and share over ten bins of equal width, weighted by their counts.
"""

import argparse
import json
import math
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import stickslip

BEFORE = (2.0, 0.5)  # s
AFTER = 0.3  # s
TOUCH = 0.05  # N
STILL = (1e-3, 0.03)  # m/s, rad/s


def make(first, last, out):
    """Writes an experiment of the testbed for each seed whose object is touched."""
    from mujoco_grasps import JAW_SECONDS, draw_jaw, scene_text

    for seed in range(first, last):
        grasp = draw_jaw(np.random.default_rng(seed), seed)
        (x, y, _), (other_x, other_y, _) = grasp.fingers
        finger = f"start = [{other_x:.6f}, {other_y:.6f}, 0.0]\n"
        knots = [[0, 0], [0.5, 0], [0.5, grasp.speed], [0.5 + grasp.travel / grasp.speed, grasp.speed]]
        knots = [*knots, [knots[-1][0], 0.0]]
        text = scene_text(grasp, False).replace("\n[[finger]]\n", "\n[[finger]]\n" + finger)
        text += f"""
[start]
object = [0.0, {grasp.y:.6f}, {grasp.angle:.6f}]
pusher = [{x:.6f}, {y:.6f}, 0.0]
speed = {knots}
duration = {JAW_SECONDS}
"""
        folder = out / f"testbed-{grasp.shape}-{grasp.pusher}-{seed}"
        folder.mkdir(parents=True)
        (folder / "scene.toml").write_text(text)
        truth = {"mu_s": grasp.mu_s, "mu_p": grasp.mu_p}
        result = stickslip.simulate(stickslip.load_scene(folder / "scene.toml"), seed=seed, friction=truth)
        (folder / "scene.toml").unlink()
        result.write(folder)


def fingers_of(columns):
    """Poses of the pusher and of the finger, (n, 6)."""
    names = [f"{body}_{axis}" for body in ("pusher", "finger_1") for axis in ("x", "y", "theta")]
    return np.column_stack([columns[name] for name in names])


def end_of(fingers, time, touched):
    """Row of the end, and the fingers' velocity while they close (6,)."""
    closing = slice(touched - 15, touched)
    velocity = (fingers[touched] - fingers[touched - 15]) / (time[touched] - time[closing.start])
    moved = np.hypot(*(fingers[5:, :2] - fingers[:-5, :2]).T) / (time[5:] - time[:-5])
    moving = np.flatnonzero(moved > 0.3 * np.hypot(*velocity[:2]))
    return int(moving[-1]) + 5, velocity


def predictions(folder):
    """Yields (s before the end, probability, nominal's answer, held or not) for an experiment."""
    scene, log = stickslip.load_scene(folder / "scene.toml"), stickslip.load_log(folder / "log.csv")
    truth = np.genfromtxt(folder / "truth.csv", delimiter=",", names=True)
    touched = json.loads((folder / "truth.json").read_text())["occlude_from"]
    time, fingers = log["time"], fingers_of(log)
    if touched is None or touched < 15:
        return
    end, velocity = end_of(fingers, time, touched)
    after = np.searchsorted(time, time[end] + AFTER)
    if after >= len(time):
        return
    row = truth[after]
    press = min(row["force_pusher"], row["force_1"]) > TOUCH
    held = press and math.hypot(row["vx"], row["vy"]) < STILL[0] and abs(row["omega"]) < STILL[1]
    tracker, rows, done = stickslip.Tracker(scene), list(stickslip.rows(log)), 0
    for before in BEFORE:
        now = int(np.searchsorted(time, time[end] - before))
        if now <= touched - 15:
            continue
        for k in range(done, now + 1):
            tracker.push(**(rows[k] if k < touched else {**rows[k], "object": None}))
        done = now + 1
        times = np.arange(0.0, before + AFTER, 1 / 30)
        plan = fingers[now] + times[:, None] * velocity
        ends, here = tracker.outcomes(plan), tracker.estimate
        single = stickslip.rollout(scene, [[here["x"], here["y"], here["theta"]]], plan)
        speed, yields = single["twist"][0, -1], np.hypot(*single["pusher_lag"][0]) > 1e-5
        nominal = yields and np.hypot(*speed[:2]) < STILL[0] and abs(speed[2]) < STILL[1]
        yield before, ends["held"], float(nominal), float(held)


def calibration_error(chance, held):
    """Mean distance of probability and share over ten bins."""
    bins = np.minimum((10 * chance).astype(int), 9)
    groups = [bins == k for k in range(10) if (bins == k).any()]
    return sum(group.mean() * abs(chance[group].mean() - held[group].mean()) for group in groups), groups


def score(folders):
    """Prints a table for each time before the end."""
    experiments = sorted(scene.parent for folder in folders for scene in folder.rglob("scene.toml"))
    with ThreadPoolExecutor() as pool:
        found = [answer for answers in pool.map(lambda one: list(predictions(one)), experiments) for answer in answers]
    for before in BEFORE:
        rows = np.array([answer for answer in found if answer[0] == before])
        if not len(rows):
            sys.exit(f"no grasp is {before} s from its end after the first touch")
        chance, nominal, held = rows.T[1:]
        error, groups = calibration_error(chance, held)
        brier = [np.mean((guess - held) ** 2) for guess in (chance, nominal, np.full(len(held), held.mean()))]
        print(f"{before} s before the end: {len(held)} grasps, {100 * held.mean():.0f} % held")
        print("  Brier score: particles {:.3f}, nominal {:.3f}, base rate {:.3f}".format(*brier))
        print(f"  calibration error of the particles: {error:.3f}")
        for group in groups:
            print(f"    predicted {chance[group].mean():.2f}, held {held[group].mean():.2f}, {group.sum()} grasps")


def main():
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    maker = commands.add_parser("make")
    maker.add_argument("first", type=int)
    maker.add_argument("last", type=int)
    maker.add_argument("out", type=Path)
    commands.add_parser("score").add_argument("folders", type=Path, nargs="+")
    given = parser.parse_args()
    if given.command == "make":
        make(given.first, given.last, given.out)
    else:
        score(given.folders)


if __name__ == "__main__":
    main()
