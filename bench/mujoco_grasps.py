"""Grasps in MuJoCo: 3-D physics, an object on twelve irregular feet, soft contacts, steps of 0.25 ms.

    python3 bench/mujoco_grasps.py FIRST LAST OUT [--force] [--pusher-hz 240] [--drive 10] [--hide-pusher]
    python3 bench/mujoco_grasps.py FIRST LAST OUT --jaw [--force]

Needs `pip install mujoco numpy`; a grasp takes about 5 s. Each seed from FIRST to LAST - 1 gives a folder (scene.toml,
log.csv, truth.csv, truth.json). Left out are seeds whose object touches no fixel, touches one before the pusher, or
within 40 camera frames. The published sets are from MuJoCo 4.0.0; another version may change the motions.

A pusher on a rail along x pushes the object into three disc fixels. Its drive has a limited force and a ripple of
3 %. scene.toml has exact mass, inertia and shapes; friction and support tripod are guesses. All numbers are SI, in the
world frame W if nothing else is said.

With `--jaw` there are no fixels. Two fingers on one spindle close along x about an object that is off their middle. The
spindle's force is limited: the forces on both fingers add up to it. Left out are seeds whose object touches no finger.

- log.csv: camera noise 0.3 mm and 0.3 degrees, pusher noise 0.1 mm, 2 % repeated rows; touch means more than 0.05 N
- forces: means over the interval before a row; at 30 Hz its 133 steps (33.25 ms) count as 1/30 s; at 240 Hz 17 steps
  (4.25 ms) as 1/240 s
- `--force`: adds the pusher's force on the object, of a jaw that of both fingers together, to the log, with noise of
  0.03 N and a bias of 0.05 N (one sigma) per axis, and the table [wrench] to the scene
- `--pusher-hz HZ`: rows at HZ, a multiple of 30, with a camera pose in every (HZ / 30)th; above 30 no row is repeated
- `--drive FACTOR`: multiplies the stall force of the drive
- `--hide-pusher`: no pusher poses for 0.4 s, from 0.1 s after the first touch of a fixel
"""

import argparse
import io
import json
import math
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np

GRAVITY = 9.81
TIME_STEP = 0.00025  # s
CAMERA_HZ, SECONDS = 30, 20
FEET = 12
HEIGHT = 0.012  # of the object, m
START = -0.03  # x of the object, m
PUSHER_RADIUS = 0.005  # m
BAR = 0.004  # half the thickness of a bar as pusher, m
CAMERA_STD = np.array([3e-4, 3e-4, math.radians(0.3)])
PUSHER_STD = 1e-4  # m
TOUCH = 0.05  # N
FORCE_STD, FORCE_BIAS = 0.03, 0.05  # N
TRUTH = "time,x,y,theta,vx,vy,omega,pusher_x,pusher_y,force_pusher,force_1,force_2,force_3"
LOG = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,tactile_1,tactile_2,tactile_3"
JAW_SECONDS = 8
JAW_TRUTH = "time,x,y,theta,vx,vy,omega,pusher_x,pusher_y,force_pusher,force_1"
JAW_LOG = (
    "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,finger_1_x,finger_1_y,finger_1_theta"
    ",tactile_1,tactile_2"
)
FORCE = ",pusher_force_x,pusher_force_y"


def regular(corners, phase=0.0):
    """A regular polygon with a circumradius of 30 mm."""
    angles = np.arange(corners) * 2 * math.pi / corners + phase
    return [[0.03 * math.cos(angle), 0.03 * math.sin(angle)] for angle in angles]


def box(left, bottom, right, top):
    """Corners of an upright rectangle."""
    return [[left, bottom], [right, bottom], [right, top], [left, top]]


# convex parts (m), counter-clockwise
SHAPES = {
    "square50": [box(-0.025, -0.025, 0.025, 0.025)],
    "rect70x40": [box(-0.035, -0.02, 0.035, 0.02)],
    "hex30": [regular(6)],
    "tri": [[[-0.03, -0.03], [0.04, -0.02], [-0.01, 0.04]]],
    "trapezoid": [[[-0.04, -0.025], [0.04, -0.025], [0.02, 0.025], [-0.02, 0.025]]],
    "ell": [box(-0.03, -0.03, 0.03, -0.005), box(-0.03, -0.005, -0.005, 0.03)],
    "pent": [regular(5, 0.3)],
}


