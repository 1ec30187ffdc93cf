"""Random scenes and damaged files: the program answers or refuses, fast, in little memory, without a panic.

usage: bench/fuzz.py scenes|files FIRST LAST [--program target/release/stickslip] [--keep DIR] [--jobs 2]

scenes: case k draws a scene from seed k, simulates it and filters the log with the camera off in its second half.
    Every fifth is filtered on 1 to 4 threads; the outputs must be equal byte for byte.
files: case k damages one file of an experiment that the program itself has written, and gives it to the commands
    that read it: scene.toml, log.csv, truth.csv, truth.json, an MCAP file, metadata.yaml of a bag, camera_info.yaml,
    rows for `live`.

A failure is a panic, a signal, a refusal without an `error:` line, an estimate that is not finite, outputs that
depend on threads, more than 20 s of CPU or 500 MB. Its files and its command are kept in DIR.
"""

import argparse
import json
import math
import os
import random
import re
import resource
import shutil
import struct
import subprocess
import tempfile
import threading
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

CPU, MEMORY = 20, 500  # s, MB
EXTREMES = "0 -0 1 -1 2 1e-12 1e-9 -1e-6 1e-3 0.5 1e3 1e6 1e9 -1e9 1e300 -1e300 1e-320 1e999 nan inf -inf".split()
OTHERS = ["18446744073709551616", "00", "0x10", "", '""', "[]", "true", "null", "1" * 400]
BYTES = [b"\xff\xfe", b"\0", b"\xef\xbb\xbf", b"\n", b"\r", b'"', b"\xc3", b"[" * 5000]
LENS = """image_width: 640\nimage_height: 480\ncamera_matrix: {data: [600, 0, 320, 0, 601, 240, 0, 0, 1]}
distortion_model: plumb_bob\ndistortion_coefficients: {data: [-0.2, 0.1, 0.001, 0, 0.02]}\n"""
BAG = """rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  compression_format: ""
  message_count: 120\n  relative_file_paths:\n    - push_0.mcap\n"""
OPTIONS = ["", "", "", "--model paper", "--causal", "--no-tactile", "--force", "--mcap --tum --report r.html"]
METHODS = "particle particle particle kalman kalman-stops with-pusher extended-kalman nominal".split()
FILES = "scene.toml scene.toml log.csv log.csv truth.csv truth.json bag/push_0.mcap bag/push_0.mcap".split()
FILES += ["bag/metadata.yaml", "camera_info.yaml", "rows.jsonl"]
counts, lock = defaultdict(Counter), threading.Lock()


def body(rng, a):
    """A shape of about the radius `a` as TOML, its largest radius, and whether its centroid is the origin."""
    kind, b = rng.choice(["polygon", "disc", "ellipse", "bar", "corner", "discs"]), a * rng.uniform(0.1, 1)
    if kind == "disc":
        return f"[{{ disc = {{ radius = {a} }} }}]", a, True
    if kind == "ellipse":
        return f"[{{ ellipse = {{ semi_axes = [{a}, {b}], angle = {rng.uniform(-3, 3)} }} }}]", a, True
    if kind == "discs":
        at = [a * (2 * i / n - 1) for n in [rng.choice([1, 2, 5, 40])] for i in range(n + 1)]
        discs = [f"{{ disc = {{ radius = {b / 2}, centre = [{x}, 0] }} }}" for x in at]
        return f"[{', '.join(discs)}]", a + b / 2, True
    if kind == "bar":
        parts = [[(-b, -a), (b, -a), (b, a), (-b, a)]]
    elif kind == "corner":
        w, h = b * rng.uniform(1.2, 2), a * rng.uniform(0.1, 0.9)
        parts = [[(0, 0), (b, 0), (b, a), (0, a)], [(b, 0), (w, 0), (w, h), (b, h)]]
    else:
        n = rng.choice([3, 4, 5, 7, 12, 300])
        turns = [2 * math.pi * (i + rng.uniform(0, 0.7)) / n for i in range(n)]
        parts = [[(a * math.cos(t), b * math.sin(t)) for t in turns]]
    edges = [(x, y, u, v, (x * v - u * y) / 2) for p in parts for (x, y), (u, v) in zip(p, p[1:] + p[:1])]
    area, off = sum(e[4] for e in edges), rng.choice([0] * 6 + [b * rng.uniform(-0.5, 0.5)])
    cx, cy = (sum((e[i] + e[i + 2]) * e[4] for e in edges) / area / 3 for i in (0, 1))
    parts = [[[x - (off + cx), y - cy] for x, y in p] for p in parts]
    text = ", ".join(f"{{ polygon = {p} }}" for p in parts)
    return f"[{text}]", max(math.hypot(*q) for p in parts for q in p), not off


