"""Compares two builds of the particle filter log by log: does a change of the filter pay?

    python3 bench/pair_filters.py OLD NEW FOLDER... [--seeds 3] [--camera-on] [--jobs 2] [-- OPTION...]

OLD and NEW are two `stickslip` programs (`cargo build --release -p stickslip-cli`). A FOLDER is a set: it holds
experiments (scene.toml, log.csv, truth.csv, truth.json). Both programs estimate every log with the same seeds. The
camera is off from the row that truth.json names; logs without truth hide the middle second and are scored on the
log's own poses. Options after `--` go to both programs.

Scores are over the occluded rows until 1.5 s after the last motion; rows at rest would hide the rest.

- error: root mean square of the pose, angles times the radius of gyration (mm), at most 5 mm for a run
- CRPS: of a normal belief in x, y and rho theta, added (mm)
- covers: share of the 90 % intervals that cover the truth; OLD and the difference
- evidence: natural logarithm, per log

Differences are NEW minus OLD, means over logs with their standard errors; a log counts once, with the mean of its
seeds.
"""

import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
import tomllib
from bisect import bisect_left
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

CUT = 5.0  # mm
AFTER = 1.5  # s after the last motion
MOVING = 1e-3  # m/s, speed of a point at the radius of gyration
Z90 = 1.6448536269514722


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def poses(rows, names):
    """A pose (m, m, rad) for each row; None where a number is missing."""
    cells = [[row.get(name) or "" for name in names] for row in rows]
    return [tuple(map(float, cell)) if all(cell) else None for cell in cells]


def turn(angle):
    return (angle + math.pi) % (2 * math.pi) - math.pi


def last_motion(time, truth, rho):
    """Time of the last row in which the object moves."""
    last = time[0]
    for k in range(1, len(time)):
        if truth[k] and truth[k - 1]:
            (x, y, a), (u, v, b) = truth[k], truth[k - 1]
            if math.hypot(x - u, y - v, rho * turn(a - b)) > MOVING * (time[k] - time[k - 1]):
                last = time[k]
    return last


def crps(error, std):
    """Continuous ranked probability score of a normal belief (Gneiting & Raftery 2007)."""
    if std <= 0:
        return abs(error)
    z = error / std
    density = math.exp(-z * z / 2) / math.sqrt(2 * math.pi)
    return std * (z * math.erf(z / math.sqrt(2)) + 2 * density - 1 / math.sqrt(math.pi))


def earlier(time, seen, latency):
    """Poses at each time that the camera shows `latency` seconds later, linear between rows."""
    found = []
    for now in time:
        k = bisect_left(time, now + latency)
        if latency == 0:
            found.append(seen[k])
        elif k == len(time) or not (seen[k] and seen[k - 1]):
            found.append(None)
        else:
            share = (now + latency - time[k - 1]) / (time[k] - time[k - 1])
            (x, y, a), (u, v, b) = seen[k - 1], seen[k]
            found.append((x + share * (u - x), y + share * (v - y), a + share * turn(b - a)))
    return found


class Experiment:
    """A log with its reference and the rows that are scored."""

    def __init__(self, folder):
        self.folder = folder
        scene = tomllib.loads((folder / "scene.toml").read_text())
        self.rho = math.sqrt(scene["object"]["inertia"] / scene["object"]["mass"])
        facts = folder / "truth.json"
        self.off = json.loads(facts.read_text()).get("occlude_from") if facts.exists() else None
        known = folder / "truth.csv"
        if known.exists():
            rows = table(known)
            self.truth = poses(rows, ("x", "y", "theta"))
            self.until = last_motion([float(row["time"]) for row in rows], self.truth, self.rho) + AFTER
        else:
            rows = table(folder / "log.csv")
            seen = poses(rows, ("object_x", "object_y", "object_theta"))
            self.truth = earlier([float(row["time"]) for row in rows], seen, scene["camera"].get("latency", 0.0))
            self.until = math.inf

    def options(self, camera_on):
        if camera_on:
            return []
        return ["--occlude-middle", "1"] if self.off is None else ["--occlude", str(self.off)]

    def score(self, estimate, camera_on):
        """Error, CRPS (mm) and coverage; None if no row is scored."""
        squares, scores, covered, count = 0.0, 0.0, 0, 0
        beliefs = poses(estimate, ("std_x", "std_y", "std_theta"))
        for k, (row, pose, std) in enumerate(zip(estimate, poses(estimate, ("x", "y", "theta")), beliefs, strict=True)):
            hidden = k >= (self.off or 0) if camera_on else row["visual"] == "0" and (self.off is None or k >= self.off)
            if not hidden or self.truth[k] is None or pose is None or float(row["time"]) > self.until:
                continue
            x, y, theta = (own - true for own, true in zip(pose, self.truth[k], strict=True))
            errors = [1e3 * x, 1e3 * y, 1e3 * self.rho * turn(theta)]
            stds = [1e3 * std[0], 1e3 * std[1], 1e3 * self.rho * std[2]]
            squares += sum(error * error for error in errors)
            scores += sum(crps(error, s) for error, s in zip(errors, stds, strict=True))
            covered += sum(abs(error) <= Z90 * s for error, s in zip(errors, stds, strict=True))
            count += 1
        return (min(math.sqrt(squares / count), CUT), scores / count, covered / (3 * count)) if count else None


