"""Runs the peers and this project on the timing scene, one after the other in every round, and prints the table.

usage: compare.py DATA ROUNDS NAME=COMMAND...   (DATA: the folder of bench-scene; a COMMAND is split at spaces)
Every command prints lines `time FRAME NS`, `pose FRAME X Y THETA`, `creep MM`.
"""
import math
import subprocess
import sys
from statistics import median

PHASES = [("pushed", range(10, 76)), ("1 fixel", range(95, 146)), ("2 fixels", range(165, 198)), ("rest", range(300, 600))]
END_OF_PUSH = 80  # frame near the end of free pushing, where the time step costs most


def reference(path):
    with open(path) as lines:
        return [[float(x) for x in line.split()[1:4]] for line in lines]


def run(command):
    out = subprocess.run(command.split(), check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in out.splitlines()]
    times = {int(r[1]): float(r[2]) for r in rows if r[0] == "time"}
    poses = {int(r[1]): [float(x) for x in r[2:5]] for r in rows if r[0] == "pose"}
    return times, poses, [float(r[1]) for r in rows if r[0] == "creep"][0]


def errors(poses, truth):
    d = [1e3 * math.hypot(poses[f][0] - truth[f][0], poses[f][1] - truth[f][1]) for f in range(600)]
    return f"{d[END_OF_PUSH]:.3g} / {max(d):.3g}"


def main():
    data, rounds, peers = sys.argv[1], int(sys.argv[2]), [a.split("=", 1) for a in sys.argv[3:]]
    coarse, fine = reference(f"{data}/ref_traj_h.txt"), reference(f"{data}/ref_traj.txt")
    results = {name: [] for name, _ in peers}
    for _ in range(rounds):
        for name, command in peers:
            results[name].append(run(command))
    print("| peer | " + " | ".join(f"{p}, ns" for p, _ in PHASES) + " | times the first row, pushed to 2 fixels | error mm, h = 1/30 s (end of push / max) | error mm, h = 1/480 s | creep mm |")
    print("| --- |" + " --- |" * 8)
    first = None
    for name, _ in peers:
        times = {f: median(r[0][f] for r in results[name]) for f in range(600)}
        cost = [median(times[f] for f in frames) for _, frames in PHASES]
        first = first or cost
        ratios = ", ".join(f"{c / own:.3g}" for c, own in zip(cost[:3], first))
        _, poses, creep = results[name][0]
        cells = [f"{c:,.0f}" for c in cost] + [ratios, errors(poses, coarse), errors(poses, fine), f"{creep:.2g}"]
        print(f"| {name} | " + " | ".join(cells) + " |")


main()