def scene(rng):
    """The text of scene.toml, and the physics that accept its drive."""

    def log(low, high):
        return math.exp(rng.uniform(math.log(low), math.log(high)))

    size = log(1e-3, 2) if rng.random() < 0.1 else log(0.015, 0.15)
    shape, radius, plate = body(rng, size)
    pusher, reach, _ = body(rng, size * log(0.05, 1))
    duration, ahead, mass = rng.uniform(0.3, 2), rng.uniform(-math.pi, math.pi), log(0.02, 5)
    stall = rng.choice(["", "", f"stall_force = {log(0.01, 1000)}", "stall_force = inf"])
    given = not plate or rng.random() < 0.3
    text = f"""gravity = {rng.choice([9.81, 9.81, 1.62, 30])}
[object]\nmass = {mass}\nshape = {shape}\n{f"inertia = {mass * radius**2 * rng.uniform(0.1, 0.9)}" if given else ""}
[support]\nfriction = {log(0.02, 1)}\n{f"tripod_radius = {radius * rng.uniform(0.2, 0.9)}" if given else ""}
[pusher]\nshape = {pusher}\nfriction = {rng.choice([0, 0.3, 1, rng.random()])}\n{stall}
[fixels]\nfriction = {rng.choice([0, 0.25, 1, rng.random()])}\n"""
    for _ in range(rng.choice([0, 1, 2, 3, 4, 12])):
        fixel, width, _ = body(rng, size * log(0.05, 1))
        far, t = radius + width + size * rng.choice([-0.02, 0.3, 1]) * rng.random(), ahead + rng.uniform(-1.3, 1.3)
        text += f"[[fixel]]\nposition = [{far * math.cos(t)}, {far * math.sin(t)}]\nangle = {t}\nshape = {fixel}\n"
    text += f"[camera]\nposition_std = {log(1e-5, 3e-3)}\norientation_std = {log(1e-4, 0.05)}\n"
    exact = "pusher_position_std = 0\npusher_orientation_std = 0\n"
    text += rng.choice(["", f"latency = {rng.uniform(0, 0.1)}\n", exact])
    text += "[uncertainty]\n" + rng.choice(["", "", "pusher_lag = 3e-3\ncreep = 0.1\n", "mu_s = 0\noutline = 0\n"])
    far, aside = radius + reach + size * rng.choice([0.01, 0.2]), size * rng.uniform(-0.7, 0.7)
    x, y = -far * math.cos(ahead) - aside * math.sin(ahead), -far * math.sin(ahead) + aside * math.cos(ahead)
    pace = size * rng.uniform(0.3, 3) / duration
    speed = rng.choice([pace, pace, [[0, 0], [duration / 2, pace], [duration, 0]], [[0, pace], [duration / 2, -pace]]])
    text += f"[start]\nobject = [0, 0, {rng.uniform(-3, 3)}]\npusher = [{x}, {y}, {rng.uniform(-3, 3)}]\n"
    text += f"direction = {ahead + rng.gauss(0, 0.2)}\nspeed = {speed}\n"
    if rng.random() < 0.15:
        number = rng.choice(list(re.finditer(r"-?[\d.]+(e-?\d+)?", text)))
        text = text[: number.start()] + rng.choice(EXTREMES) + text[number.end() :]
    return f"{text}duration = {duration}\n", "model" if "inf" in stall or rng.random() < 0.2 else "testbed"


