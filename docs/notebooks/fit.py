# %% [markdown]
# # Learn a scene from pushes
#
# Nobody knows friction beforehand; recorded pushes tell it. Here they are simulated, so that there is a truth to
# compare with. With pushes of your own, give their folders: `stickslip.fit("pushes/", [...])`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import stickslip

PLATE = """
gravity = 9.81
object  = {{ mass = 0.5, inertia = 3.3e-4, shape = [{{ polygon = [
    [-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]] }}] }}
support = {{ friction = 0.3, tripod_radius = 0.025 }}
pusher  = {{ friction = 0.3, stall_force = 100.0, shape = [{{ disc = {{ radius = 0.005 }} }}] }}
fixels  = {{ friction = 0.25 }}
camera  = {{ position_std = 3.0e-4, orientation_std = 5.0e-3 }}
start   = {{ object = [0, 0, 0], pusher = [{x}, -0.0285, 0], direction = {direction}, speed = 0.02, duration = 1.5 }}
"""

# %% [markdown]
# Eight pushes against the lower face, at different places and angles. The scene's first guesses are a friction of
# 0.3 at the pusher and a tripod radius of 25 mm; in truth they are 0.5 and 33 mm.

# %%
places = [-0.025, 0.015, -0.01, 0.028, 0.005, -0.018, 0.021, -0.003]
turns = [0.5, -0.6, 0.3, -0.4, 0.0, 0.6, 0.2, -0.2]
truth = {"mu_p": 0.5, "d_tri": 0.033}
pushes = [
    stickslip.simulate(
        stickslip.Scene(PLATE.format(x=place, direction=np.pi / 2 + turn)), physics="model", seed=seed, friction=truth
    )
    for seed, (place, turn) in enumerate(zip(places, turns, strict=True))
]

# %%
fit = stickslip.fit(pushes, ["mu_p", "tripod_radius", "mu_f"])
for name in fit.names:
    said = "" if fit.determined[name] else ", not determined by these pushes"
    print(
        f"{name}: {fit.prior_values[name]:.4f} +- {fit.prior_stds[name]:.4f} before, "
        f"{fit.values[name]:.4f} +- {fit.stds[name]:.4f} after{said}"
    )

# %% [markdown]
# No push touches a fixel, so the friction of fixels keeps its first guess, and the fit says so.

# %%
known = {"mu_p": truth["mu_p"], "tripod_radius": truth["d_tri"]}
for name, true in known.items():
    assert fit.determined[name]
    assert abs(fit.values[name] - true) < 4 * fit.stds[name] < 0.3 * true
assert not fit.determined["mu_f"]

# %% [markdown]
# Draws of the posterior are arrays; the k-th values belong together.

# %%
figure, ax = plt.subplots(layout="constrained")
ax.plot(fit.draws["mu_p"], 1e3 * fit.draws["tripod_radius"], ".", markersize=3, label="posterior")
ax.plot(fit.prior_values["mu_p"], 1e3 * fit.prior_values["tripod_radius"], "s", label="first guess")
ax.plot(truth["mu_p"], 1e3 * truth["d_tri"], "r+", markersize=12, label="truth")
ax.set(xlabel="friction at the pusher", ylabel="tripod radius (mm)")
ax.legend()
plt.show()

# %% [markdown]
# Each push was also predicted by a fit to others, from its first pose and the pusher's way alone. That says whether
# fitting buys anything.

# %%
validation = fit.cross_validation
unfitted, fitted = validation["median_final_mm"]
print(
    f"final position of {len(validation['pushes'])} pushes left out: {unfitted:.2f} mm off with the first guesses, "
    f"{fitted:.2f} mm with what the others taught; 90 % intervals hold {validation['coverage_90']:.0%}"
)
assert fitted < 0.6 * unfitted

# %% [markdown]
# `fit.scene` is a scene like any other: filter with it, plan with it, or save it.

# %%
print("\n".join(line for line in fit.scene.text.splitlines() if "friction" in line or line.startswith("#")))