def moments(part):
    """Area, centroid, and second moment of area about the centroid, of a polygon (k, 2)."""
    x, y = part.T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    area = cross.sum() / 2
    centroid = np.array([((x + x1) * cross).sum() / (6 * area), ((y + y1) * cross).sum() / (6 * area)])
    second = ((x * x + x * x1 + x1 * x1 + y * y + y * y1 + y1 * y1) * cross).sum() / 12
    return area, centroid, second - area * (centroid @ centroid)


def about_centre_of_mass(parts):
    """Parts in O, and the inertia over the mass (m^2)."""
    parts = [np.array(part) for part in parts]
    each = [moments(part) for part in parts]
    area = sum(a for a, _, _ in each)
    centre = sum(a * c for a, c, _ in each) / area
    second = sum(s + a * ((c - centre) @ (c - centre)) for a, c, s in each)
    return [part - centre for part in parts], second / area


def draw_fixels(draw, radius):
    """Centres of three fixels ahead of an object of this radius, and their own radius."""
    gap = draw.uniform(0.3, 0.75) * radius
    x = draw.uniform(0.05, 0.08)
    own = draw.choice([0.004, 0.005, 0.0065])
    first = [x, 0.6 * gap + draw.uniform(-0.004, 0.004)]
    second = [x + draw.uniform(-0.01, 0.01), -gap + draw.uniform(-0.004, 0.004)]
    third = [x - draw.uniform(0.0, 0.03), draw.choice([-1, 1]) * (radius * draw.uniform(0.9, 1.15) + 0.006)]
    return [first, second, third], own


def draw_feet(draw, parts, radius):
    """Feet in O, at least 1 mm inside a part."""

    def inside(part, foot):
        edges, arms = np.roll(part, -1, axis=0) - part, foot - part
        cross = edges[:, 0] * arms[:, 1] - edges[:, 1] * arms[:, 0]
        return (cross >= 1e-3 * np.hypot(*edges.T)).all()

    feet = []
    while len(feet) < FEET:
        foot = draw.uniform(-1, 1, 2) * radius
        if any(inside(part, foot) for part in parts):
            feet.append(foot)
    return feet


def draw_object(draw, seed):
    """Draws shape, pusher and friction of an experiment; `parts` are in O."""
    grasp = SimpleNamespace(shape=list(SHAPES)[seed % len(SHAPES)])
    grasp.pusher = "disc" if np.random.default_rng(1000 + seed).random() < 0.5 else "bar"
    grasp.parts, inertia_per_mass = about_centre_of_mass(SHAPES[grasp.shape])
    corners = np.concatenate(grasp.parts)
    grasp.radius = np.hypot(*corners.T).max()
    grasp.mass = draw.uniform(0.2, 0.8)
    grasp.inertia = grasp.mass * inertia_per_mass
    grasp.mu_s, grasp.mu_p, grasp.mu_f = draw.uniform(0.15, 0.4), draw.uniform(0.15, 0.5), draw.uniform(0.1, 0.4)
    return grasp, corners


def draw_jaw(draw, seed):
    """Draws an experiment with two fingers; `parts` and `feet` are in O."""
    grasp, corners = draw_object(draw, seed)
    grasp.fixels, grasp.fixel_radius = [], 0.0
    grasp.angle, grasp.y = draw.uniform(-math.pi, math.pi), 0.0
    grasp.speed = draw.choice([0.008, 0.015, 0.025])
    grasp.feet = draw_feet(draw, grasp.parts, grasp.radius)
    grasp.stall = draw.choice([5.0, 10.0, 20.0]) * grasp.mass * GRAVITY * grasp.mu_s
    lead = PUSHER_RADIUS if grasp.pusher == "disc" else BAR
    reach_x = math.cos(grasp.angle) * corners[:, 0] - math.sin(grasp.angle) * corners[:, 1]
    middle = START + draw.uniform(-0.01, 0.01)
    half = max(middle - START - reach_x.min(), START + reach_x.max() - middle) + lead + draw.uniform(0.005, 0.015)
    y = draw.uniform(-0.35, 0.35) * grasp.radius
    grasp.fingers = [(middle - half, y, 1), (middle + half, y, -1)]
    grasp.travel = half - lead - 0.001  # until the fingers would meet
    return grasp


