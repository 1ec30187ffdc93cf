"""Logs come from files, folders and bags, as for the program."""

import json
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT

import stickslip

#: Tags on the object and the pusher of the bag that peer.py makes of frames.
TAGS = '[object]\ntags = { tag_7 = [0.012, -0.004, 1.5], "tag36h11:8" = [-0.02, 0.01, -0.5] }\n'
TOPICS = {"object": ["/tf:table.tag_7", "/tf:table.tag36h11:8"], "pusher": "/tf:table.finger"}


@pytest.fixture(scope="module")
def bag(demo, tmp_path_factory):
    pytest.importorskip("rosbags")
    folder = tmp_path_factory.mktemp("push")
    peer = ROOT / "crates/formats/tests/it/ros2_peer/peer.py"
    subprocess.run([sys.executable, peer, "frames", demo / "log.csv", folder / "bag"], check=True)
    (folder / "scene.toml").write_text((demo / "scene.toml").read_text().replace("[object]\n", TAGS))
    return folder / "bag"


def test_info_is_that_of_the_program(program, bag):
    done = subprocess.run([program, "info", bag, "--json"], check=True, capture_output=True, text=True)
    assert stickslip.info(bag) == json.loads(done.stdout)


def test_load_log_reads_a_bag_with_topics_and_the_scene_s_tags(bag, demo, tmp_path):
    scene = stickslip.load_scene(bag.parent / "scene.toml")
    log, original = stickslip.load_log(bag, scene=scene, topics=TOPICS), stickslip.load_log(demo / "log.csv")
    at = np.searchsorted(original["time"], log["time"] - log["time"][0] + original["time"][0] - 1e-6)
    seen = ~np.isnan(log["object_x"])
    np.testing.assert_allclose(log["object_x"][seen], original["object_x"][at][seen], atol=1e-6)
    np.testing.assert_allclose(log["pusher_x"], original["pusher_x"][at], atol=1e-6)
    # the folder with the bag and its scene is the log, too
    folder = stickslip.load_log(bag.parent, scene=scene, topics=TOPICS)
    np.testing.assert_array_equal(folder["object_x"], log["object_x"])
    rows = stickslip.compare([bag.parent], variants=["kalman"], topics=TOPICS)
    assert rows[0]["wmse_mm"] < 1


def test_load_log_of_a_bag_without_its_topics_says_how_to_name_them(bag):
    with pytest.raises(stickslip.Error, match=r'topics=\{"object": "TOPIC"\}'):
        stickslip.load_log(bag)
    with pytest.raises(stickslip.Error, match="`objekt` is none of the keys"):
        stickslip.load_log(bag, topics={"objekt": "/a"})


def test_load_log_of_a_bag_without_a_file_warns_of_the_loss(bag, tmp_path):
    scene = stickslip.load_scene(bag.parent / "scene.toml")
    (tmp_path / "bag").mkdir()
    for file in bag.iterdir():
        if file.name != "metadata.yaml":
            (tmp_path / "bag" / file.name).write_bytes(file.read_bytes())
    with pytest.warns(stickslip.Warning, match=r"metadata\.yaml"):
        stickslip.load_log(tmp_path / "bag", scene=scene, topics=TOPICS)


def test_load_log_takes_topics_for_bags_only_and_files_that_exist(demo, tmp_path):
    with pytest.raises(stickslip.Error, match="topics are for MCAP logs"):
        stickslip.load_log(demo / "log.csv", topics={"object": "/a"})
    for call in (stickslip.load_log, stickslip.info, stickslip.load_truth):
        with pytest.raises(FileNotFoundError):
            call(tmp_path / "none")


def test_score_reads_the_truth_of_a_path(demo, scene):
    estimate = stickslip.filter(demo, scene, particles=16)
    scores = stickslip.score(estimate, demo, scene, truth=demo / "truth.csv")
    for truth in (stickslip.load_truth(demo / "truth.csv"), str(demo / "truth.csv")):
        np.testing.assert_equal(stickslip.score(estimate, demo, scene, truth=truth), scores)
    assert scores["wmse_mm"] != stickslip.score(estimate, demo, scene)["wmse_mm"]