def run(program, experiment, seed, args):
    """Scores of one run with log evidence and seconds; None if the program refuses the log."""
    with tempfile.TemporaryDirectory() as out:
        command = [program, "filter", experiment.folder, "--json", "--out", out, "--seed", str(seed), "--threads", "1"]
        began = perf_counter()
        done = subprocess.run(
            [*command, *experiment.options(args.camera_on), *args.options], capture_output=True, check=False
        )
        seconds = perf_counter() - began
        if done.returncode not in (0, 3):
            print(f"{experiment.folder}: {done.stderr.decode().splitlines()[0]}", file=sys.stderr)
            return None
        score = experiment.score(table(Path(out) / "estimate.csv"), args.camera_on)
        summary = json.loads(done.stdout)
        return score and (*score, summary["log_evidence"] or 0.0, seconds)


def mean(numbers):
    return sum(numbers) / len(numbers)


def with_error(numbers, digits):
    """ "+0.012 ± 0.005": mean and standard error."""
    centre = mean(numbers)
    squares = sum((number - centre) ** 2 for number in numbers)
    error = math.sqrt(squares / max(len(numbers) - 1, 1) / len(numbers))
    return f"{centre:+.{digits}f} ± {error:.{digits}f}"


def line(name, logs):
    """One line of the table; `logs` has a pair of means over seeds for each log."""
    both = list(zip(*logs, strict=True))
    of = [[[score[k] for score in scores] for k in range(5)] for scores in both]
    change = [[new - old for old, new in zip(of[0][k], of[1][k], strict=True)] for k in range(5)]
    median = [sorted(side[0])[len(logs) // 2] for side in of]
    cells = [
        f"{name:24} {len(logs):5}",
        f"{median[0]:6.3f} {median[1]:6.3f}",
        f"{with_error(change[0], 3):>16} {with_error(change[1], 3):>16}",
        f"{100 * mean(of[0][2]):5.1f} {with_error([100 * c for c in change[2]], 1):>12}",
        f"{with_error(change[3], 1):>14}",
        f"{sum(of[1][4]) / sum(of[0][4]):5.2f}",
    ]
    print("  ".join(cells), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--each", action="store_true", help="print each log: error, CRPS, coverage, evidence; both programs"
    )
    parser.add_argument("--camera-on", action="store_true")
    parser.add_argument("--every", type=int, default=1, help="every N-th log of a set, for a first look")
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    args = parser.parse_args(words[:cut])
    args.options = words[cut + 1 :]

    head = ["", "logs", "median old, new", "error, mm", "CRPS, mm", "covers, %", "evidence", "time"]
    widths = [24, 5, 13, 16, 16, 18, 14, 5]
    print(f"{head[0]:24} {head[1]:>5}  " + "  ".join(f"{h:>{w}}" for h, w in zip(head[2:], widths[2:], strict=True)))
    everything = []
    for folder in args.folders:
        paths = sorted(path.parent for path in folder.glob("*/log.csv"))[:: args.every]
        experiments = [Experiment(path) for path in paths]
        seeds = range(args.first_seed, args.first_seed + args.seeds)
        jobs = [(p, e, s) for e in experiments for s in seeds for p in (args.old, args.new)]
        with ThreadPoolExecutor(args.jobs) as pool:
            runs = list(pool.map(lambda job: run(*job, args), jobs))
        logs, names = [], []
        for k in range(len(experiments)):
            own = runs[2 * args.seeds * k : 2 * args.seeds * (k + 1)]
            if all(own):
                names.append(experiments[k].folder.name)
                logs.append([[mean(column) for column in zip(*own[side::2], strict=True)] for side in (0, 1)])
        if logs:
            line(folder.name, logs)
            for log, name in zip(logs, names, strict=True):
                if args.each:
                    print("  ", name, " ".join(f"{score:.3f}" for side in log for score in side[:4]))
            everything += logs
    if len(args.folders) > 1 and everything:
        line("all", everything)


if __name__ == "__main__":
    main()
