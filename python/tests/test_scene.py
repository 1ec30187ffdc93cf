"""Scenes of numbers are those of files."""

import numpy as np
import pytest

import stickslip

CORNERS = np.array([[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]])
TABLES = {
    "gravity": 9.81,
    "object": {"mass": np.float32(0.5), "inertia": 3.3e-4, "shape": [{"polygon": CORNERS}]},
    "support": {"friction": 0.3, "tripod_radius": 0.025},
    "pusher": {"friction": 0.3, "stall_force": np.inf, "shape": [{"disc": {"radius": 0.005}}]},
    "fixels": {"friction": 0.25},
    "fixel": [{"position": (0.1, 0.0), "shape": [{"disc": {"radius": 0.01}}]}, {"position": [0.1, 0.1], "shape": [
        {"disc": {"radius": np.float64(0.01)}}]}],
    "camera": {"position_std": 3e-4, "orientation_std": 5e-3},
}  # fmt: skip


def test_from_numbers_is_the_scene_of_its_text():
    scene = stickslip.Scene.from_numbers(**TABLES)
    assert scene.friction == {"mu_s": 0.3, "mu_p": 0.3, "mu_f": 0.25, "d_tri": 0.025} and scene.fixels == 2
    assert scene.name == "scene.toml" and "[object]\nmass = 0.5\n" in scene.text and "[[fixel]]" in scene.text
    again = stickslip.Scene(scene.text)
    push = np.linspace([-0.06, 0, 0], [0.0, 0, 0], 61)
    first, second = (stickslip.rollout(one, np.zeros((1, 3)), push)["pose"] for one in (scene, again))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"gravity": 0}, "gravity is 0 m/s^2; it must be positive"),
        ({"object": {"mass": 0.5}}, "`object.shape` is missing"),
        ({"camera": {"postion_std": 1e-3}}, "the nearest one is `position_std`"),
        ({"fixel": [{"position": [0.1]}]}, "a list of 1; it must be a list of 2"),
        ({"support": {"friction": None}}, "`support` is missing"),
        ({"gravity": np.nan}, "gravity is nan"),
        ({"gravity": object}, "gravity is <class 'object'>; a scene has numbers, texts, lists and tables"),
        ({"gravity": 10**30}, "too large"),
    ],
)
def test_from_numbers_has_the_errors_of_the_reader(changes, words):
    with pytest.raises(stickslip.Error) as refusal:
        stickslip.Scene.from_numbers(**(TABLES | changes))
    assert words in str(refusal.value)


def test_replace_changes_values_and_keeps_the_rest_of_the_text(demo, scene):
    other = scene.replace(mu_p=0.123456789, camera={"latency": 0.02}, **{"pusher.stall_force": 20})
    assert other.friction == scene.friction | {"mu_p": 0.123456789}
    assert "latency = 0.02" in other.text and "stall_force = 20\n" in other.text and other.name == scene.name
    back = other.replace(mu_p=scene.friction["mu_p"])
    lines = set(scene.text.splitlines()) - set(back.text.splitlines())
    assert lines == {"friction = 0.30", "stall_force = 20.688"}  # the same number, and another one
    assert scene.replace().text == scene.text == (demo / "scene.toml").read_text()
    without = other.replace(camera={"latency": None})
    assert "latency" not in without.text


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mu_p": -1}, "pusher.friction is -1; it must be"),
        ({"mu_q": 0.3}, "`mu_q` is not a known key"),
        ({"camera.latncy": 0.1}, "the nearest one is `latency`"),
        ({"gravity.x": 1}, "`gravity.x` names no value of a scene"),
        ({"a.b.c": 1}, "`a.b.c` names no value of a scene"),
    ],
)
def test_replace_has_the_errors_of_the_reader(scene, values, words):
    with pytest.raises(stickslip.Error) as refusal:
        scene.replace(**values)
    assert words in str(refusal.value)