def draw_grasp(draw, seed, drive):
    """Draws an experiment. The order of the draws fixes the published sets; `parts` and `feet` are in O."""
    grasp, corners = draw_object(draw, seed)
    grasp.fixels, grasp.fixel_radius = draw_fixels(draw, grasp.radius)
    grasp.angle, grasp.y = draw.uniform(-math.pi, math.pi), draw.uniform(-0.004, 0.004)
    grasp.speed = draw.choice([0.012, 0.02, 0.03])
    grasp.feet = draw_feet(draw, grasp.parts, grasp.radius)

    reach_x = math.cos(grasp.angle) * corners[:, 0] - math.sin(grasp.angle) * corners[:, 1]
    lead, share = (PUSHER_RADIUS, 0.25) if grasp.pusher == "disc" else (BAR, 0.3)
    grasp.pusher_y = grasp.y + draw.uniform(-0.35, 0.35) * grasp.radius * share
    grasp.pusher_x = START + reach_x.min() - lead - 0.06 * draw.uniform(0.7, 1.1) - 0.002
    grasp.stall = drive * draw.choice([10.0, 20.0]) * grasp.mass * GRAVITY * grasp.mu_s
    draw.uniform()  # unused
    depth = 2 * min(abs(reach_x).max(), grasp.radius) * draw.uniform(0.35, 0.7)
    grasp.travel = grasp.fixels[0][0] - grasp.fixel_radius - lead - depth - grasp.pusher_x
    grasp.fingers = [(grasp.pusher_x, grasp.pusher_y, 1)]  # x, y, and the sign of its motion along x
    return grasp


def model_text(grasp):
    """The experiment in MuJoCo's XML. The first joints are the fingers' rails, the last one is the free object."""
    rigid = 'contype="2" conaffinity="1" priority="2"'
    meshes, geoms, fixels = "", "", ""
    for k, part in enumerate(grasp.parts):
        vertices = " ".join(f"{x:.6f} {y:.6f} {z:.6f}" for x, y in part for z in (-HEIGHT / 2, HEIGHT / 2))
        meshes += f'<mesh name="part{k}" vertex="{vertices}"/>'
        geoms += f'<geom type="mesh" mesh="part{k}" mass="0" contype="1" conaffinity="2" friction="1 0 0"/>'
    for x, y in grasp.feet:
        place = f'size=".001" pos="{x:.6f} {y:.6f} {-HEIGHT / 2 - 0.001:.6f}"'
        geoms += f'<geom type="sphere" {place} mass="0" contype="4" conaffinity="8"/>'
    for k, (x, y) in enumerate(grasp.fixels, 1):
        cylinder = f'type="cylinder" size="{grasp.fixel_radius} .02" friction="{grasp.mu_f} 0 0"'
        fixels += f'<body pos="{x} {y} .02"><geom name="fixel{k}" {cylinder} {rigid}/></body>'
    solid = f'"cylinder" size="{PUSHER_RADIUS} .02"' if grasp.pusher == "disc" else f'"box" size="{BAR} .02 .02"'
    fingers, spindle = "", ""
    for k, (x, y, sign) in enumerate(grasp.fingers):
        fingers += f"""<body pos="{x} {y} .02"><joint name="rail{k}" type="slide" axis="{sign} 0 0"/>
        <inertial pos="0 0 0" mass="5" diaginertia=".01 .01 .01"/>
        <geom name="finger{k}" type={solid} friction="{grasp.mu_p} 0 0" {rigid}/></body>"""
        if k > 0:
            spindle += f'<joint joint1="rail0" joint2="rail{k}" polycoef="0 1 0 0 0" solref=".002 1"/>'
    turn = f"{math.cos(grasp.angle / 2)} 0 0 {math.sin(grasp.angle / 2)}"
    tilt = grasp.mass * grasp.radius * grasp.radius / 4
    return f"""<mujoco>
    <option timestep="{TIME_STEP}" gravity="0 0 -{GRAVITY}" cone="elliptic" impratio="50" solver="Newton"
      iterations="100" tolerance="1e-12" noslip_iterations="20"/>
    <default><geom solref=".002 1" solimp=".98 .999 .0001"/></default>
    <asset>{meshes}</asset>
    <worldbody>
      <geom type="plane" size="1 1 .1" contype="8" conaffinity="4" friction="{grasp.mu_s} 0 0" priority="2"/>
      {fixels}
      {fingers}
      <body pos="{START} {grasp.y} {HEIGHT / 2 + 0.002}" quat="{turn}"><freejoint/>
        <inertial pos="0 0 0" mass="{grasp.mass}" diaginertia="{tilt} {tilt} {grasp.inertia}"/>{geoms}</body>
    </worldbody>
    <equality>{spindle}</equality>
    <actuator>
      <velocity joint="rail0" kv="2000" ctrlrange="-1 1" forcerange="-{grasp.stall} {grasp.stall}"/>
    </actuator></mujoco>"""