def damaged(rng, data, binary):
    """The bytes of a file after one to three changes."""
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        at, size = rng.randrange(len(data) + 1), rng.choice([1, 2, 8, 64, 500])

        def some(pattern):
            found = rng.choice([*re.finditer(pattern, data), None])
            return (*found.span(), found[0]) if found else (at, at, b"")

        new = rng.choice([*BYTES, rng.randbytes(size), data[at : at + size], data[at : at + size] * 1000])
        changes = [(at, at + 1, rng.randbytes(1)), (at, len(data), b""), (at, at + size, b""), (at, at, new)]
        if binary:
            number = struct.pack("<d", rng.choice([0, -1, 1e300, math.nan, math.inf, 1e-320, 3600, rng.gauss(0, 1)]))
            length = struct.pack("<Q", rng.choice([0, 255, 2**31, 2**63, 2**64 - 1]))
            changes += [(at, at + 8, number), (at, at + 8, length), (at, at + 4, length[:4])] * 2
        else:
            start, end, line = some(rb"[^\n]*\n")
            first, last, _ = some(rb"[^,\n]+")
            begin, stop, number = some(rng.choice([b"", b"(?<=[=:] )"]) + rb"-?\d[\d.]*(e-?\d+)?")
            near = str(float(number) * rng.uniform(0.5, 1.5)) if re.fullmatch(rb"-?\d+(\.\d+)?", number) else "0"
            changes += [(start, end, line * rng.choice([0, 2])), (first, last, rng.choice([b"", some(rb"[^,\n]+")[2]]))]
            changes += [(begin, stop, text.encode()) for text in [near, near, near, rng.choice(EXTREMES + OTHERS)]]
        start, end, new = rng.choice(changes)
        data = data[:start] + new + data[end:]
    if binary and rng.random() < 0.7:  # a chunk's checksum is optional: without it, damage gets past the check
        data, at = bytearray(data), 8
        while at + 37 < len(data):
            data[at + 33 : at + 37] = bytes(4) if data[at] == 6 else data[at + 33 : at + 37]
            at += 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    return bytes(data)


def kill(pid):
    with suppress(ProcessLookupError):
        os.kill(pid, 9)


def run(kind, folder, words, rows=os.devnull, failure=None):
    """Runs the program in a folder and counts the outcome; whether it answered."""
    with open(folder / "out", "wb") as out, open(folder / "err", "wb") as err, open(folder / rows, "rb") as stdin:
        child = subprocess.Popen([options.program, *words.split()], stdin=stdin, stdout=out, stderr=err, cwd=folder)
    resource.prlimit(child.pid, resource.RLIMIT_CPU, (CPU, CPU + 5))
    timer = threading.Timer(20 * CPU, kill, (child.pid,))
    timer.start()
    _, status, usage = os.wait4(child.pid, 0)
    timer.cancel()
    code = child.returncode = os.waitstatus_to_exitcode(status)
    text, estimates = (folder / "err").read_text(errors="replace"), [*folder.glob("e*/*.csv")]
    found = code == 1 and " check" in kind and re.search("problems?, .* warnings?$", (folder / "out").read_text())
    if code == 101 or "panicked" in text or "broke an invariant" in text:
        failure = "panic"
    elif code < 0:
        failure = f"over {CPU} s" if -code in (9, 24) else f"signal {-code}"
    elif code not in (0, 3) and not found and (code not in (1, 2) or not re.search("^error", text, re.M)):
        failure = f"exit {code}"
    elif usage.ru_maxrss > MEMORY * 1000:
        failure = f"over {MEMORY} MB"
    elif any(re.search("nan|inf", file.read_text(), re.I) for file in estimates):
        failure = "not finite"
    elif len({file.read_bytes() for file in estimates if file.name == "estimate.csv"}) > 1:
        failure = "depends on threads"
    with lock:
        row = counts[kind]
        row["failed" if failure else "answered" if found or code in (0, 3) else "refused"] += 1
        row["cpu"] = max(row["cpu"], usage.ru_utime + usage.ru_stime)
        row["memory"] = max(row["memory"], usage.ru_maxrss)
    if failure:
        kept = options.keep / f"{re.sub('[^a-z]+', '-', kind)}-{folder.name}"
        shutil.copytree(folder, kept, dirs_exist_ok=True)
        (kept / "command").write_text(f"stickslip {words}\n{failure}\n")
        print(f"{kept}: {failure}: stickslip {words}", flush=True)
    return code in (0, 3)


