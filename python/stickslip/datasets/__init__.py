"""Public pushing data as experiment folders.

The package contains no data: :func:`fetch` downloads it. Each importer reads a file as its authors publish
it and writes ``scene.toml`` and ``log.csv``, and ``truth.json`` if something is known of the truth.
All parts of stickslip read these folders. The scene is not in the data. The user gives the text of
``scene.toml``, for example from :func:`scene_text`.
"""

from stickslip.datasets._benchmark import occlusion_benchmark
from stickslip.datasets._fetch import ORIGINS, Origin, fetch
from stickslip.datasets._folder import write_experiment
from stickslip.datasets._mit import import_mit, import_omnipush
from stickslip.datasets._scene import scene_text, uniform_plate
from stickslip.datasets._streams import Stream, log_of_streams, planar
from stickslip.datasets._table import import_csv
from stickslip.datasets._zhou import import_two_finger, import_two_finger_set, read_alternating, two_finger_scene

__all__ = [
    "ORIGINS",
    "Origin",
    "Stream",
    "fetch",
    "import_csv",
    "import_mit",
    "import_omnipush",
    "import_two_finger",
    "import_two_finger_set",
    "log_of_streams",
    "occlusion_benchmark",
    "planar",
    "read_alternating",
    "scene_text",
    "two_finger_scene",
    "uniform_plate",
    "write_experiment",
]
