"""How a jaw's grasp ends, as predicted before the end, against what happens.

    python3 bench/grasp_ends.py make FIRST LAST OUT [--hard]
    python3 bench/grasp_ends.py score FOLDER [FOLDER ...]
    python3 bench/grasp_ends.py choose FIRST LAST

`make` simulates closings of a jaw on the testbed: the scenes of `mujoco_grasps.py --jaw` (needs mujoco and numpy), by
`stickslip.simulate`. `score` takes them and those of `mujoco_grasps.py --jaw` itself. The camera is off from just
before the first touch on. A tracker gets the rows up to 2 s and up to 0.5 s before the end, and predicts the end of a
plan that closes on at the same speed (`Tracker.outcomes`). The end is where the fingers stop, stalled or because they
would meet. Held means that 0.5 s later both press, the object rests, and the drive is stalled.

Compared are the particles' probability (`held` plus `jammed`), the yes or no of one simulation with the scene's values
from the estimated pose (nominal), and the share of held grasps in the set (base rate). Brier score: mean square of
probability minus outcome. Calibration error: mean distance of probability and share over ten bins of equal width,
weighted by their counts.

With `--hard`, objects are a triangle, a trapezoid or a pentagon, the jaw's line is up to 0.7 radii from the centre, the
nominal friction of the fingers is 0.15, and friction is drawn from the scene's prior.

`choose` grasps the objects of these scenes on the testbed. The camera sees the object for a second before the jaw
comes. Then one closing is carried out: at a fixed angle through the measured centre (fixed); the one of 36 that the
nominal simulation holds with its lines of contact nearest to the centre (nominal); or the one of the same 36 with the
highest probability (`plan.grasp`). It prints the shares of grasps that hold.
"""

import argparse
import json
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from mujoco_grasps import CAMERA_STD, START, draw_jaw, scene_text

import stickslip
from stickslip import plan

BEFORE = (2.0, 0.5)  # s
AFTER = 0.5  # s
STOPS = 1e-3  # m: way of a finger to its last place at the end
TOUCH = 0.05  # N
STILL = (1e-3, 0.03)  # m/s, rad/s


def drawn(seed, hard):
    """Draws a grasp; returns the generator, the grasp, the text of its scene, and the true friction."""
    if hard:
        seed = 7 * seed + (3, 4, 6)[seed % 3]  # shapes with slanted sides
    draw = np.random.default_rng(seed)
    grasp = draw_jaw(draw, seed)
    if not hard:
        return draw, grasp, scene_text(grasp, False), {"mu_s": grasp.mu_s, "mu_p": grasp.mu_p}
    y = draw.uniform(-0.7, 0.7) * grasp.radius
    grasp.fingers = [(x, y, sign) for x, _, sign in grasp.fingers]
    text = scene_text(grasp, False).replace("friction = 0.30", "friction = 0.15")
    truth = plan.prior(stickslip.Scene(text), 1, seed=seed)
    return draw, grasp, text, {name: float(values[0]) for name, values in truth.items()}


def closed(grasp, text, truth, seed, object_pose, pusher, finger, travel):
    """The testbed's simulation in which both fingers close by `travel` (m) from their poses, 0.5 s after the start."""
    speed, closes = float(grasp.speed), float(0.5 + travel / grasp.speed)
    knots = [[0.0, 0.0], [0.5, 0.0], [0.5, speed], [closes, speed], [closes, 0.0]]
    text = text.replace("\n[[finger]]\n", f"\n[[finger]]\nstart = {list(map(float, finger))}\n")
    text = f"""{text}
[start]
object = {list(map(float, object_pose))}
pusher = {list(map(float, pusher))}
direction = {float(pusher[2])}
speed = {knots}
duration = {closes + 1.0}
"""
    return stickslip.simulate(stickslip.Scene(text), seed=seed, friction=truth)


def make(first, last, out, hard):
    """Writes an experiment of the testbed for each seed."""
    for seed in range(first, last):
        _, grasp, text, truth = drawn(seed, hard)
        (x, y, _), (other_x, other_y, _) = grasp.fingers
        place = (START, grasp.y, grasp.angle)
        rig = closed(grasp, text, truth, seed, place, (x, y, 0), (other_x, other_y, 0), grasp.travel)
        rig.write(out / f"{'hard' if hard else 'testbed'}-{grasp.shape}-{grasp.pusher}-{seed}")


def choose(first, last):
    """Prints how many grasps hold by each way to choose."""
    held = {"fixed": [], "nominal": [], "plan.grasp": []}
    for seed in range(first, last):
        draw, grasp, text, truth = drawn(seed, False)
        place, scene = (START, grasp.y, grasp.angle), stickslip.Scene(text)
        tracker = stickslip.Tracker(scene, seed=seed)
        away = [(START - 0.2, 0, 0), (START + 0.2, 0, 0)]
        for row in range(30):
            seen = place + draw.normal(size=3) * CAMERA_STD
            here = tracker.push(row / 30, object=seen, pusher=away[0], fingers=away[1:])
        pose = pose_of(here)
        closings = candidates(scene, grasp, pose)
        chosen = {
            "fixed": 0,
            "nominal": nominal_choice(scene, pose, closings),
            "plan.grasp": plan.grasp(tracker, closings)[0],
        }
        for name, k in chosen.items():
            held[name].append(holds(carried_out(grasp, text, truth, seed, place, closings[k]).truth, -1))
    for name, answers in held.items():
        print(f"{name}: {sum(answers)} of {len(answers)} grasps hold")


