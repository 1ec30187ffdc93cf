"""A jaw grasps an object that it has pushed out of the camera's sight: open loop against closed loop.

    python3 bench/regrasp.py FIRST LAST

The objects are those of `grasp_ends.py --hard`, on the testbed. The pusher pushes each 100 to 300 mm, off its centre.
The camera is off from just before the push on. Then the jaw closes about the object, as chosen among 36 closings.

- Open loop: chosen as before the push, about the pose to which it will bring the object, by the nominal simulation
  (the first that it holds) or by the tracker's particles (`plan.grasp`).
- After the push: chosen the same ways by the tracker that got the fingers' poses and touches meanwhile.
- Regrasp: as after the push by particles, and once more: 5 rows after the first touch, or at the end without one, the
  tracker compares going on with 36 other closings. The fingers go round the object to the other one.

A finger that comes down on the object is a grasp that does not hold. It prints the share of grasps that hold, and the
paired difference to the first way, with standard errors.
"""

import argparse
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from grasp_ends import candidates, carried_out, closed, drawn, fingers_of, holds, nominal_choice, pose_of
from mujoco_grasps import START

import stickslip
from stickslip import plan

WANTED = ("held", "jammed")
H = 1 / 30  # s
PUSH = (0.1, 0.3)  # m
CLEAR = 0.025  # m: between object and fingers at first
AFTER_TOUCH = 5  # rows
SPEED = 0.05  # m/s: of the push and of the closing jaw
ROUND, FAST = 0.15, 0.3  # m from the object, m/s: fingers that go round it


def grasps(seed):
    """Returns for each way to choose whether the grasp holds."""
    draw, grasp, text, truth = drawn(seed, True)
    grasp.speed = SPEED
    scene, place = stickslip.Scene(text), (START, grasp.y, grasp.angle)
    start, _ = plan.jaw_openings(scene, CLEAR)
    pusher = (START - start, draw.uniform(-0.7, 0.7) * grasp.radius, 0)
    travel = CLEAR + draw.uniform(*PUSH)
    rig = closed(grasp, text, truth, seed, place, pusher, (START + 0.5, 0, 0), travel)
    place = [rig.truth[name][-1] for name in ("x", "y", "theta")]
    rows = list(stickslip.rows(rig.log))
    hidden = rig.facts["occlude_from"] or len(rows) - 1  # a push that misses
    tracker = stickslip.Tracker(scene, seed=seed)
    for row in rows[:hidden]:
        seen = tracker.push(**row)
    blind = tracker.copy()
    for row in rows[hidden:]:
        tracker.push(**{**row, "object": None})
        blind.push(**{**row, "object": None, "tactile": ()})

    predicted = stickslip.rollout(scene, [pose_of(seen)], fingers_of(rig.log)[hidden - 1 :])["pose"][0, -1]
    chosen = {}
    for name, pose, belief in [("open loop", predicted, blind), ("after the push", pose_of(tracker.estimate), tracker)]:
        closings = candidates(scene, grasp, pose, clearance=CLEAR)
        chosen[f"{name}, nominal"] = closings[nominal_choice(scene, pose, closings)]
        closings = candidates(scene, grasp, pose_of(belief.estimate), clearance=CLEAR)
        chosen[f"{name}, particles"] = path = closings[plan.grasp(belief, closings, wanted=WANTED)[0]]
    rigs = {name: tried(grasp, text, truth, seed, place, path) for name, path in chosen.items()}
    held = {name: rig is not None and holds(rig.truth, -1) for name, rig in rigs.items()}

    # the last path, once more
    name, first, fingers = "regrasp, particles", rigs["after the push, particles"], fingers_of(rig.log)[-1]
    held[name] = False
    if first is None:
        return held
    way = transit(fingers, path[0], pose_of(tracker.estimate))
    for k, fingers in enumerate(way, 1):
        tracker.push(rows[-1]["time"] + k * H, pusher=fingers[:3], fingers=[fingers[3:]])
    touched = np.flatnonzero((first.log["tactile_1"] > 0) | (first.log["tactile_2"] > 0))
    now = min(int(touched[0]) + AFTER_TOUCH if len(touched) else len(first.log["time"]), len(first.log["time"]) - 1)
    began = rows[-1]["time"] + (len(way) + 1) * H
    for row in list(stickslip.rows(first.log))[: now + 1]:
        tracker.push(**{**row, "time": began + row["time"], "object": None})
    pose = pose_of(tracker.estimate)
    closings = candidates(scene, grasp, pose, clearance=CLEAR)
    best, ends = plan.grasp(tracker, closings, wanted=WANTED)
    done = round((first.log["time"][now] - 0.5) / H)
    rest = path[done:] + (fingers_of(first.log)[now] - path[done]) if 0 <= done < len(path) - 1 else None
    if rest is None or chance(ends[best]) > chance(tracker.outcomes(rest)):
        place = [first.truth[name][now] for name in ("x", "y", "theta")]
        first = tried(grasp, text, truth, seed, place, closings[best])
    held[name] = first is not None and holds(first.truth, -1)
    return held


def chance(ends):
    """Probability that a grasp holds."""
    return sum(ends[name] for name in WANTED)


def tried(*grasp):
    """The testbed's simulation of a closing; None if a finger comes down on the object."""
    try:
        return carried_out(*grasp)
    except stickslip.Error as error:
        if "overlaps" not in str(error):
            raise
        return None


def transit(here, there, around):
    """Poses (n, 6) of fingers that go from `here` to `there` (6,) round the pose `around`."""

    def polar(pose):
        x, y = pose[0] - around[0], pose[1] - around[1]
        return math.hypot(x, y), math.atan2(y, x)

    ways = []
    for k in (0, 3):
        (r0, a0), (r1, a1) = polar(here[k : k + 2]), polar(there[k : k + 2])
        far, turn = max(ROUND, r0, r1), math.remainder(a1 - a0, 2 * math.pi)
        knots = np.cumsum([0, far - r0, far * abs(turn), far - r1]) / (FAST * H)
        ways.append((knots, [r0, far, far, r1], [a0, a0, a0 + turn, a0 + turn]))
    steps = np.arange(1, math.ceil(max(way[0][-1] for way in ways)) + 1)
    columns = []
    for k, (knots, *values) in enumerate(ways):
        radius, angle = (np.interp(steps, knots, value) for value in values)
        turn = np.interp(steps, [0, steps[-1]], [here[3 * k + 2], there[3 * k + 2]])
        columns += [around[0] + radius * np.cos(angle), around[1] + radius * np.sin(angle), turn]
    return np.column_stack(columns)


def main():
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    given = parser.parse_args()
    with ThreadPoolExecutor() as pool:
        found = list(pool.map(grasps, range(given.first, given.last)))
    table = {name: np.array([held[name] for held in found], dtype=float) for name in found[0]}
    base = table["open loop, nominal"]
    print(f"{len(base)} grasps")
    for name, held in table.items():
        share, gain = held.mean(), held - base
        error = math.sqrt(share * (1 - share) / len(held))
        spread = gain.std(ddof=1) / math.sqrt(len(gain))
        print(f"  {name}: {share:.3f} +- {error:.3f} hold, {gain.mean():+.3f} +- {spread:.3f}")


if __name__ == "__main__":
    main()