def add_forces(model, data, bodies, fingers, sizes, push):
    """Adds the contact forces (N) of one step.

    `sizes` (n,): of fingers and fixels, along the normal and the first tangent. `push` (2,): of all fingers on the
    object, in W.
    """
    force = np.zeros(6)
    for k in range(data.ncon):
        contact = data.contact[k]
        for geom in (contact.geom1, contact.geom2):
            if geom in bodies:
                mujoco.mj_contactForce(model, data, k, force)
                sizes[bodies[geom]] += np.hypot(force[0], force[1])
                if bodies[geom] < fingers:
                    # rows of `frame` are the contact's axes; the force acts on geom2
                    sign = 1 if geom == contact.geom1 else -1
                    push += sign * (np.array(contact.frame).reshape(3, 3).T @ force[:3])[:2]


def simulate(grasp, rate, seconds):
    """Rows of truth.csv at a rate in Hz, and the mean force of all fingers on the object (n, 2) in W, N.

    Also the way of each finger along x (n, fingers).
    """
    steps = round(1 / rate / TIME_STEP)
    model = mujoco.MjModel.from_xml_string(model_text(grasp))
    data = mujoco.MjData(model)
    names = [f"finger{k}" for k in range(len(grasp.fingers))] + [f"fixel{k + 1}" for k in range(len(grasp.fixels))]
    bodies = {model.geom(name).id: k for k, name in enumerate(names)}
    rails = len(grasp.fingers)
    free = data.qpos[rails:]
    signs = [sign for _, _, sign in grasp.fingers]
    for _ in range(2000):  # the object settles
        mujoco.mj_step(model, data)
    start = data.time
    theta = 2 * math.atan2(free[6], free[3])
    rows, pushes, ways = [], [], []
    for frame in range(seconds * rate + 1):
        sizes, push = np.zeros(len(names)), np.zeros(2)
        if frame > 0:
            travels = data.qpos[0] < grasp.travel
            for _ in range(steps):
                ripple = 1 + 0.03 * math.sin(7 * data.time)
                data.ctrl[0] = grasp.speed * ripple if travels and data.time - start > 0.5 else 0
                mujoco.mj_step(model, data)
                add_forces(model, data, bodies, rails, sizes, push)
        turned = 2 * math.atan2(free[6], free[3])
        theta += (turned - theta + math.pi) % (2 * math.pi) - math.pi
        speed = data.qvel[rails:]
        x, y, sign = grasp.fingers[0]
        place = (x + sign * data.qpos[0], y)
        rows.append([frame / rate, *free[:2], theta, *speed[:2], speed[5], *place, *(sizes / steps)])
        pushes.append(push / steps)
        ways.append(signs * data.qpos[:rails])
    return np.array(rows), np.array(pushes), np.array(ways)


