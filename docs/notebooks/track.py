# %% [markdown]
# # Track your log
#
# A disc pushes an L-shaped plate against fixels. The camera turns off before the first touch. Put
# the path of your own folder in `folder`. It needs a `scene.toml` and a `log.csv`
# (docs/guide/formats.md).

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip
from stickslip import plot

here = Path.cwd()
root = next(at for at in [here, *here.parents] if (at / "crates/cli/demo").is_dir())
folder = root / "crates/cli/demo/slide-pent-bar-97012"
scene = stickslip.load_scene(folder / "scene.toml")
log = stickslip.load_log(folder / "log.csv")
print(scene, scene.friction, f"{len(log['time'])} rows, {', '.join(log)}")

# %% [markdown]
# The camera's poses are hidden from the filter from row 200 on. Each array of the estimate has one
# number per row.

# %%
estimate = stickslip.filter(log, scene, occlude=200)
plot.poses(estimate, scene, log=log)
plot.friction(estimate)
plt.show()

# %% [markdown]
# A known truth allows a comparison: the error of the estimate and the standard deviation that the
# filter reports.

# %%
truth = stickslip.load_truth(folder / "truth.csv")
plot.errors(estimate, truth)
plt.show()
scores = stickslip.score(estimate, log, scene, truth=truth, occlude=200)
print({name: round(value, 3) for name, value in scores.items() if name != "pit"})
assert scores["wmse_occluded_mm"] < 5

# %% [markdown]
# Every method on the same log. A second seed shows the effect of random numbers.

# %%
for row in stickslip.compare([folder], seeds=2, occlude=200):
    print(f"{row['variant']:22} seed {row['seed']}: {row['wmse_occluded_mm']:8.3f} mm with the camera off")

# %% [markdown]
# The belief is a set of weighted particles. `samples` draws from it with equal weights, in the
# shape that ArviZ takes.

# %%
cloud = stickslip.particles(log, scene, rows=[199, 300], occlude=200)
figure, (before, dark) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
plot.particles(cloud, 199, ("mu_s", "mu_p"), ax=before).set_title("camera on")
plot.particles(cloud, 300, ("x", "y"), ax=dark).set_title("camera off")
plt.show()
posterior = stickslip.samples(log, scene, rows=[len(log["time"]) - 1], chains=2, occlude=200)
print({name: (values.shape, float(np.median(values))) for name, values in posterior.items()})

# %% [markdown]
# A robot delivers rows one by one.

# %%
tracker = stickslip.Tracker(scene)
for row in list(stickslip.rows(log))[:100]:
    now = tracker.push(**row)
print(f"at {now['time']:.2f} s: x = {1e3 * now['x']:.2f} mm with a standard deviation of {1e3 * now['std_x']:.2f} mm")
