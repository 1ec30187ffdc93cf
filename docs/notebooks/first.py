# %% [markdown]
# # Ten lines
#
# A folder with `scene.toml` and `log.csv` is all that is needed. Put the path of your own folder in
# `push`.

# %%
from pathlib import Path

import stickslip

root = next(at for at in [Path.cwd(), *Path.cwd().parents] if (at / "crates/cli/demo").is_dir())
push = root / "crates/cli/demo/slide-pent-bar-97012"

# %% [markdown]
# An estimate plays itself back.

# %%
estimate = stickslip.filter(push / "log.csv", push / "scene.toml", occlude=200)
estimate.player()

# %%
print(estimate.observed, estimate.warnings)

# %% [markdown]
# The report adds particles, scores and figures. `.save("page.html")` writes it to a file.

# %%
stickslip.report(push, occlude=200)

# %% [markdown]
# Every method on both experiments of the demo.

# %%
stickslip.compare([push.parent])

# %% [markdown]
# Friction at the pusher, learnt from three short simulated pushes.

# %%
scene = stickslip.load_scene(push.parent / "turn-square-disc/scene.toml").replace(start={"duration": 4.5})
fit = stickslip.fit([stickslip.simulate(scene, seed=seed) for seed in range(3)], ["mu_p"], folds=0)
print(fit.values, fit.stds, fit.determined)
