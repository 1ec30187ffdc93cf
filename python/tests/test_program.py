"""The command that the package installs is the program: bytes, exit codes, signals."""

import importlib.metadata
import signal
import subprocess
import sys
import sysconfig
import time
from functools import partial
from pathlib import Path

import pytest

INSTALLED = Path(sysconfig.get_path("scripts")) / "stickslip"


@pytest.fixture(scope="module")
def installed(program) -> str:
    if not INSTALLED.is_file():
        pytest.skip("the package is not installed: pip install .")
    if Path(program).resolve() == INSTALLED.resolve():
        pytest.skip("no program to compare with: cargo build")
    return str(INSTALLED)


def _run(command, folder, **options):
    return subprocess.run(command, cwd=folder, capture_output=True, **options)


def _untimed(printed: bytes) -> bytes | list[list[bytes]]:
    """All bytes; where a time is among them, the words of the other lines, since its digits set the table's width."""
    timed = b"real-time factor"
    if timed not in printed:
        return printed
    return [line.split() for line in printed.splitlines() if not line.startswith(timed)]


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--version"], 0),
        (["fit", "--help"], 0),
        ([], 2),
        (["filter", "--nothing"], 2),
        (["filter", "nothing.csv", "--scene", "scene.toml"], 1),
        (["check", "scene.toml", "log.csv"], 0),
        (["filter", "log.csv", "--scene", "scene.toml", "--occlude", "200", "--particles", "50"], 0),
        (["fit", ".", "--free", "mu_q", "--out", "fitted"], 1),
    ],
)
def test_the_command_has_the_bytes_and_exit_code_of_the_program(program, installed, demo, words, code):
    program = str(Path(program).absolute())
    theirs, ours = (_run([name, *words], demo) for name in (program, installed))
    module = _run([sys.executable, "-m", "stickslip", *words], demo)
    assert theirs.returncode == ours.returncode == module.returncode == code, ours.stderr.decode()
    assert _untimed(theirs.stdout) == _untimed(ours.stdout) == _untimed(module.stdout)
    assert theirs.stderr == ours.stderr == module.stderr


def test_a_report_says_what_was_typed(program, installed, demo, tmp_path):
    words = ["filter", str(demo / "log.csv"), "--scene", str(demo / "scene.toml"), "--particles", "50"]
    pages = []
    for name, folder in ((program, "theirs"), (installed, "ours")):
        (tmp_path / folder).mkdir()
        command = [str(Path(name).absolute()), *words, "--report", "report.html", "--out", "out"]
        assert _run(command, tmp_path / folder).returncode == 0
        pages.append((tmp_path / folder / "report.html").read_bytes())
    assert pages[0] == pages[1] and b"stickslip filter /" in pages[1]
    files = [(tmp_path / folder / "out/estimate.csv").read_bytes() for folder in ("theirs", "ours")]
    assert files[0] == files[1]


def test_the_package_has_the_licences_of_what_is_compiled_in(installed):
    names = [Path(file).name for file in importlib.metadata.files("stickslip")]
    assert {"LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY-LICENSES.txt"} <= set(names)


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
def test_an_interrupted_command_ends_at_once_as_the_program_does(installed, demo):
    words = ["filter", "log.csv", "--scene", "scene.toml", "--particles", "1000000", "--seed", "1"]
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # a job in the background ignores it
    pipe = subprocess.PIPE
    process = subprocess.Popen([installed, *words], cwd=demo, stdout=pipe, stderr=pipe, preexec_fn=heard)
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == -signal.SIGINT


def test_a_reader_that_leaves_early_is_no_failure(installed, demo):
    command = f"'{installed}' filter log.csv --scene scene.toml --particles 50 --json | head -c 1 >/dev/null; "
    done = subprocess.run(["bash", "-c", command + "echo ${PIPESTATUS[0]}"], cwd=demo, capture_output=True, text=True)
    assert done.stdout == "0\n" and done.stderr == ""