def sense(draw, truth, every):
    """Camera poses (n, 3) in each `every`th row, pusher positions (n, 2) and touch (n, 3) as logged."""
    rows = len(truth)
    camera = truth[:, 1:4] + draw.normal(size=(rows, 3)) * CAMERA_STD
    pusher = truth[:, 7:9] + draw.normal(size=(rows, 2)) * PUSHER_STD
    camera[np.arange(rows) % every > 0] = np.nan
    for k in range(1, rows):
        if every == 1 and draw.random() < 0.02:
            camera[k], pusher[k] = camera[k - 1], pusher[k - 1]
    return camera, pusher, (truth[:, 10:] > TOUCH).astype(int)


def sense_force(push, seed):
    """Forces (n, 2) with a constant bias and noise, N."""
    draw = np.random.default_rng(seed + 777)
    return push + draw.normal(size=2) * FORCE_BIAS + draw.normal(size=push.shape) * FORCE_STD


def with_force(given, seed, push, log):
    """Header, formats and columns of a log; with forces where they are asked for."""
    header, formats, columns = log
    if not given.force:
        return log
    return header + FORCE, [*formats, "%.4f", "%.4f"], [*columns, sense_force(push, seed)]


def scene_text(grasp, force):
    """The text of scene.toml; with the table [wrench] if forces are logged."""

    def polygon(part):
        return "{ polygon = [" + ", ".join(f"[{x:.6f}, {y:.6f}]" for x, y in part) + "] }"

    def disc(radius):
        return f"shape = [ {{ disc = {{ radius = {radius:.6f} }} }} ]"

    bar = "shape = [ { polygon = [[-0.004, -0.02], [0.004, -0.02], [0.004, 0.02], [-0.004, 0.02]] } ]"
    parts = "".join(f"  {polygon(part)},\n" for part in grasp.parts)
    fixel = disc(grasp.fixel_radius)
    fixels = "" if grasp.fixels else f"\n[[finger]]\n{disc(PUSHER_RADIUS) if grasp.pusher == 'disc' else bar}\n"
    fixels += "".join(f"\n[[fixel]]\nposition = [{x:.6f}, {y:.6f}]\n{fixel}\n" for x, y in grasp.fixels)
    wrench = f"\n[wrench]\nforce_std = {FORCE_STD}\n" if force else ""
    return f"""# Nominal values; the truth of the friction parameters is not in this file.
gravity = {GRAVITY}

[object]
mass = {grasp.mass:.6f}
inertia = {grasp.inertia:.9f}
shape = [
{parts}]

[support]
friction = 0.28
tripod_radius = {math.sqrt(grasp.inertia / grasp.mass):.6f}

[pusher]
{disc(PUSHER_RADIUS) if grasp.pusher == "disc" else bar}
friction = 0.30
stall_force = {grasp.stall:.3f}

[fixels]
friction = 0.25
{fixels}
[camera]
position_std = {CAMERA_STD[0]:.6f}
orientation_std = {CAMERA_STD[2]:.6f}
pusher_position_std = {PUSHER_STD}
pusher_orientation_std = 0.0
{wrench}"""


