"""Tracks a pushed object through contact and occlusion, and simulates pushes by the thousand.

All numbers are in SI units (m, rad, s, kg, N). Angles are counter-clockwise and not wrapped. A log
is a dict of columns as in ``log.csv``, a path, or a data frame. An estimate is a dict of columns as
in ``estimate.csv``. NaN marks an empty cell. The same input and seed give the bits of the program
``stickslip``, on any number of threads.

Invalid input raises :class:`Error`. Reasons to doubt a result are issued as :class:`Warning`.

>>> import stickslip
>>> scene = stickslip.load_scene("my/scene.toml")  # doctest: +SKIP
>>> estimate = stickslip.filter("my/log.csv", scene, occlude=60)  # doctest: +SKIP
>>> estimate["x"], estimate["std_x"]  # doctest: +SKIP
"""

from stickslip._check import Finding, check
from stickslip._columns import Columns, Log
from stickslip._compare import Comparison, compare
from stickslip._estimate import Estimate
from stickslip._files import Topics, info, load_log, load_scene, load_truth
from stickslip._filter import filter, particles, samples
from stickslip._fit import Fit, fit
from stickslip._native import Error, Scene, Warning, __version__
from stickslip._options import FilterOptions, Progress
from stickslip._outline import Outlines, Polygons, outlines
from stickslip._page import Page, report
from stickslip._rollout import Rollout, rollout
from stickslip._score import score
from stickslip._simulate import Simulation, simulate
from stickslip._tracker import Outcomes, Row, Tracker, rows

__all__ = [
    "Columns",
    "Comparison",
    "Error",
    "Estimate",
    "FilterOptions",
    "Finding",
    "Fit",
    "Log",
    "Outcomes",
    "Outlines",
    "Page",
    "Polygons",
    "Progress",
    "Rollout",
    "Row",
    "Scene",
    "Simulation",
    "Topics",
    "Tracker",
    "Warning",
    "__version__",
    "check",
    "compare",
    "filter",
    "fit",
    "info",
    "load_log",
    "load_scene",
    "load_truth",
    "outlines",
    "particles",
    "report",
    "rollout",
    "rows",
    "samples",
    "score",
    "simulate",
]
