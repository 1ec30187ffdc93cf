"""Experiments as a third kind of rig records them: camera and robot disagree, and nobody knows.

    python3 bench/offset_rig.py SOURCE DESTINATION SEED

SOURCE holds experiments with known motion (scene.toml, log.csv, truth.csv, truth.json). Their copies have the
pusher logged 1 mm off in a random direction, and camera poses 30 ms late; the scene mentions neither. Fixels, shapes
and touch stay exact. Neither the priors of `[uncertainty]` nor a prior of rough rigs were chosen on such a rig.
"""

import csv
import math
import random
import shutil
import sys
import zlib
from pathlib import Path

OFFSET = 1e-3  # m
LATENCY = 0.03  # s
POSE = ("x", "y", "theta")


def late(time, truth, now):
    """Pose of the object at a time, linear between rows."""
    k = max(1, next((k for k, t in enumerate(time) if t >= now), len(time) - 1))
    share = min(max((now - time[k - 1]) / (time[k] - time[k - 1]), 0.0), 1.0)
    return [float(truth[k - 1][c]) * (1 - share) + float(truth[k][c]) * share for c in POSE]


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def record(source, out, seed):
    draw = random.Random(zlib.crc32(f"{seed} {source.name}".encode()))
    angle = draw.uniform(-math.pi, math.pi)
    log, truth = table(source / "log.csv"), table(source / "truth.csv")
    time = [float(row["time"]) for row in truth]
    for row, true, now in zip(log, truth, time, strict=True):
        if row["object_x"]:
            # the camera's own noise stays
            for name, then in zip(POSE, late(time, truth, now - LATENCY), strict=True):
                row[f"object_{name}"] = f"{float(row[f'object_{name}']) + then - float(true[name]):.6f}"
        if row["pusher_x"]:
            row["pusher_x"] = f"{float(row['pusher_x']) + OFFSET * math.cos(angle):.6f}"
            row["pusher_y"] = f"{float(row['pusher_y']) + OFFSET * math.sin(angle):.6f}"
    out.mkdir(parents=True, exist_ok=True)
    for name in ("scene.toml", "truth.csv", "truth.json"):
        shutil.copy(source / name, out)
    with open(out / "log.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, log[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(log)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    for folder in sorted(Path(sys.argv[1]).iterdir()):
        if (folder / "truth.csv").exists():
            record(folder, Path(sys.argv[2]) / folder.name, sys.argv[3])
