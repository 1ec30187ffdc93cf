"""The guide: every page is in its table of contents, and its commands are the program's own."""

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs/guide"
PAGES = sorted(path.name for path in GUIDE.glob("*.md") if path.name != "SUMMARY.md")


def _commands(page: str) -> list[str]:
    """Lines of fenced blocks that call the program, without what they continue or are piped into."""
    blocks = re.findall(r"```(?:text|sh)\n(.*?)```", (GUIDE / page).read_text(), flags=re.DOTALL)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    calls = [re.search(r"(?:^|^\$ |\| *)(stickslip [a-z].*)", line) for line in lines]
    return [re.split(r" [|>#]", call.group(1))[0].strip() for call in calls if call]


ALL = [pytest.param(command, id=f"{page}: {command}") for page in PAGES for command in _commands(page)]


@pytest.fixture(scope="module")
def bench(demo, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    shutil.copytree(demo, folder / "my")
    return folder


def test_every_page_is_in_the_table_of_contents_once():
    listed = re.findall(r"\]\((.*?)\)", (GUIDE / "SUMMARY.md").read_text())
    assert sorted(listed) == PAGES


def test_there_are_commands():
    assert len(_commands("start.md")) == 4 and len(ALL) > 12


@pytest.mark.parametrize("command", _commands("start.md"))
def test_a_command_of_the_first_page_runs(program, bench, command):
    arguments = [str(Path(program).absolute()), *shlex.split(command)[1:]]
    done = subprocess.run(arguments, cwd=bench, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    if "--report" in command:
        assert (bench / "out/estimate.csv").is_file() and (bench / "report.html").is_file()


@pytest.mark.parametrize("command", ALL)
def test_the_program_has_the_commands_and_options_of_the_guide(program, command):
    _, name, *words = shlex.split(command)
    shown = subprocess.run([program, name, "--help"], capture_output=True, text=True)
    assert shown.returncode == 0, shown.stderr
    for option in (word for word in words if word.startswith("--")):
        assert re.search(rf"{option}\b", shown.stdout), f"{command}: {name} has no {option}"