def write(folder, grasp, facts, tables, force=False):
    """Writes an experiment; `tables` has header, formats and columns of truth.csv and of log.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(scene_text(grasp, force))
    (folder / "truth.json").write_text(json.dumps(facts, indent=1))
    for name, (header, formats, columns) in tables.items():
        text = io.StringIO()
        np.savetxt(text, np.column_stack(columns), formats, ",", header=header, comments="")
        (folder / name).write_text(text.getvalue().replace("nan", ""))


def record_jaw(seed, given):
    """Draws, simulates and writes the experiment of one seed with two fingers."""
    draw = np.random.default_rng(seed)
    grasp = draw_jaw(draw, seed)
    truth, push, ways = simulate(grasp, CAMERA_HZ, JAW_SECONDS)
    camera, pusher, _ = sense(draw, truth, 1)
    touches = [int(np.argmax(force > 0.02)) if (force > 0.02).any() else None for force in truth.T[9:]]
    first = min((row for row in touches if row is not None), default=0)
    if first < 10 or not np.isfinite(truth).all():
        return
    held = (truth[-30:, 9:] > 0.02).all()
    facts = {"source": "MuJoCo 4.0.0, 3-D, 12 irregular feet, 0.25 ms, jaw"}
    facts |= {key: getattr(grasp, key) for key in ("shape", "pusher", "mu_s", "mu_p")}
    facts |= {"first_pusher_contact": touches[0], "first_fixel_contacts": touches[1:], "occlude_from": first - 5}
    x, y, _ = grasp.fingers[1]
    finger = np.column_stack([x + ways[:, 1], np.full(len(ways), y)])
    finger = finger + draw.normal(size=finger.shape) * PUSHER_STD
    still = np.zeros(len(truth))
    log = [truth[:, 0], camera, pusher, still, finger, still, (truth[:, 9:] > TOUCH).astype(int)]
    formats = ["%.6f"] * 6 + ["%d", "%.6f", "%.6f"] + ["%d"] * 3
    measured = with_force(given, seed, push, (JAW_LOG, formats, log))
    tables = {"truth.csv": (JAW_TRUTH, "%.7g", [truth]), "log.csv": measured}
    kind = "held" if held else "lost"
    write(given.out / f"{kind}-{grasp.shape}-{grasp.pusher}-{seed}", grasp, facts, tables, given.force)


def record(seed, given):
    """Draws, simulates and writes the experiment of one seed."""
    every = given.pusher_hz // CAMERA_HZ
    draw = np.random.default_rng(seed)
    grasp = draw_grasp(draw, seed, given.drive)
    truth, push, _ = simulate(grasp, given.pusher_hz, SECONDS)
    camera, pusher, touch = sense(draw, truth, every)
    pushed = int(np.argmax(truth[:, 9] > 0.02))
    touches = [int(np.argmax(column)) if column.any() else None for column in touch.T]
    first = min((row for row in touches if row is not None), default=0)
    if first < 40 * every or first <= pushed or not np.isfinite(truth).all():
        return

    moved = truth[-1, 1:4] - truth[first, 1:4]
    kind = "slide" if 1e3 * np.hypot(*moved[:2]) > 3 or abs(np.degrees(moved[2])) > 5 else "stop"
    facts = {"source": "MuJoCo 4.0.0, 3-D, 12 irregular feet, 0.25 ms"}
    facts |= {key: getattr(grasp, key) for key in ("shape", "pusher", "mu_s", "mu_p", "mu_f")}
    facts |= {"first_pusher_contact": pushed, "first_fixel_contacts": touches, "occlude_from": first - 5 * every}
    place = np.column_stack([pusher, np.zeros(len(truth))])
    if given.hide_pusher:
        place[first + 3 * every : first + 15 * every] = np.nan
    log = [truth[:, 0], camera, place, touch]
    formats = ["%.6f"] * 6 + ["%.0f"] + ["%d"] * 3
    measured = with_force(given, seed, push, (LOG, formats, log))
    tables = {"truth.csv": (TRUTH, "%.7g", [truth]), "log.csv": measured}
    write(given.out / f"{kind}-{grasp.shape}-{grasp.pusher}-{seed}", grasp, facts, tables, given.force)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("out", type=Path)
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--pusher-hz", type=int, default=CAMERA_HZ)
    parser.add_argument("--drive", type=float, default=1.0)
    parser.add_argument("--hide-pusher", action="store_true")
    parser.add_argument("--jaw", action="store_true")
    given = parser.parse_args()
    if given.pusher_hz < CAMERA_HZ or given.pusher_hz % CAMERA_HZ:
        parser.error(f"--pusher-hz is {given.pusher_hz}; it must be a multiple of {CAMERA_HZ}, such as 240")
    for seed in range(given.first, given.last):
        if given.jaw:
            record_jaw(seed, given)
        else:
            record(seed, given)


if __name__ == "__main__":
    main()
