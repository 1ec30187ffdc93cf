"""The node of examples/ros2_node.py: its functions on messages that have the fields of ROS's, and it as a whole on a
stand-in for ROS that only passes messages on."""

import importlib.util
import math
import sys
from collections import defaultdict
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
from conftest import ROOT

import stickslip

_spec = importlib.util.spec_from_file_location("ros2_node", ROOT / "examples/ros2_node.py")
assert _spec is not None and _spec.loader is not None
node = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(node)


def _stamp(time):
    nanoseconds = round(time * 1e9)
    return SimpleNamespace(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def _place(x=0.0, y=0.0, yaw=0.0):
    position = SimpleNamespace(x=x, y=y, z=0.3)
    return position, SimpleNamespace(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def _pose(time, x, y, yaw):
    position, orientation = _place(x, y, yaw)
    return SimpleNamespace(
        header=SimpleNamespace(stamp=_stamp(time), frame_id="table"),
        pose=SimpleNamespace(position=position, orientation=orientation),
    )


def _transform(time, x, y, yaw):
    translation, rotation = _place(x, y, yaw)
    return SimpleNamespace(
        header=SimpleNamespace(stamp=_stamp(time)),
        transform=SimpleNamespace(translation=translation, rotation=rotation),
    )


def test_poses_are_laid_into_the_plane():
    for yaw in np.linspace(-3.1, 3.1, 13):
        np.testing.assert_allclose(node.planar(*_place(1.0, -2.0, yaw)), (1.0, -2.0, yaw), atol=1e-15)
    # 20 degrees over its own y-axis and 90 about z: the x-axis still heads along y
    half, tilt = math.pi / 4, math.radians(10)
    quaternion = SimpleNamespace(
        x=-math.sin(half) * math.sin(tilt),
        y=math.cos(half) * math.sin(tilt),
        z=math.sin(half) * math.cos(tilt),
        w=math.cos(half) * math.cos(tilt),
    )
    assert node.planar(_place()[0], quaternion)[2] == pytest.approx(math.pi / 2)
    assert node.seconds(_stamp(12.25)) == 12.25


def test_sources_are_topics_or_frames():
    assert node.frames("/tf:table.tag_7") == ("table", "tag_7") and node.frames("/object/pose") is None
    with pytest.raises(ValueError, match=r"/tf:parent\.child"):
        node.frames("/tf:table")


def test_a_row_waits_for_the_pusher_and_has_it_where_it_was_then():
    rows = node.Rows(sensors=0, period=0.04)
    rows.object(1.0, (0.1, 0.0, 0.0))
    rows.pusher(0.99, (0.0, 0.0, 3.1))
    assert rows.take() == []
    rows.pusher(1.01, (0.02, -0.04, -3.1))
    [row] = rows.take()
    assert row["time"] == 1.0 and row["object"] == (0.1, 0.0, 0.0)
    np.testing.assert_allclose(row["pusher"], (0.01, -0.02, math.pi), atol=1e-12)
    assert rows.take() == []


def test_a_row_does_not_wait_for_a_pusher_that_is_silent():
    rows = node.Rows(sensors=0, period=0.04)
    rows.pusher(0.0, (0.5, 0.0, 0.0))
    rows.object(0.01, (0.1, 0.0, 0.0))
    assert rows.take() == []
    rows.object(0.05, (0.2, 0.0, 0.0))
    [row] = rows.take()
    assert (row["time"], row["pusher"]) == (0.01, (0.5, 0.0, 0.0))


def test_in_the_dark_rows_have_the_pusher_alone_at_the_rate_of_the_camera():
    rows, taken = node.Rows(sensors=0, period=0.04), []
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


def test_a_camera_that_lags_makes_no_dark_rows():
    rows, taken = node.Rows(sensors=0, period=0.04, lag=0.1), []
    for k in range(200):
        time = 0.01 * k
        rows.pusher(time, (0.0, 0.0, 0.0))
        if k % 4 == 0 and k >= 10:
            rows.object(time - 0.1, (1.0, 0.0, 0.0))
        taken += rows.take()
    assert len(taken) == 47 and all(row["object"] for row in taken)


def test_a_stamp_far_ahead_makes_one_row():
    rows = node.Rows(sensors=0, period=0.04)
    rows.object(0.0, (1.0, 0.0, 0.0))
    for time in (0.0, 1e9):
        rows.pusher(time, (0.0, 0.0, 0.0))
    assert [row["time"] for row in rows.take()] == [0.0, 1e9]


def test_rows_go_on_after_one_wrong_time():
    rows, taken = node.Rows(sensors=1, period=0.04), []
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


def test_touches_count_for_the_row_after_them():
    rows = node.Rows(sensors=2, period=0.04)
    rows.touch(1, False)
    rows.touch(1, True)
    rows.touch(1, False)
    read = []
    for k in range(2):
        rows.object(0.04 * k, (0.0, 0.0, 0.0))
        rows.pusher(0.04 * k, (0.0, 0.0, 0.0))
        read += [row["tactile"] for row in rows.take()]
    assert read == [[None, True], [None, False]]


def test_messages_are_filled():
    estimate = {"x": 0.5, "y": -0.25, "theta": 3.0, "std_x": 0.1, "std_y": 0.2, "std_theta": 0.5}
    estimate |= {"cov_x_y": 0.01, "cov_x_theta": -0.02, "cov_y_theta": 0.03}
    estimate |= {"mu_s": 0.25, "d_tri": math.nan, "ess": 123.0}
    position, orientation = _place()
    message = SimpleNamespace(
        header=SimpleNamespace(frame_id="", stamp=SimpleNamespace(sec=0, nanosec=0)),
        pose=SimpleNamespace(pose=SimpleNamespace(position=position, orientation=orientation), covariance=np.zeros(36)),
    )
    node.fill_header(message.header, "world", 1_700_000_000.25)
    node.fill_pose(message, estimate)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 250_000_000)
    assert (position.x, position.y) == (0.5, -0.25)
    assert 2 * math.atan2(orientation.z, orientation.w) == pytest.approx(3.0)
    expected = {0: 0.01, 7: 0.04, 35: 0.25, 1: 0.01, 6: 0.01, 5: -0.02, 30: -0.02, 11: 0.03, 31: 0.03}
    assert {k: v for k, v in enumerate(message.pose.covariance) if v} == pytest.approx(expected)
    node.fill_header(message.header, "world", 0.9999999999)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 0)
    assert node.words(estimate) == [("mu_s", "0.25"), ("ess", "123")]


