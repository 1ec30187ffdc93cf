"""Rollouts of the timing scene, one thread each: from Python, from Rust, and by ``mujoco.rollout``.

Times are those that the thread was on a processor, so that other programs count little.

The object is pushed for 198 steps of 1/30 s past three fixels, from 10,000 starts a little apart (MuJoCo: 1,000).

    pip install . mujoco
    cargo build --release -p stickslip-bench --bin rollouts
    python bench/python/rollouts.py target/release/rollouts ../shared/data/bench-scene
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

import stickslip

STATES, STEPS, ROUNDS, H = 10_000, 198, 5, 1 / 30

# bench/peers/mujoco/peer.c, with a pusher so heavy that nothing slows it: mujoco.rollout cannot set its place
MODEL = f"""
<mujoco><option cone="elliptic" impratio="10" timestep="{H:.17g}" gravity="0 0 -9.81"/><worldbody>
<geom type="plane" size="2 2 1" friction=".3" contype="1" conaffinity="1"/>
<body><freejoint/>
<inertial pos="0 0 0" mass=".5" diaginertia="1.0416667e-4 1.0416667e-4 2.0833333333333335e-4"/>
<geom type="box" size=".025 .025 .004" friction=".3" contype="2" conaffinity="2"/>
<geom type="sphere" size=".001" pos="0 .02 .001" friction=".3" contype="1" conaffinity="1"/>
<geom type="sphere" size=".001" pos="-.017320508075688773 -.01 .001" friction=".3" contype="1" conaffinity="1"/>
<geom type="sphere" size=".001" pos=".017320508075688773 -.01 .001" friction=".3" contype="1" conaffinity="1"/></body>
<body pos="-.032 -.0033 0"><joint type="slide" axis="1 0 0"/>
<geom type="sphere" size=".005" mass="1000000" friction=".3" contype="2" conaffinity="2"/></body>
<geom type="sphere" size=".005" pos=".0794 .0591 0" friction=".3" contype="2" conaffinity="2"/>
<geom type="sphere" size=".005" pos=".1203 -.0458 0" friction=".3" contype="2" conaffinity="2"/>
<geom type="sphere" size=".005" pos=".0606 .0485 0" friction=".3" contype="2" conaffinity="2"/>
</worldbody></mujoco>
"""


def best(work: Callable[[], object], states: int, rounds: int = ROUNDS) -> float:
    """ns per trajectory and step on a processor, the best of some rounds."""
    seconds = []
    for _ in range(rounds):
        begin = time.process_time()
        work()
        seconds.append(time.process_time() - begin)
    return 1e9 * min(seconds) / states / STEPS


def starts(count: int) -> np.ndarray:
    """Poses up to 0.3 mm and 0.5 degrees apart, the first at the origin."""
    poses = np.random.default_rng(0).uniform(-1, 1, (count, 3)) * [3e-4, 3e-4, np.deg2rad(0.5)]
    poses[0] = 0
    return poses


def by_mujoco(count: int) -> tuple[float, np.ndarray]:
    """Time of MuJoCo, and the last pose (3,) of the first trajectory."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    poses = starts(count)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    initial = np.zeros((count, size))
    for row, (x, y, theta) in zip(initial, poses, strict=True):
        data.qpos[:7] = [x, y, 0, np.cos(theta / 2), 0, 0, np.sin(theta / 2)]
        data.qvel[6] = 0.020
        mujoco.mj_getState(model, data, row, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states = np.empty((count, STEPS, size))
    taken = best(
        lambda: mujoco.rollout.rollout([model], [data], initial, nstep=STEPS, state=states),
        count,
        3,
    )
    x, y, *_, w, _, _, z = states[0, -1, 1:8]
    return taken, np.array([x, y, 2 * np.arctan2(z, w)])


def main() -> None:
    """Prints the three times and their ratios."""
    program, data = sys.argv[1], Path(sys.argv[2])
    scene = stickslip.load_scene(data / "scene.toml")
    push = np.column_stack(
        [-0.032 + 0.020 * H * np.arange(STEPS + 1), np.full(STEPS + 1, -0.0033), np.zeros(STEPS + 1)]
    )
    pushes = np.repeat(push[None], STATES, axis=0)
    poses = starts(STATES)
    kept = stickslip.rollout(scene, poses, pushes, threads=1)
    python = best(lambda: stickslip.rollout(scene, poses, pushes, threads=1), STATES)
    again = best(lambda: stickslip.rollout(scene, poses, pushes, threads=1, out=kept), STATES)
    rust = float(subprocess.run([program], check=True, capture_output=True, text=True).stdout)
    peer, end = by_mujoco(1_000)
    reference = np.loadtxt(data / "ref_traj_h.txt")[STEPS - 1, 1:4]
    away = 1e3 * np.hypot(*(end - reference)[:2])
    print(
        f"Rust {rust:.0f} ns, Python {python:.0f} ns ({rust / python:.0%} of its speed), "
        f"into the same arrays {again:.0f} ns"
    )
    print(
        f"mujoco.rollout {peer:.0f} ns, {peer / python:.0f} times as long; {away:.2f} mm from the reference at the end"
    )


if __name__ == "__main__":
    main()