def scenes(rng, folder):
    case = folder.name
    text, physics = scene(rng)
    (folder / "scene.toml").write_text(text)
    rate = rng.choice([30, 30, 30, 10, 60, 200])
    if not run("simulate", folder, f"simulate scene.toml --out s --physics {physics} --rate {rate} --seed {case}"):
        return
    half, particles = (folder / "s/log.csv").read_bytes().count(b"\n") // 2, rng.choice([50, 50, 50, 1, 2, 500])
    words = f"filter s --occlude {half} --seed {case} --particles {particles} {rng.choice(OPTIONS)}"
    if int(case) % 5:
        run("filter", folder, f"{words} --out e --method {rng.choice(METHODS)}")
        return
    for n in (1, 2, 3, 4):
        run("filter, 1 to 4 threads", folder, f"{words} --threads {n} --out e{n}")


def experiments(folder):
    """Eight experiments with all files that are damaged."""
    found, case = [], 0
    while len(found) < 8:
        case, base = case + 1, folder / f"base{case}"
        base.mkdir()
        text, physics = scene(random.Random(f"base {case}"))
        (base / "scene.toml").write_text(text)
        if not run("experiment", base, f"simulate scene.toml --out . --physics {physics}"):
            continue
        names, *table = [line.split(",") for line in (base / "log.csv").read_text().splitlines()]
        more = {"object_var_x": 1e-6, "object_var_y": 1e-6, "object_var_theta": 1e-4, "object_cov_x_y": 0}
        more |= {"object_cov_x_theta": 1e-7, "object_cov_y_theta": 0, "pusher_force_x": 0.5, "pusher_force_y": -0.1}
        rows = [dict(zip(names, map(float, cells))) | (more if case % 2 else {}) for cells in table[:60]]
        (base / "rows.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        (base / "log.csv").write_text("".join(",".join(map(str, r)) + "\n" for r in [rows[0], *map(dict.values, rows)]))
        (base / "bag").mkdir()
        (base / "bag/metadata.yaml").write_text(BAG)
        (base / "camera_info.yaml").write_text(LENS)
        run("experiment", base, "live scene.toml --particles 1 --record bag/push_0.mcap", "rows.jsonl")
        found += [base] if run("experiment", base, "filter log.csv --particles 20") else []
    run("experiment", found[0], "render . --out ../camera --board-frames 4")
    return found


def files(rng, folder, bases):
    name, base = rng.choice(FILES), rng.choice(bases)
    shutil.copytree(base, folder, dirs_exist_ok=True)
    path, log = folder / name, rng.choice(["bag", name]) if "mcap" in name else "bag" if "bag" in name else "log.csv"
    path.write_bytes(damaged(rng, path.read_bytes(), name.endswith("mcap")))
    few = f"--particles 20 {rng.choice(['', '--occlude 5', '--force', '--model paper', '--substeps 3'])}"
    commands = [f"check {log} scene.toml", f"filter {log} scene.toml --out e {few}"]
    if name == "camera_info.yaml":
        commands = [f"calibrate ../camera/board --board ../camera/board.toml --lens {name}"]
    elif name == "rows.jsonl":
        commands = ["live scene.toml --particles 20 --record new.mcap"]
    elif name == "truth.json":
        commands = [f"simulate scene.toml --truth {name} --physics model --out s", "compare . --particles 20"]
    for words in ([f"info {log}"] if "bag" in name else []) + commands:
        run(f"{path.name} {words.split()[0]}", folder, words, path if name == "rows.jsonl" else os.devnull)


def main():
    with tempfile.TemporaryDirectory() as top, ThreadPoolExecutor(options.jobs) as pool:
        more = [experiments(Path(top))] if options.kind == "files" else []

        def one(case):
            folder = Path(top) / str(case)
            folder.mkdir()
            globals()[options.kind](random.Random(case), folder, *more)
            shutil.rmtree(folder)

        for done, _ in enumerate(pool.map(one, range(options.first, options.last)), 1):
            print(f"{done} cases", flush=True) if done % 500 == 0 else None
    print(f"{'run':28}{'runs':>7}{'answered':>10}{'refused':>9}{'failed':>8}{'CPU, s':>8}{'MB':>6}")
    for kind, row in sorted(counts.items()):
        runs = [row[verdict] for verdict in ("answered", "refused", "failed")]
        print(f"{kind:28}{sum(runs):7}{runs[0]:10}{runs[1]:9}{runs[2]:8}{row['cpu']:8.2f}{row['memory'] / 1000:6.0f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("kind", choices=["scenes", "files"])
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("--program", type=lambda path: Path(path).absolute(), default="target/release/stickslip")
    parser.add_argument("--keep", type=Path, default=Path("fuzz-failures"))
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    main()