def test_a_tracker_starts_anew_after_a_pause_and_not_for_one_wrong_time(scene):
    def row(time):
        return {"time": time, "object": (0.0, 0.0, 0.0), "pusher": (-0.2, 0.0, 0.0), "tactile": [], "force": None}

    starts = []
    following = node.Following(lambda: starts.append(1) or stickslip.Tracker(scene, particles=64))
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


class _Ros:
    """Modules of ROS that pass messages on, and what was published; ``spin`` runs ``play`` instead of waiting."""

    def __init__(self, monkeypatch, parameters, play):
        self.subscribed, self.published, self.transforms = {}, defaultdict(list), {}
        self.warnings = []
        self.node = MagicMock()
        self.node.declare_parameter = lambda name, default: SimpleNamespace(value=parameters.get(name, default))
        self.node.create_subscription = lambda kind, topic, take, qos: self.subscribed.__setitem__(topic, take)
        self.node.create_publisher = lambda kind, topic, depth: SimpleNamespace(publish=self.published[topic].append)
        self.node.create_timer = lambda period, tick: setattr(self, "tick", tick)
        self.node.get_logger().warning = lambda text, **_: self.warnings.append(text)
        for name in ["diagnostic_msgs.msg", "geometry_msgs.msg", "rclpy.qos", "rclpy.time", "std_msgs.msg"]:
            monkeypatch.setitem(sys.modules, name, MagicMock())
        executors = SimpleNamespace(ExternalShutdownException=InterruptedError)
        monkeypatch.setitem(sys.modules, "rclpy.executors", executors)
        rclpy, tf2 = MagicMock(), ModuleType("tf2_ros")
        rclpy.create_node.return_value = self.node
        rclpy.spin.side_effect = lambda _: play(self)
        tf2.TransformException = KeyError
        tf2.Buffer = lambda: SimpleNamespace(lookup_transform=lambda parent, child, _: self.transforms[parent, child])
        tf2.TransformListener = tf2.TransformBroadcaster = MagicMock()
        monkeypatch.setitem(sys.modules, "rclpy", rclpy)
        monkeypatch.setitem(sys.modules, "tf2_ros", tf2)
        stamped = SimpleNamespace
        geometry = sys.modules["geometry_msgs.msg"]
        geometry.PoseWithCovarianceStamped = lambda: stamped(
            header=stamped(stamp=stamped(sec=0, nanosec=0), frame_id=""),
            pose=stamped(pose=stamped(position=_place()[0], orientation=_place()[1]), covariance=np.zeros(36)),
        )


