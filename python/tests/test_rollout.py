"""Rollouts follow an independent program, whatever the threads, and refuse what cannot be simulated."""

import pickle

import numpy as np
import pytest

import stickslip

H = 1 / 30


@pytest.fixture(scope="module")
def bench(data) -> stickslip.Scene:
    return stickslip.load_scene(data / "bench-scene/scene.toml")


def _push(steps: int = 600) -> np.ndarray:
    """The pusher of the timing scene (steps + 1, 3): at 20 mm/s until 6.6 s, then it stands."""
    time = H * np.minimum(np.arange(steps + 1), 198)
    return np.column_stack([-0.032 + 0.020 * time, np.full(steps + 1, -0.0033), np.zeros(steps + 1)])


def _starts(count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    return rng.uniform(-1, 1, (count, 3)) * [3e-4, 3e-4, 9e-3]


def test_rollout_follows_the_reference_over_600_frames_to_a_micrometre(data, bench):
    reference = np.loadtxt(data / "bench-scene/ref_traj_h.txt")
    result = stickslip.rollout(bench, np.zeros((1, 6)), _push())
    np.testing.assert_allclose(result["pose"][0, 1:], reference[:, 1:4], rtol=0, atol=1e-6)
    assert result["unsolved"].tolist() == [0]


def test_a_trajectory_depends_on_nothing_but_itself(bench):
    starts = _starts(150)
    together = stickslip.rollout(bench, starts, _push(120), {"mu_s": np.linspace(0.2, 0.4, 150)}, threads=1)
    threads = stickslip.rollout(bench, starts, np.repeat(_push(120)[None], 150, axis=0),
                                {"mu_s": np.linspace(0.2, 0.4, 150)}, threads=3)  # fmt: skip
    alone = stickslip.rollout(bench, starts[70:71], _push(120), {"mu_s": np.linspace(0.2, 0.4, 150)[70]})
    for name in ("pose", "twist", "unsolved"):
        np.testing.assert_array_equal(together[name], threads[name])
        np.testing.assert_array_equal(together[name][70], alone[name][0])
    # q+ = q + h v+
    moved = together["pose"][:, :-1] + H * together["twist"][:, 1:]
    np.testing.assert_allclose(moved, together["pose"][:, 1:], rtol=0, atol=1e-15)
    assert np.ptp(together["pose"][:, -1, 0]) > 1e-4


def test_results_are_written_into_the_given_arrays(bench):
    first = stickslip.rollout(bench, _starts(3), _push(20))
    expected = {name: first[name].copy() for name in ("pose", "twist")}
    for name in expected:
        first[name].fill(1)
    again = stickslip.rollout(bench, _starts(3), _push(20), out=first)
    for name, values in expected.items():
        assert again[name] is first[name]
        np.testing.assert_array_equal(again[name], values)
    with pytest.raises(stickslip.Error, match="it must be float64 of this rollout's shape"):
        stickslip.rollout(bench, _starts(4), _push(20), out=first)


def test_a_drive_that_gives_way_stays_behind_where_the_object_stops_it(data):
    text = (data / "bench-scene/scene.toml").read_text().replace("[pusher]", "[pusher]\nstall_force = 20.0")
    walls = "".join(
        f"[[fixel]]\nposition = [0.05, {y}]\nshape = [ {{ disc = {{ radius = 0.005 }} }} ]\n" for y in (0.015, -0.015)
    )
    scene = stickslip.Scene(text[: text.index("[[fixel]]")] + walls)
    push = np.column_stack([np.linspace(-0.032, 0.008, 61), np.zeros((61, 2))])
    blocked = stickslip.rollout(scene, np.zeros((2, 3)), np.stack([push, push + np.array([0, 0.2, 0])]))
    # the square stops after 20 mm, the pusher is told to go 40, of which 2 are to the square
    assert blocked["pusher_lag"][0, 0] == pytest.approx(0.018, abs=1e-3)
    assert blocked["most_pusher_lag"][0] >= blocked["pusher_lag"][0, 0]
    assert blocked["pusher_lag"][1].tolist() == [0, 0] and blocked["unsolved"].tolist() == [0, 0]


def test_arrays_of_any_layout_are_read(bench):
    starts, push = _starts(5), np.repeat(_push(20)[None], 5, axis=0)
    expected = stickslip.rollout(bench, starts, push)
    strided = stickslip.rollout(bench, np.asfortranarray(starts), np.asfortranarray(push))
    lists = stickslip.rollout(bench, starts.tolist(), push.tolist(), {"mu_s": scene_friction(bench)})
    for name in expected:
        np.testing.assert_array_equal(expected[name], strided[name])
        np.testing.assert_array_equal(expected[name], lists[name])


def scene_friction(scene: stickslip.Scene) -> float:
    return scene.friction["mu_s"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"states": np.zeros((2, 5))}, "states has the shape (2, 5)"),
        ({"states": np.zeros(6)}, "states has the shape (6,)"),
        ({"states": [["a", 0, 0]]}, "states holds something that is no number"),
        ({"pusher": np.zeros((3, 10, 3))}, "pusher has the shape (3, 10, 3); it must be (2, T + 1, 3)"),
        ({"pusher": np.zeros((1, 3))}, "with T at least 1"),
        ({"pusher": np.full((2, 10, 3), np.nan)}, "pusher pose 0 of trajectory 0 is not finite"),
        ({"states": [[0, 0, 0], [0, np.inf, 0]]}, "start 0 of trajectory 1 is not finite"),
        ({"friction": {"mu": 0.3}}, "friction has a `mu`; it may have mu_s"),
        ({"friction": {"mu_s": [0.1, 0.2, 0.3]}}, "`mu_s` has the shape (3,)"),
        ({"friction": {"mu_s": -0.1}}, "negative or not finite"),
        ({"friction": {"mu_s": np.nan}}, "negative or not finite"),
        ({"h": 0.0}, "the step is 0 s"),
        ({"h": np.nan}, "the step is NaN s"),
        ({"threads": 0}, "0 threads"),
    ],
)
def test_what_cannot_be_simulated_is_refused(bench, arguments, words):
    given = {"states": np.zeros((2, 3)), "pusher": _push(9), "friction": None} | arguments
    with pytest.raises(stickslip.Error) as refusal:
        stickslip.rollout(bench, **given)
    assert words in str(refusal.value)


def test_the_place_of_a_bad_number_counts_all_trajectories(bench):
    pushers = np.repeat(_push(9)[None], 200, axis=0)
    pushers[131, 4, 2] = np.nan
    with pytest.raises(stickslip.Error, match="pusher pose 4 of trajectory 131 is not finite"):
        stickslip.rollout(bench, _starts(200), pushers)


def test_no_trajectory_is_no_error(bench):
    assert stickslip.rollout(bench, np.zeros((0, 6)), _push(9))["pose"].shape == (0, 10, 3)


def test_scenes_can_be_pickled(bench):
    copy = pickle.loads(pickle.dumps(bench))
    assert (copy.text, copy.name) == (bench.text, bench.name)
    same = [stickslip.rollout(scene, _starts(2), _push(20))["pose"] for scene in (bench, copy)]
    np.testing.assert_array_equal(*same)
