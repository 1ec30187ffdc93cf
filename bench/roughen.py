"""Experiments as a rough rig records them, with the same motions.

    python3 bench/roughen.py SOURCE DESTINATION SEED

Needs `pip install numpy`. SOURCE holds experiments with known motion (scene.toml, log.csv, truth.csv, truth.json),
without forces. scene.toml of a copy has what a careful user measures, log.csv what a rough rig logs; truth.json lists
the disturbances, under `rough`. They are drawn per experiment from its folder's name and SEED:

- camera: noise 0.1 to 1 mm and 0.1 to 1 degree, nominal within a factor of 1.7; repeated frames 3 %, losses of 1 to 10
  frames 5 %, outliers 1 % (5 to 20 mm, 30 to 90 degrees); latency 0 to 0.1 s, not in the scene
- pusher: noise 0.02 to 0.2 mm, nominal; offset from the camera 0.4 mm (one sigma) per axis, not in the scene
- scene: fixels off by 0.3 mm (one sigma) per axis, outline by 0.2 mm (one sigma), mass by at most 5 %
- touch: threshold 0.02 to 0.3 N, misses 5 %, false alarms 0.2 %
"""

import argparse
import csv
import json
import math
import re
import shutil
import sys
import zlib
from pathlib import Path

import numpy as np

STDS = ("position_std", "position_std", "orientation_std")
POINT = r"\[([-\d.]+), ([-\d.]+)\]"


def draw_rig(draw):
    """Disturbances (SI), and the scene's noise of the camera over the true one. The published sets need this order."""

    def log_uniform(low, high):
        return math.exp(draw.uniform(math.log(low), math.log(high)))

    rig = {"position_std": log_uniform(1e-4, 1e-3), "orientation_std": math.radians(log_uniform(0.1, 1.0))}
    nominal = log_uniform(1 / 1.7, 1.7)
    rig |= {"latency": draw.uniform(0, 0.1), "pusher_std": draw.uniform(2e-5, 2e-4)}
    rig["pusher_offset"] = list(draw.normal(size=2) * 4e-4)
    return rig, nominal


def camera_poses(draw, rig, time, truth):
    """Logged poses (n, 3), which of them the camera saw, and rows of outliers. The first five rows are good."""
    rows = len(time)
    late = np.column_stack([np.interp(time - rig["latency"], time, axis) for axis in truth.T])
    poses = late + draw.normal(size=(rows, 3)) * [rig[key] for key in STDS]
    seen, wrong = np.ones(rows, bool), draw.random(rows) < 0.01
    wrong[:5] = False
    outliers = np.flatnonzero(wrong).tolist()
    for k in outliers:
        angle = draw.uniform(0, 2 * math.pi)
        x, y = draw.uniform(0.005, 0.02) * math.cos(angle), draw.uniform(0.005, 0.02) * math.sin(angle)
        poses[k] += [x, y, math.radians(draw.uniform(30, 90)) * draw.choice([-1, 1])]
    k = 5
    while k < rows:
        if draw.random() < 0.05 / 5.5:
            lost = int(draw.integers(1, 11))
            seen[k : k + lost] = False
            k += lost
        k += 1
    for k in range(5, rows):
        if draw.random() < 0.03:
            poses[k], seen[k] = poses[k - 1], seen[k - 1]
    return poses, seen, outliers


def measured_scene(draw, rig, nominal, text):
    """The scene with errors of a careful user, and the error of the outline (m)."""

    def mass(found):
        return f"{found[1]}{float(found[2]) * (1 + draw.uniform(-0.05, 0.05)):.6f}"

    def fixel(found):
        return f"{found[1]}[{', '.join(f'{float(found[k]) + 3e-4 * draw.normal():.6f}' for k in (2, 3))}]"

    def outline(found):
        corners = [(float(x), float(y)) for x, y in re.findall(POINT, found[0])]
        scale = 1 + grow / max(math.hypot(*corner) for corner in corners)
        return "{ polygon = [" + ", ".join(f"[{x * scale:.6f}, {y * scale:.6f}]" for x, y in corners) + "] }"

    text = re.sub(r"(mass = )([\d.]+)", mass, text, count=1)
    text = re.sub(r"(position = )" + POINT, fixel, text)
    grow = 2e-4 * draw.normal()
    own, others = text.split("[support]", 1)
    text = re.sub(r"\{ polygon = .*?\] \}", outline, own) + "[support]" + others
    for key, factor in (("position_std", nominal), ("orientation_std", nominal), ("pusher_std", 1)):
        name = key.replace("pusher", "pusher_position")
        text = re.sub(rf"\n{name} = [\d.]+", f"\n{name} = {rig[key] * factor:.6f}", text)
    return text, grow


def record(source, out, seed):
    """Writes the rough copy of one experiment."""
    text = (source / "scene.toml").read_text()
    if "[wrench]" in text:
        sys.exit(f"{source / 'scene.toml'}: has [wrench], but a rough rig logs no force; make it without --force")
    draw = np.random.default_rng([seed, zlib.crc32(source.name.encode())])
    with open(source / "truth.csv", newline="") as file:
        names, *rows = csv.reader(file)
    truth = dict(zip(names, np.array(rows, float).T, strict=True))
    time, motion = truth["time"], np.column_stack([truth[name] for name in ("x", "y", "theta")])
    forces = np.column_stack([truth[name] for name in names if re.fullmatch(r"force_\d+", name)])

    rig, nominal = draw_rig(draw)
    poses, seen, outliers = camera_poses(draw, rig, time, motion)
    pusher = np.column_stack([truth["pusher_x"], truth["pusher_y"]])
    pusher = pusher + draw.normal(size=pusher.shape) * rig["pusher_std"] + rig["pusher_offset"]
    threshold = draw.uniform(0.02, 0.3)
    touch = (forces > threshold) & ~(draw.random(forces.shape) < 0.05)
    touch |= draw.random(forces.shape) < 0.002
    scene, grow = measured_scene(draw, rig, nominal, text)

    out.mkdir(parents=True, exist_ok=True)
    (out / "scene.toml").write_text(scene)
    shutil.copy(source / "truth.csv", out)
    head = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,"
    lines = [head + ",".join(f"tactile_{k + 1}" for k in range(forces.shape[1]))]
    for k in range(len(time)):
        pose = [f"{value:.6f}" if seen[k] else "" for value in poses[k]]
        place = [f"{value:.6f}" for value in pusher[k]]
        lines.append(",".join([f"{time[k]:.6f}", *pose, *place, "0", *map(str, touch[k].astype(int))]))
    (out / "log.csv").write_text("\n".join(lines) + "\n")
    facts = json.loads((source / "truth.json").read_text())
    facts["rough"] = rig | {"outlier_rows": outliers, "touch_threshold": threshold, "outline_error": grow}
    (out / "truth.json").write_text(json.dumps(facts, indent=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path)
    parser.add_argument("destination", type=Path)
    parser.add_argument("seed", type=int)
    given = parser.parse_args()
    for folder in sorted(given.source.iterdir()):
        if (folder / "truth.csv").exists():
            record(folder, given.destination / folder.name, given.seed)


if __name__ == "__main__":
    main()
