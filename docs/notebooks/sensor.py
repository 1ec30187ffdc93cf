# %% [markdown]
# # Write your own sensor model
#
# A light barrier crosses the table. It measures one bit: whether the object interrupts it. A
# particle filter over rollouts with this sensor has about thirty lines. It moves the particles,
# weights them and resamples them.

# %%
import matplotlib.pyplot as plt
import numpy as np

import stickslip
from stickslip import plan

scene = stickslip.Scene("""
gravity = 9.81
[object]
mass = 0.5
inertia = 2.1e-4
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.28
tripod_radius = 0.02
[pusher]
friction = 0.30
shape = [ { disc = { radius = 0.005 } } ]
[fixels]
friction = 0.25
""")
h, steps = 1 / 30, 90
pusher = np.column_stack([-0.037 + 0.02 * h * np.arange(steps + 1), np.full(steps + 1, 0.012), np.zeros(steps + 1)])

# %% [markdown]
# The truth has a friction that the filter does not know. Two barriers at y = -0.035 m and
# y = -0.045 m give a reading at every row. One reading in fifty is wrong.

# %%
rng = np.random.default_rng(0)
hidden = {"mu_s": 0.24, "mu_p": 0.5, "d_tri": 0.015}
truth = stickslip.rollout(scene, [[0, 0, 0]], pusher, hidden, h=h)["pose"][0]
barriers = np.array([-0.035, -0.045])


def interrupted(pose):
    """Returns True where the disc (radius 30 mm) reaches a barrier: (..., 2)."""
    return np.abs(pose[..., 1:2] - barriers) < 0.03


readings = interrupted(truth) ^ (rng.random((steps + 1, 2)) < 0.02)

# %% [markdown]
# The filter. Each particle has its own pose, twist and friction. The motion model is one call of
# `rollout`.

# %%
N = 2000
friction = plan.prior(scene, N, seed=1)
state = np.zeros((N, 6))
state[:, :3] = rng.normal(0, [5e-4, 5e-4, 5e-3], (N, 3))
weight = np.full(N, 1 / N)
mean, spread = [], []
for step in range(steps):
    # move: one step of contact dynamics
    moved = stickslip.rollout(scene, state, pusher[step : step + 2], friction, h=h)
    state = np.hstack([moved["pose"][:, -1], moved["twist"][:, -1]])
    # weight: the sensor model, the same error rate for both barriers
    agrees = interrupted(state) == readings[step + 1]
    weight *= np.where(agrees, 0.98, 0.02).prod(axis=1)
    weight /= weight.sum()
    # resample when few particles have most of the weight
    if 1 / (weight**2).sum() < N / 2:
        picked = np.searchsorted(np.cumsum(weight), (np.arange(N) + rng.random()) / N).clip(max=N - 1)
        state, weight = state[picked], np.full(N, 1 / N)
        friction = {name: values[picked] for name, values in friction.items()}
        # a little noise separates the copies
        state[:, :3] += rng.normal(0, [2e-4, 2e-4, 2e-3], (N, 3))
    mean.append(weight @ state[:, :3])
    spread.append(np.sqrt(weight @ (state[:, :3] - mean[-1]) ** 2))

# %%
mean, spread = np.array(mean), np.array(spread)
blind = stickslip.rollout(scene, [[0, 0, 0]], pusher, h=h)["pose"][0]
time = h * np.arange(1, steps + 1)
figure, ax = plt.subplots(layout="constrained")
ax.plot(time, 1e3 * truth[1:, 1], "k", label="truth")
ax.plot(time, 1e3 * blind[1:, 1], "--", label="nominal simulation")
ax.plot(time, 1e3 * mean[:, 1], label="with two light barriers")
ax.fill_between(time, 1e3 * (mean - 1.645 * spread)[:, 1], 1e3 * (mean + 1.645 * spread)[:, 1], alpha=0.2)
ax.set(xlabel="time (s)", ylabel="y (mm)")
ax.legend()
plt.show()
error, unaided = np.abs(mean[-1, 1] - truth[-1, 1]), np.abs(blind[-1, 1] - truth[-1, 1])
print(f"y at the end: {1e3 * error:.1f} mm off with the barriers, {1e3 * unaided:.1f} mm off without")
assert error < unaided

# %% [markdown]
# A sensor in Rust goes next to `camera_likelihood.rs` in `crates/estimator/src/particle/`. There it
# runs in vector lanes with the full robust model: docs/method.md, "From the paper to the code", has
# the steps.
