# %% [markdown]
# # Plan a push
#
# The simulator computes ten thousand pushes per second, enough to try all candidates. Three
# questions follow: which push brings the object nearest to a goal, which may jam, and which is most
# informative about friction?

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import stickslip
from stickslip import plan, plot

scene = stickslip.Scene("""
gravity = 9.81
[object]
mass = 0.5
inertia = 2.1e-4
shape = [ { polygon = [[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]] } ]
[support]
friction = 0.28
tripod_radius = 0.02
[pusher]
friction = 0.30
stall_force = 20.0
shape = [ { disc = { radius = 0.005 } } ]
[fixels]
friction = 0.25
[[fixel]]
position = [0.10, 0.018]
shape = [ { disc = { radius = 0.005 } } ]
[camera]
position_std = 3e-4
orientation_std = 5e-3
""")
here, goal = (0.0, 0.0, 0.0), (0.035, -0.010, -0.3)

# %% [markdown]
# Candidates are 500 straight pushes from all sides. Each is simulated under 20 frictions from the
# scene's prior.

# %%
pushes = plan.straight_pushes(scene, here, 500, length=0.05)
frictions = plan.prior(scene, 20)
began = time.perf_counter()
outcome = plan.predict(scene, here, pushes, frictions)
seconds = time.perf_counter() - began
print(f"{outcome.jammed.size} pushes of {pushes.shape[1] - 1} steps in {seconds:.2f} s")

# %%
best = outcome.nearest(goal, jam_below=0.05)
ax = plot.scene(scene, object=here, pusher=pushes[best, 0])
ax.plot(*pushes[best, :, :2].T, color="black", linewidth=1)
for end in outcome.pose[best]:
    plot.scene(scene, object=end, ax=ax)
ax.plot(*goal[:2], "r+")
plt.show()
distance = outcome.distance(goal)
print(
    f"push {best}: {1e3 * distance[best]:.1f} mm from the goal, root mean square; "
    f"it jams with {outcome.jam_probability[best]:.0%}"
)
assert distance[best] < np.median(distance)

# %% [markdown]
# The most informative push is one whose end depends on friction by more than the camera's noise.

# %%
information = outcome.information(position_std=3e-4, orientation_std=5e-3)
teacher = int(information.argmax())
print(
    f"push {teacher} gives {information[teacher]:.1f} nats of information about friction, "
    f"the median push {np.median(information):.1f}"
)

# %% [markdown]
# Execute this push (the notebook simulates it with a hidden friction). Measure the pose once. Keep
# the frictions that explain the measurement. Then plan again with the same pushes and less
# uncertainty.

# %%
rng = np.random.default_rng(3)
hidden = {name: values[0] for name, values in plan.prior(scene, 1, seed=11).items()}
end = plan.predict(scene, here, pushes[teacher : teacher + 1], {name: [value] for name, value in hidden.items()})
noise = np.array([3e-4, 3e-4, 5e-3])
seen = end.pose[0, 0] + noise * rng.standard_normal(3)

many = plan.prior(scene, 5000, seed=1)
trial = plan.predict(scene, here, pushes[teacher : teacher + 1], many)
log_weight = -0.5 * (((trial.pose[0] - seen) / noise) ** 2).sum(axis=1)
weight = np.exp(log_weight - log_weight.max())
kept = rng.choice(len(weight), size=40, p=weight / weight.sum())
posterior = {name: values[kept] for name, values in many.items()}
for name, values in posterior.items():
    print(
        f"{name}: true {hidden[name]:.3f}, prior {many[name].mean():.3f} +- {many[name].std():.3f}, "
        f"now {values.mean():.3f} +- {values.std():.3f}"
    )

# %%
again = plan.predict(scene, here, pushes, posterior)
best = again.nearest(goal, jam_below=0.05)
true_end = plan.predict(scene, here, pushes[best : best + 1], {name: [value] for name, value in hidden.items()})
print(f"push {best} ends {1e3 * true_end.distance(goal)[0]:.1f} mm from the goal under the true friction")
