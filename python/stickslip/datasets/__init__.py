"""Public pushing data as experiment folders.

Users download; nothing is shipped. Each importer reads a file as its authors publish it and writes
``scene.toml`` and ``log.csv`` (``truth.json`` where something is known), which every part of stickslip
takes. What a file does not hold, the scene, is the user's: a text of ``scene.toml``, best begun with
:func:`scene_text`.
"""

from stickslip.datasets._benchmark import occlusion_benchmark
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._mit import import_mit, import_omnipush
from stickslip.datasets._scene import scene_text, uniform_plate
from stickslip.datasets._streams import Stream, log_of_streams, planar
from stickslip.datasets._table import import_csv
from stickslip.datasets._zhou import import_two_finger, read_alternating

__all__ = [
    "Stream",
    "import_csv",
    "import_mit",
    "import_omnipush",
    "import_two_finger",
    "log_of_streams",
    "occlusion_benchmark",
    "planar",
    "read_alternating",
    "scene_text",
    "uniform_plate",
    "write_experiment",
]
