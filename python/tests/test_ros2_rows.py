"""ROS 2 messages become rows of a log, and rows go to a tracker. No ROS is needed."""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

import stickslip
from stickslip_ros import planar
from stickslip_ros.following import Following
from stickslip_ros.rows import Rows
from stickslip_ros.transforms import Transforms


def _stamp(time):
    nanoseconds = round(Fraction(repr(time)) * 10**9)
    return SimpleNamespace(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def _place(x=0.0, y=0.0, yaw=0.0):
    position = SimpleNamespace(x=x, y=y, z=0.3)
    return position, SimpleNamespace(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def _transform(time, x, y, yaw):
    translation, rotation = _place(x, y, yaw)
    return SimpleNamespace(
        header=SimpleNamespace(stamp=_stamp(time)),
        transform=SimpleNamespace(translation=translation, rotation=rotation),
    )


def test_poses_are_laid_into_the_plane():
    for yaw in np.linspace(-3.1, 3.1, 13):
        np.testing.assert_allclose(planar.planar(*_place(1.0, -2.0, yaw)), (1.0, -2.0, yaw), atol=1e-15)
    # 20 degrees over its own y-axis and 90 about z: the x-axis still heads along y
    half, tilt = math.pi / 4, math.radians(10)
    quaternion = SimpleNamespace(
        x=-math.sin(half) * math.sin(tilt),
        y=math.cos(half) * math.sin(tilt),
        z=math.sin(half) * math.cos(tilt),
        w=math.cos(half) * math.cos(tilt),
    )
    assert planar.planar(_place()[0], quaternion)[2] == pytest.approx(math.pi / 2)
    for time in (12.25, 1_700_000_000.3, 0.1):
        assert planar.seconds(_stamp(time)) == time


def test_sources_are_topics_or_frames():
    assert planar.frames("/tf:table.tag_7") == ("table", "tag_7") and planar.frames("/object/pose") is None
    with pytest.raises(ValueError, match=r"/tf:parent\.child"):
        planar.frames("/tf:table")


def test_a_row_waits_for_the_pusher_and_has_it_where_it_was_then():
    rows = Rows(sensors=0, period=0.04)
    rows.object(1.0, (0.1, 0.0, 0.0))
    rows.pusher(0.99, (0.0, 0.0, 3.1))
    assert rows.take() == []
    rows.pusher(1.01, (0.02, -0.04, -3.1))
    [row] = rows.take()
    assert row["time"] == 1.0 and row["object"] == (0.1, 0.0, 0.0)
    np.testing.assert_allclose(row["pusher"], (0.01, -0.02, math.pi), atol=1e-12)
    assert rows.take() == []


def test_a_row_does_not_wait_for_a_pusher_that_is_silent():
    rows = Rows(sensors=0, period=0.04)
    rows.pusher(0.0, (0.5, 0.0, 0.0))
    rows.object(0.01, (0.1, 0.0, 0.0))
    assert rows.take() == []
    rows.object(0.05, (0.2, 0.0, 0.0))
    [row] = rows.take()
    assert (row["time"], row["pusher"]) == (0.01, (0.5, 0.0, 0.0))


def test_a_row_waits_a_period_for_a_finger_and_then_has_its_last_pose():
    rows = Rows(sensors=0, period=0.04, fingers=1)
    rows.object(1.0, (0.1, 0.0, 0.0))
    rows.pusher(0.99, (0.0, 0.0, 0.0), finger=1)
    rows.pusher(1.0, (0.5, 0.0, 0.0))
    assert rows.take() == []
    rows.pusher(1.01, (0.02, 0.0, 0.0), finger=1)
    [row] = rows.take()
    assert (row["time"], row["pusher"]) == (1.0, (0.5, 0.0, 0.0))
    np.testing.assert_allclose(row["fingers"], [(0.01, 0.0, 0.0)], atol=1e-12)
    # no more from the finger
    rows.pusher(1.08, (0.6, 0.0, 0.0))
    assert rows.take() == []
    rows.pusher(1.10, (0.7, 0.0, 0.0))
    [row] = rows.take()
    assert (row["time"], row["object"], row["fingers"]) == (1.04, None, [(0.02, 0.0, 0.0)])


def test_in_the_dark_rows_have_the_pusher_alone_at_the_rate_of_the_camera():
    rows, taken = Rows(sensors=0, period=0.04), []
    for k in range(200):
        time = 0.01 * k
        rows.pusher(time, (time, 0.0, 0.0))
        if k % 4 == 0 and not 80 <= k < 160:
            rows.object(time, (1.0, 0.0, 0.0))
        taken += rows.take()
    times = [row["time"] for row in taken]
    np.testing.assert_allclose(np.diff(times), 0.04, atol=1e-12)
    dark = [row["time"] for row in taken if row["object"] is None]
    assert len(dark) == 20 and 0.79 < dark[0] and dark[-1] < 1.6
    np.testing.assert_allclose([row["pusher"][0] for row in taken], times, atol=1e-12)


@pytest.mark.parametrize("lag", [0.0, 0.08])
def test_rows_do_not_depend_on_when_they_are_taken(lag):
    def taken(every):
        rows, found = Rows(sensors=0, period=0.04, lag=lag), []
        for k in range(40):
            rows.pusher(0.04 * k, (0.04 * k, 0.0, 0.0))
            if k % every == 0:
                found += rows.take()
            if not 10 < k < 20 and k != 30:
                rows.object(0.04 * k, (1.0, 0.0, 0.0))
        return found + rows.take()

    assert len(taken(1)) == 40
    for every in (2, 7):
        assert [row["object"] for row in taken(every)] == [row["object"] for row in taken(1)]
        np.testing.assert_allclose([row["time"] for row in taken(every)], 0.04 * np.arange(40), atol=1e-12)


def test_a_camera_that_lags_makes_no_dark_rows():
    rows, taken = Rows(sensors=0, period=0.04, lag=0.1), []
    for k in range(200):
        time = 0.01 * k
        rows.pusher(time, (0.0, 0.0, 0.0))
        if k % 4 == 0 and k >= 10:
            rows.object(time - 0.1, (1.0, 0.0, 0.0))
        taken += rows.take()
    assert len(taken) == 47 and all(row["object"] for row in taken)


def test_a_stamp_far_ahead_makes_one_row():
    rows = Rows(sensors=0, period=0.04)
    rows.object(0.0, (1.0, 0.0, 0.0))
    for time in (0.0, 1e9):
        rows.pusher(time, (0.0, 0.0, 0.0))
    assert [row["time"] for row in rows.take()] == [0.0, 1e9]


def test_rows_go_on_after_one_wrong_time():
    rows, taken = Rows(sensors=1, period=0.04), []
    for time in [4e9, 0.0, 0.04, 0.08, 0.12, 0.16, 0.2]:
        rows.touch(0, time == 0.04)
        rows.pusher(time, (time, 0.0, 0.0))
        if time < 0.1 or time == 4e9:
            rows.object(time, (0.0, 0.0, 0.0))
        taken += rows.take()
    times = [row["time"] for row in taken]
    np.testing.assert_allclose(times, [4e9, 0.0, 0.04, 0.08, 0.12, 0.16], atol=1e-9)
    assert [row["tactile"] for row in taken] == [[False], [False], [True]] + 3 * [[False]]
    np.testing.assert_allclose([row["pusher"][0] for row in taken], times, atol=1e-9)


def test_a_row_has_the_mean_force_since_the_row_before():
    rows = Rows(sensors=0, period=0.04)
    for k in range(3):
        rows.object(1.0 + 0.04 * k, (0.1, 0.0, 0.0))
    for time, force in [(0.99, 1.0), (1.0, 3.0), (1.01, 5.0), (1.04, 6.0), (1.09, 9.0)]:
        rows.force(time, (force, -force))
    rows.pusher(1.2, (0.0, 0.0, 0.0))
    assert [row["force"] for row in rows.take()[:3]] == [(2.0, -2.0), (5.5, -5.5), None]


def test_a_force_is_turned_into_the_plane():
    # a sensor whose z-axis points along y of the table, and its x-axis along x
    half = math.sqrt(0.5)
    orientation = SimpleNamespace(x=-half, y=0.0, z=0.0, w=half)
    force = SimpleNamespace(x=1.0, y=2.0, z=3.0)
    np.testing.assert_allclose(planar.turned(force, orientation), (1.0, 3.0), atol=1e-12)


def test_touches_count_for_the_row_after_them():
    rows = Rows(sensors=2, period=0.04)
    rows.touch(1, False)
    rows.touch(1, True)
    rows.touch(1, False)
    read = []
    for k in range(2):
        rows.object(0.04 * k, (0.0, 0.0, 0.0))
        rows.pusher(0.04 * k, (0.0, 0.0, 0.0))
        read += [row["tactile"] for row in rows.take()]
    assert read == [[None, True], [None, False]]


def test_touches_count_for_their_own_row_if_poses_lag():
    rows, taken = Rows(sensors=1, period=0.04, lag=0.1), []
    for k in range(12):
        rows.pusher(0.04 * k, (0.0, 0.0, 0.0))
        rows.touch(0, k >= 6)
        if 2 <= k < 8:
            rows.object(0.04 * (k - 2), (0.0, 0.0, 0.0))
        taken += rows.take()
    # the last rows have no object pose
    assert [row["tactile"] for row in taken] == 6 * [[False]] + 2 * [[True]]
    assert [row["object"] is None for row in taken] == 6 * [False] + 2 * [True]


def test_each_transform_counts_once_also_after_a_clock_was_set_back():
    found, taken = [None], []
    transforms = Transforms(lambda: found[0], lambda time, pose: taken.append((time, pose[0])))
    for entry in [None, (1.0, 0.1), (1.0, 0.1), (1.5, 0.2), (0.5, 0.3)]:
        found[0] = entry and _transform(entry[0], entry[1], 0.0, 0.0)
        transforms.look()
    assert taken == [(1.0, 0.1), (1.5, 0.2), (0.5, 0.3)]


def test_a_tracker_restarts_after_a_pause_and_not_for_one_wrong_time(scene):
    def row(time):
        return {"time": time, "object": (0.0, 0.0, 0.0), "pusher": (-0.2, 0.0, 0.0), "tactile": [], "force": None}

    starts = []
    following = Following(lambda: starts.append(1) or stickslip.Tracker(scene, particles=64))
    following.push(row(0.0))
    for time in [50.0, math.nan, 100.0]:
        with pytest.raises(stickslip.Error):
            following.push(row(time))
    following.push(row(0.04))
    assert (len(starts), following.time) == (1, 0.04)
    with pytest.raises(stickslip.Error):
        following.push(row(100.0))
    following.push(row(100.04))
    assert (len(starts), following.time) == (2, 100.04)
    following.push(row(100.0))
    assert following.time == 100.04
    # a clock that is set back
    with pytest.raises(stickslip.Error):
        following.push(row(0.0))
    following.push(row(0.04))
    assert (len(starts), following.time) == (3, 0.04)
    assert (following.late, following.refused, following.restarts, following.collapses) == (1, 5, 2, 0)
