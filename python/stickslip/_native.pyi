"""Native library of the package. Arguments are checked, not converted."""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypedDict, final

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(ValueError):
    """Invalid input: the value found, the rule, and the next step."""

class Warning(UserWarning):
    """Reason to doubt a result, with the next step."""

@final
class Scene:
    """Content of scene.toml: scene, sensors and filter settings."""

    def __new__(cls, text: str, name: str = "scene.toml") -> Scene:
        """Reads the text of a scene file; ``name`` is shown in errors."""
    @staticmethod
    def from_numbers(**tables: Any) -> Scene:
        """Makes a scene of the tables of ``scene.toml``, as dicts of numbers, texts, lists and arrays.

        ``Scene.from_numbers(gravity=9.81, object={"mass": 0.5, "shape": [...]}, ...)``. Errors are
        those of the reader; ``text`` is the file.
        """
    def replace(self, **values: Any) -> Scene:
        """Returns the scene with other values; comments and layout of ``text`` stay.

        Names: ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m); tables of the file with a dict of the
        keys to change, as ``camera={"latency": 0.02}``; ways of keys, as
        ``**{"pusher.stall_force": 20.0}``. None removes a key. Errors are those of the reader.
        """
    @property
    def text(self) -> str:
        """Text of the file."""
    @property
    def name(self) -> str:
        """Name shown in errors."""
    @property
    def fingers(self) -> int:
        """Number of the other fingers of a hand, besides the pusher."""
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
    force: bool
    threads: int | None

@final
class Tracker:
    def __new__(cls, scene: Scene, options: Mapping[str, Any]) -> Tracker: ...
    def push(self, row: Mapping[str, Any]) -> dict[str, float]: ...
    def estimate(self) -> dict[str, float]: ...
    def particles(self) -> _Columns: ...
    def outcomes(self, fingers: list[list[list[float]]], h: float) -> dict[str, Any]: ...
    def copy(self) -> Tracker: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def observed(self) -> dict[str, bool]: ...
    @property
    def log_evidence(self) -> float: ...
    @property
    def collapses(self) -> int: ...

_Columns = dict[str, NDArray[np.float64]]
_Progress = Callable[[int, int], object]

def read_log(path: os.PathLike[str], scene: Scene | None = None, topics: Sequence[str] = ()) -> _Columns: ...
def write_log(columns: _Columns) -> bytes: ...
def bag_info(path: os.PathLike[str]) -> str: ...
def log_files(path: os.PathLike[str]) -> list[Path]: ...
def check(log: _Columns, scene: Scene) -> list[tuple[str, str, str, str | None]]: ...
def filter(
    log: _Columns, scene: Scene, options: RunArguments, progress: _Progress | None = None
) -> tuple[_Columns, dict[str, Any]]: ...
def particles(
    log: _Columns,
    scene: Scene,
    options: RunArguments,
    rows: Sequence[int] | None = None,
    progress: _Progress | None = None,
) -> tuple[NDArray[np.int64], _Columns]: ...
def comparison_page(
    rows: Sequence[Mapping[str, Any]], on: Sequence[Mapping[str, Any]], options: RunArguments
) -> str: ...
def player(estimate: _Columns, on: Mapping[str, Any]) -> str: ...
def report(on: Mapping[str, Any], progress: _Progress | None = None) -> str: ...
def fit(
    pushes: Sequence[tuple[str, Scene, _Columns]], options: Mapping[str, Any], progress: _Progress | None = None
) -> tuple[str, str, _Columns, str, list[str], str]: ...
def program(words: Sequence[str]) -> int:
    """Runs the program with the words after its name on a command line; returns its exit code."""

def rollout(scene: Scene, arguments: Mapping[str, Any], progress: _Progress | None = None) -> dict[str, Any]: ...
def simulate(
    scene: Scene, options: Mapping[str, Any], progress: _Progress | None = None
) -> tuple[_Columns, _Columns, str, int]: ...
def score(estimate: _Columns, on: Mapping[str, Any]) -> dict[str, Any]: ...
