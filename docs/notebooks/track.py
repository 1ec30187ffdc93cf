# %% [markdown]
# # Track your log
#
# A disc pushes an L-shaped plate against fixed bodies, and the camera goes dark before the first touch. Put the
# path of your own folder in `folder`; it needs a `scene.toml` and a `log.csv` (docs/guide/formats.md).

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip
from stickslip import plot

here = Path.cwd()
root = next(at for at in [here, *here.parents] if (at / "crates/cli/demo").is_dir())
folder = root / "crates/cli/demo/slide-ell-disc-110"
scene = stickslip.load_scene(folder / "scene.toml")
log = stickslip.load_log(folder / "log.csv")
print(scene, scene.friction, f"{len(log['time'])} rows, {', '.join(log)}")

# %% [markdown]
# From row 200 on the camera's poses are hidden from the filter. What comes back has one number per row.

# %%
estimate = stickslip.filter(log, scene, occlude=200)
plot.poses(estimate, scene, log=log)
plot.friction(estimate)
plt.show()

# %% [markdown]
# Where there is a truth, the distance from it can be set against what the filter believes of itself.

# %%
truth = stickslip.load_truth(folder / "truth.csv")
plot.errors(estimate, truth)
plt.show()
scores = stickslip.score(estimate, log, scene, truth=truth, occlude=200)
print({name: round(value, 3) for name, value in scores.items()})
assert scores["wmse_occluded_mm"] < 5

# %% [markdown]
# Every method on the same log, and another seed: what chance does.

# %%
for row in stickslip.compare([folder], seeds=2, occlude=200):
    print(f"{row['variant']:22} seed {row['seed']}: {row['wmse_occluded_mm']:8.3f} mm while dark")

# %% [markdown]
# The belief is a cloud of particles. `samples` draws from it with equal weights, in the shape that ArviZ takes.

# %%
cloud = stickslip.particles(log, scene, rows=[199, 300], occlude=200)
figure, (before, dark) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
plot.particles(cloud, 199, ("mu_s", "mu_p"), ax=before).set_title("the camera sees")
plot.particles(cloud, 300, ("x", "y"), ax=dark).set_title("it is dark")
plt.show()
posterior = stickslip.samples(log, scene, rows=[len(log["time"]) - 1], chains=2, occlude=200)
print({name: (values.shape, float(np.median(values))) for name, values in posterior.items()})

# %% [markdown]
# On a robot, rows come one by one.

# %%
tracker = stickslip.Tracker(scene)
for row in list(stickslip.rows(log))[:100]:
    now = tracker.push(**row)
print(f"at {now['time']:.2f} s: x = {1e3 * now['x']:.2f} mm with a standard deviation of {1e3 * now['std_x']:.2f} mm")
