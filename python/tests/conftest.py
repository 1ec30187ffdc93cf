"""What tests share: the demo experiment, recorded data, and the program ``stickslip``."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

import stickslip

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def demo() -> Path:
    """An experiment folder with truth: an L-shaped plate, a disc that pushes it, three fixels."""
    return ROOT / "crates/testkit/experiments/slide-ell-disc-110"


@pytest.fixture(scope="session")
def scene(demo: Path) -> stickslip.Scene:
    return stickslip.load_scene(demo / "scene.toml")


@pytest.fixture(scope="session")
def data() -> Path:
    """Recorded experiments."""
    folder = Path(os.environ.get("STICKSLIP_DATA", ROOT.parent / "shared/data"))
    if not folder.is_dir():
        if os.environ.get("STICKSLIP_REQUIRE_DATA"):
            pytest.fail(f"no recorded experiments at {folder}")
        pytest.skip("no recorded experiments: set STICKSLIP_DATA")
    return folder


@pytest.fixture(scope="session")
def program() -> str:
    """The program: ``STICKSLIP_PROGRAM``, one that cargo built, or one on the path."""
    built = [ROOT / "target" / profile / "stickslip" for profile in ("release", "debug")]
    named = [os.environ.get("STICKSLIP_PROGRAM"), *(str(path) for path in built if path.is_file())]
    found = next((path for path in named if path), None) or shutil.which("stickslip")
    if found is None:
        pytest.skip("no program stickslip: cargo build, or set STICKSLIP_PROGRAM")
    if b"--features camera" in subprocess.run([found, "track"], capture_output=True).stderr:
        pytest.skip("the program lacks what the package has: cargo build --release --features camera,png")
    return found
