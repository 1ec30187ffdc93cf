"""The node of ros2/stickslip_ros gives the estimates of the library.

The messages go through the middleware of rclpy where it is installed, else through a stand-in.
"""

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
import ros2_session
import yaml
from conftest import ROOT
from ros2_session import Session, place

import stickslip
from stickslip._toml import tomllib
from stickslip_ros import messages, planar, quality
from stickslip_ros.node import PARAMETERS, StickslipNode

PACKAGE = ROOT / "ros2/stickslip_ros"

#: A rate whose period has no rounding error (Hz).
RATE = 32.0

HAND = """
gravity = 9.81
object = { mass = 0.5, shape = [ { disc = { radius = 0.03 } } ] }
support = { friction = 0.3 }
fixels = { friction = 0.25 }
camera = { position_std = 3e-4, orientation_std = 5e-3 }
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.3
stall_force = 15.0
[[finger]]
shape = [ { disc = { radius = 0.005 } } ]
start = [0.05, 0.0, 0.0]
[start]
object = [0.006, 0.003, 0.0]
pusher = [-0.05, 0.0, 0.0]
speed = 0.01
duration = 3.0
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """An experiment folder: the camera is off for a second about the touch of a fixel, sensor 1 starts late."""
    simulation = stickslip.simulate(ROOT / "crates/cli/demo/turn-square-disc/scene.toml", rate=RATE, seed=1)
    for name in ("object_x", "object_y", "object_theta"):
        simulation.log[name][50:82] = np.nan
    simulation.log["tactile_1"][:5] = np.nan
    folder = tmp_path_factory.mktemp("ros2") / "exp"
    simulation.write(folder)
    return folder


def carried(pose):
    """Returns a pose as messages carry it, with a quaternion."""
    message = ros2_session.PoseStamped()
    place(message.pose.position, message.pose.orientation, pose)
    return planar.planar(message.pose.position, message.pose.orientation)


def as_carried(log):
    """Returns a log with poses as messages carry them."""
    log = {name: column.copy() for name, column in log.items()}
    for body in ("object", "pusher", *(["finger_1"] if "finger_1_x" in log else [])):
        names = [f"{body}_{name}" for name in ("x", "y", "theta")]
        for row in np.flatnonzero(~np.isnan(log[names[0]])):
            for name, value in zip(names, carried([log[name][row] for name in names]), strict=True):
                log[name][row] = value
    return log


def play(session, log, delay=0):
    """Sends the messages of a log in the order of their arrival; object poses are ``delay`` rows late."""
    rows, reads = list(stickslip.rows(log)), {}
    for k, row in enumerate(rows):
        session.pose("/pusher/pose", row["time"], row["pusher"])
        for finger, pose in enumerate(row["fingers"], 1):
            session.pose(f"/finger_{finger}/pose", row["time"], pose)
        for sensor, on in enumerate(row["tactile"]):
            # a sensor that speaks up when it changes
            if on is not None and on != reads.get(sensor):
                session.touch(f"/fixel_{sensor + 1}/contact", on)
                reads[sensor] = on
        late = rows[k - delay] if k >= delay else None
        if late and late["object"]:
            session.pose("/object/pose", late["time"], late["object"])
        session.tick()


def numbers(message):
    """Returns stamp, place, heading and covariance of a pose."""
    at = message.pose.pose
    return (
        planar.seconds(message.header.stamp),
        (at.position.x, at.position.y, at.orientation.z, at.orientation.w),
        tuple(message.pose.covariance),
    )


def expected(estimate):
    """Returns the numbers of the message with an estimate."""
    return numbers(messages.pose(estimate, "table", estimate["time"]))


def pairs(health):
    """Returns the values of a diagnostic status by key."""
    return {pair.key: pair.value for pair in health.status[0].values}


@pytest.mark.parametrize("model", ["robust", "paper"])
@pytest.mark.parametrize("delay", [0, 2])
def test_a_log_played_message_by_message_gives_the_causal_estimates(recorded, monkeypatch, model, delay):
    log = {name: column[:120] for name, column in stickslip.load_log(recorded / "log.csv").items()}
    # object poses of the last rows have not arrived at the end
    seen = {name: column[: 120 - delay] for name, column in log.items()}
    whole = stickslip.filter(as_carried(seen), recorded / "scene.toml", causal=True, model=model, particles=100, seed=3)
    parameters = {"particles": 100, "model": model, "seed": 3, "rate": RATE, "lag": delay / RATE}
    contacts = ["/fixel_1/contact", "/fixel_2/contact"]
    with Session(monkeypatch, scene=str(recorded / "scene.toml"), contacts=contacts, **parameters) as session:
        play(session, log, delay)
    rows = [{name: column[k] for name, column in whole.items()} for k in range(len(whole["time"]))]
    assert session.warnings == []
    assert [numbers(message) for message in session.poses] == [expected(row) for row in rows]
    for message, row in zip(session.health, rows, strict=True):
        assert pairs(message).items() >= dict(messages.words(row)).items()
    last = pairs(session.health[-1])
    assert last["ess"] == f"{whole['ess'][-1]:.6g}" and last["collapses"] == str(whole.collapses)
    assert (last["late_rows"], last["refused_rows"], last["restarts"]) == ("0", "0", "0")
    assert last["observed"].split() == [name for name, is_observed in whole.observed.items() if is_observed]


def test_a_hand_has_poses_of_each_finger(tmp_path, monkeypatch):
    stickslip.simulate(stickslip.Scene(HAND), rate=RATE, seed=1).write(tmp_path / "exp")
    scene, log = str(tmp_path / "exp/scene.toml"), stickslip.load_log(tmp_path / "exp/log.csv")
    for name in ("object_x", "object_y", "object_theta"):
        log[name][40:-1] = np.nan
    assert log["tactile_1"].any() and log["tactile_2"].any()
    whole = stickslip.filter(as_carried(log), scene, causal=True, particles=100)
    contacts = ["/fixel_1/contact", "/fixel_2/contact"]
    given = {"scene": scene, "particles": 100, "rate": RATE, "lag": 0.0, "contacts": contacts}
    with Session(monkeypatch, fingers=["/finger_1/pose"], **given) as session:
        play(session, log)
    assert session.warnings == []
    rows = [{name: column[k] for name, column in whole.items()} for k in range(len(whole["time"]))]
    assert [numbers(message) for message in session.poses] == [expected(row) for row in rows]
    with pytest.raises(ValueError, match=r"`fingers` has 0 sources, and .* 1 \[\[finger\]\]"):
        Session(monkeypatch, **given)


def test_missing_and_late_messages_give_the_estimates_of_a_tracker(recorded, monkeypatch):
    log = {name: column[:120] for name, column in stickslip.load_log(recorded / "log.csv").items()}
    draw = np.random.default_rng(5)
    arrivals = []
    for k, row in enumerate(stickslip.rows(log)):
        if draw.random() < 0.8:
            arrivals.append((k, 0, "/pusher/pose", row["time"], row["pusher"]))
        if row["object"] and draw.random() < 0.8:
            arrivals.append((k + draw.choice([0, 1, 4]), 1, "/object/pose", row["time"], row["object"]))
    scene = recorded / "scene.toml"
    with Session(monkeypatch, scene=str(scene), particles=100, rate=RATE, lag=0.0) as session:
        for *_, topic, time, pose in sorted(arrivals):
            session.pose(topic, time, pose)
            session.tick()
    sent = {time: carried(pose) for *_, topic, time, pose in arrivals if topic == "/object/pose"}
    assert {row["time"]: row["object"] for row in session.rows if row["object"]} == sent
    # every row goes to a tracker in the order of the node
    tracker, given, late, latest = stickslip.Tracker(scene, particles=100), [], 0, -math.inf
    for row in session.rows:
        given.append(tracker.push(**row))
        late += row["time"] <= latest
        latest = max(latest, row["time"])
    assert late > 10 and pairs(session.health[-1])["late_rows"] == str(late)
    known = [expected(estimate) for estimate in given if not math.isnan(estimate["x"])]
    assert [numbers(message) for message in session.poses] == known
    # a late row changes the estimate at the latest row, which is in /tf already
    stamps = [planar.seconds(message.header.stamp) for message in session.broadcast]
    assert stamps == sorted(set(stamps)) and len(stamps) < len(known)


def test_transforms_are_poses(demo, scene, monkeypatch):
    log = list(stickslip.rows(demo / "log.csv"))[:60]
    parameters = {"scene": str(demo / "scene.toml"), "particles": 64, "object": "/tf:table.tag", "child_frame": "plate"}
    with Session(monkeypatch, **parameters) as session:
        for row in log:
            if row["object"] is not None:
                session.transform("table", "tag", row["time"], row["object"])
            session.pose("/pusher/pose", row["time"], row["pusher"])
            session.tick()
    tracker = stickslip.Tracker(scene, particles=64)
    given = [tracker.push(**row) for row in session.rows]
    assert session.warnings == [] and len(given) >= 59
    assert [row["object"] for row in session.rows if row["object"]] == [carried(row["object"]) for row in log]
    assert [numbers(message) for message in session.poses] == [expected(estimate) for estimate in given]
    for message, estimate in zip(session.broadcast, given, strict=True):
        assert (message.header.frame_id, message.child_frame_id) == ("table", "plate")
        turn = message.transform
        assert (turn.translation.x, turn.translation.y) == (estimate["x"], estimate["y"])
        assert 2 * math.atan2(turn.rotation.z, turn.rotation.w) == pytest.approx(estimate["theta"])


def test_forces_are_turned_and_reach_the_tracker(demo, monkeypatch):
    with Session(monkeypatch, scene=str(demo / "scene.toml"), frame="table", rate=RATE, wrench="/wrench") as session:
        session.pose("/object/pose", 1.0, (0.0, 0.0, 0.0))
        session.force("/wrench", 1.0, (1.0, 2.0, 0.0))
        session.transform("table", "wrist", 1.0, (0.0, 0.0, math.pi / 2))
        session.pose("/pusher/pose", 1.0, (-0.1, 0.0, 0.0))
        session.pose("/object/pose", 1.0 + 1 / RATE, (0.0, 0.0, 0.0))
        session.force("/wrench", 1.0 + 1 / RATE, (1.0, 2.0, 0.0), frame="wrist")
        session.pose("/pusher/pose", 1.0 + 1 / RATE, (-0.1, 0.0, 0.0))
        session.tick()
        assert session.rows[0]["force"] == (1.0, 2.0)
        np.testing.assert_allclose(session.rows[1]["force"], (-2.0, 1.0), atol=1e-12)


def test_the_node_goes_on_after_a_pause(demo, monkeypatch):
    log = list(stickslip.rows(demo / "log.csv"))[:30]
    with Session(monkeypatch, scene=str(demo / "scene.toml"), particles=64, lag=0.0) as session:
        session.tick()  # no message has come yet
        for shift in (0.0, 60.0):
            for row in log:
                session.pose("/object/pose", row["time"] + shift, row["object"])
                session.pose("/pusher/pose", row["time"] + shift, row["pusher"])
                session.tick()
    # the first row after the pause is refused, since its time may be wrong; the next one restarts the tracker
    assert len(session.poses) == 59 and len(session.warnings) == 1 and "5 s" in session.warnings[0]
    last = pairs(session.health[-1])
    assert (last["refused_rows"], last["restarts"]) == ("1", "1")
    assert planar.seconds(session.poses[-1].header.stamp) == pytest.approx(log[-1]["time"] + 60, abs=1e-6)


def test_doubts_of_the_tracker_are_a_warning():
    estimate = dict.fromkeys(["time", "x", "std_x", "ess"], 0.25) | {"d_tri": math.nan}

    class Following:
        doubts, observed, collapses, late, refused, restarts = (), ["mu_s"], 1, 2, 3, 4

    message = messages.diagnostics(estimate, Following, "table", 1_700_000_000.25)
    stamp = message.header.stamp
    assert (message.header.frame_id, stamp.sec, stamp.nanosec) == ("table", 1_700_000_000, 250_000_000)
    assert (message.status[0].level, message.status[0].message) == (b"\0", "")
    counts = {"observed": "mu_s", "collapses": "1", "late_rows": "2", "refused_rows": "3", "restarts": "4"}
    assert pairs(message) == {"std_x": "0.25", "ess": "0.25"} | counts
    Following.doubts = ("a", "b")
    message = messages.diagnostics(estimate, Following, "table", 0.9999999999)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 0)
    assert (message.status[0].level, message.status[0].message) == (b"\1", "a; b")


def test_a_pose_message_has_the_covariance():
    estimate = {"x": 0.5, "y": -0.25, "theta": 3.0, "std_x": 0.1, "std_y": 0.2, "std_theta": 0.5}
    estimate |= {"cov_x_y": 0.01, "cov_x_theta": -0.02, "cov_y_theta": 0.03}
    message = messages.pose(estimate, "table", 0.0)
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    assert (position.x, position.y) == (0.5, -0.25)
    assert 2 * math.atan2(orientation.z, orientation.w) == pytest.approx(3.0)
    covariance = {0: 0.01, 7: 0.04, 35: 0.25, 1: 0.01, 6: 0.01, 5: -0.02, 30: -0.02, 11: 0.03, 31: 0.03}
    assert {k: v for k, v in enumerate(message.pose.covariance) if v} == pytest.approx(covariance)


def test_a_viewer_that_starts_later_gets_the_scene(demo, scene, monkeypatch):
    with Session(monkeypatch, scene=str(demo / "scene.toml"), particles=64, child_frame="plate") as session:
        markers = session.scene()
    bodies = stickslip.outlines(scene)
    assert [(marker.ns, marker.id, marker.header.frame_id) for marker in markers] == [
        *(("object", part, "plate") for part in range(2)),
        *((f"fixel_{k}", 0, "table") for k in (1, 2, 3)),
    ]
    polygons = [*bodies.object, *(part for fixel in bodies.fixels for part in fixel)]
    for marker, polygon in zip(markers, polygons, strict=True):
        corners = np.array([(point.x, point.y) for point in marker.points])
        np.testing.assert_array_equal(corners, [*polygon, polygon[0]])
        assert marker.frame_locked and (marker.header.stamp.sec, marker.header.stamp.nanosec) == (0, 0)


def test_wrong_parameters_are_refused_and_another_frame_is_reported(demo, monkeypatch):
    scene = str(demo / "scene.toml")
    for wrong, rule in [
        ({"reliability": "fast"}, "`fast`; it must be best_effort or reliable"),
        ({"depth": 0}, "at least 1"),
        ({"object": "/tf:table.plate", "child_frame": "plate"}, "its own frame"),
    ]:
        with pytest.raises(ValueError, match=rule), Session(monkeypatch, scene=scene, particles=64, **wrong):
            pass
    assert quality.of_inputs("best_effort", 7).depth == 7
    with Session(monkeypatch, scene=scene, particles=64, frame="floor") as session:
        session.pose("/object/pose", 0.0, (0.0, 0.0, 0.0))
    assert session.warnings[0].startswith("/object/pose: the frame is `table`, and `frame` is `floor`")


def test_the_package_names_its_files_and_parameters():
    (section,) = yaml.safe_load((PACKAGE / "config/stickslip.yaml").read_text()).values()
    assert section["ros__parameters"] == PARAMETERS
    readme = (PACKAGE / "README.md").read_text()
    assert set(PARAMETERS) <= set(re.findall(r"`(\w+)`", readme))
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    manifest = ElementTree.parse(PACKAGE / "package.xml").getroot()
    assert (manifest.findtext("name"), manifest.findtext("version")) == ("stickslip_ros", version)
    setup = (PACKAGE / "setup.py").read_text()
    assert f'version="{version}"' in setup
    for path in re.findall(r'"((?:config|launch|resource|rviz)/\S+?)"', setup):
        assert (PACKAGE / path).is_file(), path
    layout = yaml.safe_load((PACKAGE / "rviz/stickslip.rviz").read_text())
    topics = {
        display["Topic"]["Value"] for display in layout["Visualization Manager"]["Displays"] if "Topic" in display
    }
    assert topics == {"/stickslip/pose", "/stickslip/scene"}


@pytest.mark.skipif(ros2_session.IS_STAND_IN, reason="rclpy is not installed: see ros2/stickslip_ros/README.md")
def test_the_node_reads_the_parameters_file(demo):
    options = ["--ros-args", "--params-file", str(PACKAGE / "config/stickslip.yaml")]
    ros2_session.rclpy.init()
    try:
        # the command line goes before the file
        node = StickslipNode(cli_args=[*options, "-p", f"scene:={demo / 'scene.toml'}", "-p", "depth:=7"])
        given = {name: node.get_parameter(name).value for name in PARAMETERS}
        node.destroy_node()
    finally:
        ros2_session.rclpy.shutdown()
    assert given == PARAMETERS | {"scene": str(demo / "scene.toml"), "depth": 7}
