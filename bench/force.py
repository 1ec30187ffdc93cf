"""What the pusher's force tells of the table's friction, in 106 scenes.

    python3 bench/force.py PROGRAM [--jobs 2] [--physics testbed]

PROGRAM is `stickslip` (`cargo build --release`). The pinned scenes of `stickslip reproduce --pinned` get a table
[wrench] and are simulated; the scene's friction is off by up to 1.7 times. Each log is estimated with the table and
without it, the camera off from just before the first fixel. Two rows come out:

- mu_s prior, estimate: mean of |ln(value / truth)| of the scene's value, and of the estimate when the camera turns off
- covers: share of the 90 % intervals for ln mu_s that hold the truth
- observed: scenes in which the standard deviation is below half the prior's
- pose: root mean square of the occluded rows, median and 90 % quantile over scenes, and the mean of at most 5 mm (mm)
"""

import argparse
import csv
import json
import math
import statistics
import subprocess
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SCENES = Path(__file__).parent.parent / "crates/evaluation/scenes/pinned.toml"
WRENCH = "\n[wrench]\nforce_std = 0.03\n"
PRIOR = 0.35
Z90 = 1.645


def simulate(program, pinned, physics, folder):
    scene = folder / "given.toml"
    scene.write_text(pinned["scene"] + WRENCH)
    mu_s, mu_p, mu_f = pinned["friction"]
    truth = {"mu_s": mu_s, "mu_p": mu_p, "mu_f": mu_f, "occlude_from": pinned["dark"]}
    (folder / "rig.json").write_text(json.dumps(truth))
    options = ["--truth", folder / "rig.json", "--seed", str(pinned["seed"]), "--physics", physics]
    subprocess.run([program, "simulate", scene, *options, "--out", folder / "log"], check=True, capture_output=True)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def estimate(program, pinned, folder, wrench):
    """Errors of ln mu_s and its standard deviation when the camera turns off, and the pose error (mm)."""
    scene = folder / "scene.toml"
    scene.write_text(pinned["scene"] + (WRENCH if wrench else ""))
    out = folder / "out"
    options = ["--scene", scene, "--occlude", str(pinned["dark"]), "--threads", "1", "--out", out]
    subprocess.run([program, "filter", folder / "log/log.csv", *options], check=True, capture_output=True)
    estimates, truth = rows(out / "estimate.csv"), rows(folder / "log/truth.csv")

    given, true = tomllib.loads(pinned["scene"]), pinned["friction"][0]
    value, std = (float(estimates[pinned["dark"]][key]) for key in ("mu_s", "std_mu_s"))
    log_std = math.sqrt(math.log(1 + (std / value) ** 2))
    error = math.log(value / true) - log_std**2 / 2

    rho = math.sqrt(given["object"]["inertia"] / given["object"]["mass"])
    squares = []
    for e, t in zip(estimates[pinned["dark"] :], truth[pinned["dark"] :], strict=True):
        off = [float(e[key]) - float(t[key]) for key in ("x", "y", "theta")]
        squares.append(off[0] ** 2 + off[1] ** 2 + (rho * off[2]) ** 2)
    return math.log(given["support"]["friction"] / true), error, log_std, 1e3 * math.sqrt(statistics.mean(squares))


def both(program, pinned, physics):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulate(program, pinned, physics, folder)
        return [estimate(program, pinned, folder, wrench) for wrench in (False, True)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--physics", choices=["testbed", "model"], default="testbed")
    given = parser.parse_args()
    scenes = tomllib.loads(SCENES.read_text())["scene"]
    with ThreadPoolExecutor(given.jobs) as pool:
        results = list(pool.map(lambda pinned: both(given.program, pinned, given.physics), scenes))
    print(
        f"{'':16}{'mu_s prior':>11}{'estimate':>10}{'covers':>9}{'observed':>12}{'pose median':>13}{'90 %':>7}{'mean':>7}"
    )
    for name, runs in zip(("without force", "with force"), zip(*results, strict=True), strict=True):
        priors, errors, stds, poses = zip(*runs, strict=True)
        covers = statistics.mean(abs(error) < Z90 * std for error, std in zip(errors, stds, strict=True))
        observed = sum(std < PRIOR / 2 for std in stds)
        print(
            f"{name:16}{statistics.mean(map(abs, priors)):11.3f}{statistics.mean(map(abs, errors)):10.3f}"
            f"{100 * covers:7.0f} %{observed:8} of {len(runs)}{statistics.median(poses):13.2f}"
            f"{statistics.quantiles(poses, n=10)[8]:7.1f}{statistics.mean(min(pose, 5.0) for pose in poses):7.2f}"
        )


if __name__ == "__main__":
    main()
