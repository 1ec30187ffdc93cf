"""Native library of the package. Arguments are checked, not converted."""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict, final

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(ValueError):
    """Invalid input: the value found, the rule, and the next step."""

@final
class Scene:
    """Content of scene.toml: scene, sensors and filter settings."""

    def __new__(cls, text: str, name: str = "scene.toml") -> Scene:
        """Reads the text of a scene file; ``name`` is shown in errors."""
    @property
    def text(self) -> str:
        """Text of the file."""
    @property
    def name(self) -> str:
        """Name shown in errors."""
    @property
    def fixels(self) -> int:
        """Number of fixels."""
    @property
    def friction(self) -> dict[str, float]:
        """Nominal mu_s, mu_p, mu_f, d_tri (m); d_tri is NaN where the feet are known."""
    @property
    def virtual_radius(self) -> float:
        """Weight of an angle in scores: the object's radius of gyration (m)."""

    def drawn_friction(self, normals: NDArray[np.float64]) -> NDArray[np.float64]:
        """Maps standard normal numbers (K, 4) to mu_s, mu_p, mu_f, d_tri of the prior."""

class RunArguments(TypedDict):
    method: str
    model: str
    particles: int
    seed: int
    tactile: bool
    causal: bool
    substeps: int | None
    occlude: tuple[int, int | None] | None
    occlude_middle: float | None
    threads: int | None

@final
class Tracker:
    def __new__(cls, scene: Scene, options: Mapping[str, Any]) -> Tracker: ...
    def push(self, row: Mapping[str, Any]) -> dict[str, float]: ...
    def estimate(self) -> dict[str, float]: ...
    @property
    def collapses(self) -> int: ...

def read_log(data: bytes, name: str) -> dict[str, NDArray[np.float64]]: ...
def write_log(columns: dict[str, NDArray[np.float64]]) -> bytes: ...
def filter(
    log: dict[str, NDArray[np.float64]], scene: Scene, options: RunArguments
) -> dict[str, NDArray[np.float64]]: ...
def particles(
    log: dict[str, NDArray[np.float64]],
    scene: Scene,
    options: RunArguments,
    rows: Sequence[int] | None = None,
) -> tuple[NDArray[np.int64], dict[str, NDArray[np.float64]]]: ...
def fit(
    pushes: Sequence[tuple[str, Scene, dict[str, NDArray[np.float64]]]], options: Mapping[str, Any]
) -> tuple[str, str, dict[str, NDArray[np.float64]], str]: ...
def program(words: Sequence[str]) -> int:
    """Runs the program with the words after its name on a command line; returns its exit code."""

def rollout(scene: Scene, h: float, arrays: Mapping[str, Any], threads: int | None = None) -> dict[str, Any]: ...
def simulate(
    scene: Scene, options: Mapping[str, Any]
) -> tuple[dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]], str]: ...
def score(estimate: dict[str, NDArray[np.float64]], on: Mapping[str, Any]) -> dict[str, float]: ...
