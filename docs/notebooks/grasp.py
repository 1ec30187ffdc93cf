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
def carry_out(path):
    """Closes the jaw along a path on the testbed; returns the forces of both fingers at the end."""
    way = float(np.hypot(*(path[-1, :2] - path[0, :2])))
    start = f"""start = {path[0, 3:].tolist()}
[start]
object = {truth.tolist()}
pusher = {path[0, :3].tolist()}
direction = {path[0, 2]}
speed = [[0.0, 0.02], [{way / 0.02}, 0.02], [{way / 0.02}, 0.0]]
duration = {way / 0.02}
"""
    rig = stickslip.simulate(stickslip.Scene(text + start), friction={"mu_s": 0.25, "mu_p": 0.25}, seed=1).truth
    return rig["force_pusher"][-1], rig["force_1"][-1]


worst = int(np.argmin([end["held"] for end in ends]))
for name, chosen in [("best", best), ("worst", worst)]:
    left, right = carry_out(closings[chosen])
    print(f"{name}: predicted {ends[chosen]['held']:.2f}, fingers press with {left:.1f} and {right:.1f} N")
