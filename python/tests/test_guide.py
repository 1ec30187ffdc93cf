"""Every command of the first guide runs as it stands."""

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def _commands():
    text = (ROOT / "docs/guide/start.md").read_text()
    blocks = re.findall(r"```text\n(.*?)```", text, flags=re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.startswith("stickslip ")]


@pytest.fixture(scope="module")
def bench(demo, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    shutil.copytree(demo, folder / "my")
    return folder


def test_there_are_commands():
    assert len(_commands()) == 4


@pytest.mark.parametrize("command", _commands())
def test_a_command_of_the_guide_runs(program, bench, command):
    arguments = [str(Path(program).absolute()), *shlex.split(command)[1:]]
    done = subprocess.run(arguments, cwd=bench, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    if "--report" in command:
        assert (bench / "out/estimate.csv").is_file() and (bench / "report.html").is_file()
