"""Functions that workers of other processes import in tests of studies."""

import os
import signal
from pathlib import Path

import stickslip


def square(x, **_):
    """A result, or an error for 13."""
    if x == 13:
        raise ValueError("13 is unlucky")
    return {"square": x * x}


def die_once(x, folder):
    """Kills its worker the first time that 3 comes."""
    mark = Path(folder) / "died"
    if x == 3 and not mark.exists():
        mark.write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return {"square": x * x}


def die(x):
    """Kills its worker whenever 3 comes."""
    if x == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"square": x * x}


def writers(x, folder):
    """The worker's process, and the number of files of the study that it sees."""
    return {"pid": os.getpid(), "files": len(list(Path(folder).iterdir()))}


def fit_object(folder):
    """The fit of one object, as the guide has it."""
    return stickslip.fit(folder, ["mu_p"], folds=0, threads=1).result


def no_json(x):
    """A result that JSON cannot represent."""
    return {"x": object()}