def test_the_node_gives_what_the_tracker_gives(demo, scene, monkeypatch):
    log = [row for row in stickslip.rows(demo / "log.csv")][:120]
    sensors = len(log[0]["tactile"])

    def play(ros):
        for row in log:
            for k, on in enumerate(row["tactile"]):
                if on is not None:
                    ros.subscribed[f"/fixel_{k + 1}/contact"](SimpleNamespace(data=on))
            if row["object"] is not None:
                ros.transforms["table", "tag"] = _transform(row["time"], *row["object"])
            ros.subscribed["/pusher/pose"](_pose(row["time"], *row["pusher"]))
            ros.tick()

    contacts = [f"/fixel_{k + 1}/contact" for k in range(sensors)]
    parameters = {"scene": str(demo / "scene.toml"), "object": "/tf:table.tag", "particles": 64, "contacts": contacts}
    ros = _Ros(monkeypatch, parameters, play)
    node.main()

    tracker, expected = stickslip.Tracker(scene, particles=64), []
    for row in log:
        planar = {name: node.planar(*_place(*row[name])) if row[name] else None for name in ("object", "pusher")}
        estimate = tracker.push(node.seconds(_stamp(row["time"])), **planar, tactile=row["tactile"])
        expected.append((estimate["x"], estimate["y"], estimate["std_x"] ** 2))
    given = [(m.pose.pose.position.x, m.pose.pose.position.y, m.pose.covariance[0]) for m in ros.published["~/pose"]]
    assert ros.warnings == [] and len(given) > 100
    assert given == expected
    assert len(ros.published["/diagnostics"]) == len(given)


def test_the_node_goes_on_in_the_dark_with_late_poses_and_after_a_pause(demo, monkeypatch):
    log = [row for row in stickslip.rows(demo / "log.csv")][:90]
    counts = []

    def play(ros):
        def step(row, shift=0.0, sees=True):
            if sees:
                ros.subscribed["/object/pose"](_pose(row["time"] + shift, *row["object"]))
            ros.subscribed["/pusher/pose"](_pose(row["time"] + shift, *row["pusher"]))
            ros.tick()

        def count():
            counts.append((len(ros.published["~/pose"]), len(ros.warnings)))

        ros.tick()  # nothing has come yet
        for row in log[:40]:
            step(row)
        count()
        for row in log[40:60]:
            step(row, sees=False)
        count()
        ros.subscribed["/object/pose"](_pose(log[56]["time"], *log[56]["object"]))
        ros.tick()
        count()
        for row in log[60:]:
            step(row, shift=60.0)
        count()

    parameters = {"scene": str(demo / "scene.toml"), "particles": 64, "contacts": [], "lag": 0.0}
    ros = _Ros(monkeypatch, parameters, play)
    node.main()

    (seen, _), (dark, _), (late, refused), (again, told) = counts
    assert seen == 40 and 18 <= dark - seen <= 20
    # the pose that comes late is answered by the estimate at the latest row
    stamps = [message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec for message in ros.published["~/pose"]]
    assert late == dark + 1 and stamps[late - 1] == stamps[dark - 1] and refused == 0
    # the first row after the pause is refused, since its time may be wrong; the next one begins anew
    assert again == late + 29 and told == 1 and "5 s" in ros.warnings[0]
    assert stamps[late] > 60 and math.isclose(stamps[-1], log[-1]["time"] + 60, abs_tol=1e-6)