def candidates(scene, grasp, pose, **options):
    """36 closings about a pose, those through the centre first."""
    angles, offsets = np.linspace(0, np.pi, 12, endpoint=False), [0.0, -0.3 * grasp.radius, 0.3 * grasp.radius]
    return plan.jaw_closings(scene, pose, angles=angles, offsets=offsets, speed=grasp.speed, **options)


def carried_out(grasp, text, truth, seed, place, path):
    """The testbed's simulation of a closing (t + 1, 6) about an object at rest at `place`."""
    travel = math.hypot(*(path[-1, :2] - path[0, :2]))
    return closed(grasp, text, truth, seed, place, path[0, :3], path[0, 3:], travel)


def pose_of(estimate):
    """Mean pose of an estimate."""
    return [estimate[name] for name in ("x", "y", "theta")]


def nominal_choice(scene, pose, closings):
    """The first closing that the nominal simulation holds, else the first."""
    return int(np.flatnonzero([*nominal_holds(scene, pose, closings), True])[0]) % len(closings)


def nominal_holds(scene, pose, closings):
    """True for each closing (n, t + 1, 6) after which the drive yields while the object rests, by the scene's values."""
    end = stickslip.rollout(scene, np.tile(pose, (len(closings), 1)), closings)
    twist = end["twist"][:, -1]
    yields = np.hypot(*end["pusher_lag"].T) > 1e-5
    return yields & (np.hypot(*twist[:, :2].T) < STILL[0]) & (np.abs(twist[:, 2]) < STILL[1])


def holds(truth, row):
    """True if both fingers press and the object rests in a row of the truth."""
    press = min(truth["force_pusher"][row], truth["force_1"][row]) > TOUCH
    return bool(
        press and math.hypot(truth["vx"][row], truth["vy"][row]) < STILL[0] and abs(truth["omega"][row]) < STILL[1]
    )


def fingers_of(columns):
    """Poses of the pusher and of the finger, (n, 6)."""
    names = [f"{body}_{axis}" for body in ("pusher", "finger_1") for axis in ("x", "y", "theta")]
    return np.column_stack([columns[name] for name in names])


def predictions(folder):
    """Yields (s before the end, probability, nominal's answer, held or not) for an experiment."""
    scene, log = stickslip.load_scene(folder / "scene.toml"), stickslip.load_log(folder / "log.csv")
    truth = np.genfromtxt(folder / "truth.csv", delimiter=",", names=True)
    touched = json.loads((folder / "truth.json").read_text())["occlude_from"]
    time, fingers = log["time"], fingers_of(log)
    seed = int(folder.name.rsplit("-", 1)[1])
    grasp = drawn(seed, folder.name.startswith("hard"))[1]
    end = int(np.flatnonzero(np.abs(fingers[:, 0] - fingers[-1, 0]) > STOPS)[-1]) + 1
    after = np.searchsorted(time, time[end] + AFTER)
    if touched is None or after >= len(time):
        return
    goal = grasp.fingers[0][0] + grasp.travel  # of the pusher, as commanded
    held = holds(truth, after) and fingers[after, 0] < goal - STOPS
    tracker, rows, done = stickslip.Tracker(scene), list(stickslip.rows(log)), 0
    for before in BEFORE:
        now = int(np.searchsorted(time, time[end] - before))
        for k in range(done, now + 1):
            tracker.push(**(rows[k] if k < touched else {**rows[k], "object": None}))
        done = now + 1
        # as commanded: the jaw begins to close after half a second
        way = np.clip(grasp.speed * (time[now : after + 1] - 0.5), 0.0, grasp.travel)
        path = fingers[now] + (way - way[0])[:, None] * np.array([1, 0, 0, -1, 0, 0])
        ends, here = tracker.outcomes(path), tracker.estimate
        nominal = nominal_holds(scene, pose_of(here), path[None])[0]
        yield before, ends["held"] + ends["jammed"], float(nominal), float(held)


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
        chance, nominal, held = rows.T[1:]
        error, groups = calibration_error(chance, held)
        errors = [(guess - held) ** 2 for guess in (chance, nominal, np.full(len(held), held.mean()))]
        gain = errors[0] - errors[1]
        print(f"{before} s before the end: {len(held)} grasps, {100 * held.mean():.0f} % held")
        print("  Brier score: particles {:.3f}, nominal {:.3f}, base rate {:.3f}".format(*map(np.mean, errors)))
        print(f"  particles minus nominal: {gain.mean():.3f} +- {gain.std(ddof=1) / math.sqrt(len(gain)):.3f}")
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
    maker.add_argument("--hard", action="store_true")
    chooser = commands.add_parser("choose")
    chooser.add_argument("first", type=int)
    chooser.add_argument("last", type=int)
    commands.add_parser("score").add_argument("folders", type=Path, nargs="+")
    given = parser.parse_args()
    if given.command == "make":
        make(given.first, given.last, given.out, given.hard)
    elif given.command == "choose":
        choose(given.first, given.last)
    else:
        score(given.folders)


if __name__ == "__main__":
    main()
