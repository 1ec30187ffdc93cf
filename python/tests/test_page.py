"""Pages for browsers and notebooks: their numbers are those of the runs, and completion knows the options."""

import html
import inspect
import json
import re
import shutil

import numpy as np
import pytest

import stickslip

OPTIONS = {"particles": 64, "occlude": 200}


def _played(page: str) -> dict:
    """The data of a page's only player."""
    (data,) = re.findall(r'<script type="application/json">(.*?)</script>', page)
    return json.loads(data)


def test_an_estimate_in_a_notebook_is_its_player(demo, scene):
    estimate = stickslip.filter(demo / "log.csv", scene, **OPTIONS)
    shown = estimate._repr_html_()
    (framed,) = re.findall(r'^<iframe .* srcdoc="([^"]*)"></iframe>$', shown, flags=re.DOTALL)
    assert html.unescape(framed) == estimate.player()
    data = _played(estimate.player())
    np.testing.assert_allclose(data["methods"][0]["pose"]["x"], np.rint(1e5 * estimate["x"]))
    assert data["hidden"].index(1) == 200


def test_a_report_of_a_folder_has_its_truth_and_contacts(demo, scene, tmp_path):
    page = stickslip.report(demo, **OPTIONS)
    path = page.save(tmp_path / "page.html")
    assert path.read_text(encoding="utf-8") == page
    facts = json.loads((demo / "truth.json").read_text())
    marks = dict((name, row) for row, name in _played(page)["marks"])
    assert marks["pusher"] == facts["first_pusher_contact"]
    truth = stickslip.load_truth(demo / "truth.csv")
    estimate = stickslip.filter(demo / "log.csv", scene, **OPTIONS)
    scores = stickslip.score(estimate, demo / "log.csv", scene, truth=truth, occlude=200)
    assert f'<td data-of="pose RMSE, camera off (mm)">{scores["wmse_occluded_mm"]:.3f}</td>' in page
    # columns have no folder: the scene is to be given
    log = stickslip.load_log(demo / "log.csv")
    with pytest.raises(stickslip.Error, match="the scene is missing"):
        stickslip.report(log, **OPTIONS)


def test_the_page_of_a_comparison_has_its_rows(demo, tmp_path):
    for name in ("a", "b", "c"):
        shutil.copytree(demo, tmp_path / name)
    rows = stickslip.compare([tmp_path], variants=["kalman", "particle"], seeds=2, **OPTIONS)
    assert [row["seed"] for row in rows if row["variant"] == "particle"] == [0, 1] * 3
    page = rows._repr_html_()
    page = html.unescape(re.findall(r'srcdoc="([^"]*)"', page)[0])
    assert page == rows.page() and "2 seeds per experiment" in page
    own = np.median([row["wmse_occluded_mm"] for row in rows if row["variant"] == "particle"])
    assert f">{own:.2f} ({own:.2f})</td>" in page
    # a dot per log: errors and coverage of two methods, ratios of one; wide and narrow
    assert page.count("<title>b: ") == 2 * 5
    (covered,) = {row["covered_90"] for row in rows if row["variant"] == "kalman"}
    assert 0 <= covered <= 1 and all(row["crps_mm"] > 0 for row in rows)
    # a histogram per method, whose bars are the means over its runs; wide and narrow
    pit = [np.mean([row["pit"] for row in rows if row["variant"] == name], axis=0) for name in ("kalman", "particle")]
    assert np.allclose(np.sum(pit, axis=1), 1)
    bars = re.findall(r"<title>0\.\d to [01]\.\d: ([\d.]+)</title>", page)
    assert sorted(bars) == sorted(2 * [f"{100 * share:.1f}" for share in np.ravel(pit)])


@pytest.mark.parametrize(
    "function", [stickslip.filter, stickslip.particles, stickslip.samples, stickslip.compare, stickslip.report]
)
def test_signature_and_documentation_name_every_option(function):
    parameters = inspect.signature(function).parameters
    for name in stickslip.FilterOptions.__annotations__:
        assert parameters[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert f"- ``{name}``: " in function.__doc__
    assert (parameters["particles"].default, parameters["occlude"].default) == (500, None)
