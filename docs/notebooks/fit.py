# %% [markdown]
# # Learn a scene from pushes
#
# Friction is unknown in advance. Recorded pushes contain it. The pushes of this notebook are
# simulated, so the true values are known. Give the folder of your own pushes instead:
# `stickslip.fit("pushes/", [...])`.

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
# Eight pushes against the lower face, at different places and angles.
#
# | parameter | nominal value in the scene | truth |
# | --- | --- | --- |
# | friction at the pusher | 0.3 | 0.5 |
# | tripod radius | 25 mm | 33 mm |

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
    said = "" if fit.determined[name] else ", not identifiable from these pushes"
    print(
        f"{name}: nominal {fit.prior_values[name]:.4f} +- {fit.prior_stds[name]:.4f}, "
        f"{fit.values[name]:.4f} +- {fit.stds[name]:.4f} fitted{said}"
    )

# %% [markdown]
# No push touches a fixel. The friction at fixels therefore stays about its nominal value, and the
# fit reports it as not identifiable.

# %%
known = {"mu_p": truth["mu_p"], "tripod_radius": truth["d_tri"]}
for name, true in known.items():
    assert fit.determined[name]
    assert abs(fit.values[name] - true) < 4 * fit.stds[name] < 0.3 * true
assert not fit.determined["mu_f"]

# %% [markdown]
# Posterior draws are arrays, one per parameter. The k-th values of all arrays are one draw.

# %%
figure, ax = plt.subplots(layout="constrained")
ax.plot(fit.draws["mu_p"], 1e3 * fit.draws["tripod_radius"], ".", markersize=3, label="posterior")
ax.plot(fit.prior_values["mu_p"], 1e3 * fit.prior_values["tripod_radius"], "s", label="nominal")
ax.plot(truth["mu_p"], 1e3 * truth["d_tri"], "r+", markersize=12, label="truth")
ax.set(xlabel="friction at the pusher", ylabel="tripod radius (mm)")
ax.legend()
plt.show()

# %% [markdown]
# Cross-validation predicts each push by a fit to other pushes. The prediction uses the first pose
# and the pusher's path only. It shows whether fitting improves predictions.

# %%
validation = fit.cross_validation
unfitted, fitted = validation["median_final_mm"]
print(
    f"final position of {len(validation['pushes'])} pushes left out: {unfitted:.2f} mm off with nominal values, "
    f"{fitted:.2f} mm with a fit to the others; 90 % intervals cover {validation['coverage_90']:.0%}"
)
assert fitted < 0.6 * unfitted

# %% [markdown]
# `fit.scene` is a scene like any other. Filter with it, plan with it, or save it.

# %%
print("\n".join(line for line in fit.scene.text.splitlines() if "friction" in line or line.startswith("#")))
