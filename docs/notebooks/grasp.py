# %% [markdown]
# # Choose a grasp
#
# A jaw closes around a bar, and its fingers hide the bar from the camera. Each closing of the jaw
# ends in some way. The tracker's particles predict how, before the jaw moves.

# %%
import matplotlib.pyplot as plt
import numpy as np

import stickslip
from stickslip import plan, plot

text = """
gravity = 9.81
object = { mass = 0.4, shape = [ { polygon = [[-0.035, -0.012], [0.035, -0.012], [0.035, 0.012], [-0.035, 0.012]] } ] }
support = { friction = 0.28 }
fixels = { friction = 0.25 }
camera = { position_std = 3e-4, orientation_std = 5e-3, pusher_position_std = 1e-4 }
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.2
stall_force = 15.0
[[finger]]
shape = [ { disc = { radius = 0.005 } } ]
"""
scene = stickslip.Scene(text)
truth = np.array([0.0, 0.0, 0.6])  # only the simulation knows it

# %% [markdown]
# The camera sees the bar for one second, with its noise. The jaw is far away.

# %%
draw = np.random.default_rng(0)
tracker = stickslip.Tracker(scene)
for row in range(30):
    seen = truth + draw.normal(size=3) * [3e-4, 3e-4, 5e-3]
    here = tracker.push(row / 30, object=seen, pusher=(-0.2, 0, 0), fingers=[(0.2, 0, 0)])
pose = [here["x"], here["y"], here["theta"]]

# %% [markdown]
# Candidates: twelve angles, each through the centre and 20 mm to both sides of it.

# %%
angles, offsets = np.linspace(0, np.pi, 12, endpoint=False), [0.0, -0.02, 0.02]
closings = plan.jaw_closings(scene, pose, angles=angles, offsets=offsets)
best, ends = plan.grasp(tracker, closings)
for offset, chances in zip(offsets, np.reshape([end["held"] for end in ends], (3, 12)), strict=True):
    plt.plot(np.degrees(angles), chances, "o-", label=f"{1e3 * offset:.0f} mm")
plt.xlabel("angle of the jaw [deg]")
plt.ylabel("probability of held")
plt.legend(title="offset")
plt.show()

# %%
plot.scene(scene, object=pose, pusher=closings[best, 0])
plt.show()

# %% [markdown]
# Carried out on the testbed, a rig with uneven friction: the best closing, and the worst.


# %%
def carry_out(path, at):
    """Moves the pusher as in a path on the testbed, and the finger against it, about the bar at a pose."""
    way = float(np.hypot(*(path[-1, :2] - path[0, :2])))
    start = f"""start = {path[0, 3:].tolist()}
[start]
object = {list(map(float, at))}
pusher = {path[0, :3].tolist()}
direction = {path[0, 2]}
speed = [[0.0, 0.02], [{way / 0.02}, 0.02], [{way / 0.02}, 0.0]]
duration = {way / 0.02}
"""
    return stickslip.simulate(stickslip.Scene(text + start), friction={"mu_s": 0.25, "mu_p": 0.25}, seed=1)


def forces(path, at):
    """Returns the fingers' forces at the end, as text."""
    rig = carry_out(path, at).truth
    return f"fingers press with {rig['force_pusher'][-1]:.1f} and {rig['force_1'][-1]:.1f} N"


worst = int(np.argmin([end["held"] for end in ends]))
for name, chosen in [("best", best), ("worst", worst)]:
    print(f"{name}: predicted {ends[chosen]['held']:.2f}, {forces(closings[chosen], truth)}")

# %% [markdown]
# ## Open loop and closed loop
#
# The pusher first pushes the bar, out of the camera's sight, and slips off it. Open loop, a
# simulation with the scene's friction predicts where the bar will be. Closed loop, the tracker gets
# the poses of the fingers and their touches meanwhile.

# %%
way = truth[2] - np.pi / 2
ahead, across = np.array([np.cos(way), np.sin(way)]), np.array([-np.sin(way), np.cos(way)])
places = -0.004 * across + np.array([[-0.05], [0.15]]) * ahead
path = np.column_stack([places, [way, way], places + 0.6 * ahead, [way, way]])  # the finger is far away
push = carry_out(path, truth)
hidden = push.facts["occlude_from"]
tracker = stickslip.Tracker(scene)
for row, measured in enumerate(stickslip.rows(push.log)):
    tracker.push(**(measured if row < hidden else {**measured, "object": None}))
last_seen = [push.log[f"object_{name}"][hidden - 1] for name in ("x", "y", "theta")]
fingers = [f"{body}_{name}" for body in ("pusher", "finger_1") for name in ("x", "y", "theta")]
moves = np.column_stack([push.log[name] for name in fingers])[hidden - 1 :]
predicted = stickslip.rollout(scene, [last_seen], moves)["pose"][0, -1]
followed = np.array([tracker.estimate[name] for name in ("x", "y", "theta")])
there = np.array([push.truth[name][-1] for name in ("x", "y", "theta")])
for name, pose in [("open loop", predicted), ("closed loop", followed)]:
    print(f"{name}: off by {1e3 * np.hypot(*(pose - there)[:2]):.1f} mm, {np.degrees(pose - there)[2]:.0f} degrees")

# %% [markdown]
# Open loop closes across the bar as predicted. Closed loop chooses by the tracker's particles. How
# often each holds an object that is harder to grasp: `bench/regrasp.py`.

# %%
closings = plan.jaw_closings(scene, predicted, angles=[predicted[2] + np.pi / 2])
print(f"open loop: {forces(closings[0], there)}")
closings = plan.jaw_closings(scene, followed, angles=angles, offsets=offsets)
best, ends = plan.grasp(tracker, closings)
print(f"closed loop: predicted {ends[best]['held']:.2f}, {forces(closings[best], there)}")
plot.scene(scene, object=there, pusher=closings[best, 0])
plt.show()
