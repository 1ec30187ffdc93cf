"""Figures hold what they are asked to show."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip
from stickslip import plot
from stickslip._outline import outlines


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def estimate(demo, scene):
    return stickslip.filter(demo / "log.csv", scene, particles=50, occlude=200)


def test_outlines_are_the_scene_s():
    scene = stickslip.Scene(
        """
gravity = 9.81
[object]
mass = 0.5
inertia = 2e-4
shape = [{ ellipse = { semi_axes = [0.03, 0.02], centre = [0.01, 0], angle = 1.5707963267948966 } }]
[support]
friction = 0.3
tripod_radius = 0.02
[pusher]
friction = 0.3
shape = [{ disc = { radius = 0.005, centre = [0.0, 0.009] } }]
[fixels]
friction = 0.3
[[fixel]]
position = [0.1, 0.2]
angle = 1.5707963267948966
shape = [{ polygon = [[0, 0], [0.01, 0], [0, 0.02]] }]
"""
    )
    bodies = outlines(scene)
    np.testing.assert_allclose(bodies.fixels[0][0], [[0.1, 0.2], [0.1, 0.21], [0.08, 0.2]], atol=1e-12)
    np.testing.assert_allclose(np.ptp(bodies.object[0], axis=0), [0.04, 0.06], atol=1e-12)
    np.testing.assert_allclose(bodies.object[0].mean(axis=0), [0.01, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.hypot(*(bodies.pusher[0] - [0, 0.009]).T), 0.005)


def test_figures_are_drawn(demo, scene, estimate):
    truth = stickslip.load_truth(demo / "truth.csv")
    axes = plot.errors(estimate, truth)
    curve = axes.lines[0].get_ydata()
    rows = np.searchsorted(truth["time"], estimate["time"])
    away = 1e3 * np.hypot(estimate["x"] - truth["x"][rows], estimate["y"] - truth["y"][rows])
    # times of files are rounded to a microsecond, in which a slipping object moves some 1e-5 mm
    np.testing.assert_allclose(curve, away, atol=2e-5)
    assert len(plot.friction(estimate).lines) == 4
    parts = sum(len(fixel) for fixel in outlines(scene).fixels)
    drawn = plot.poses(estimate, scene, rows=[0, 100], log=demo / "log.csv")
    bodies = outlines(scene)
    assert len(drawn.patches) == parts + 2 * (len(bodies.object) + len(bodies.pusher))
    assert len(plot.scene(scene, object=(0, 0, 0)).patches) == parts + len(bodies.object)
    cloud = stickslip.particles(demo / "log.csv", scene, rows=[20], particles=50)
    assert len(plot.particles(cloud, 20, ("mu_s", "mu_p")).collections[0].get_offsets()) == 50
    drawn.figure.canvas.draw()
