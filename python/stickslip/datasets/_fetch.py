"""Download of public data at a fixed commit."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

from stickslip._native import Error


@dataclass(frozen=True)
class Origin:
    """A folder of a public git repository at one commit.

    The commit's hash is the checksum: git refuses files that differ from it.
    """

    url: str
    commit: str
    folder: str
    licence: str


#: Data that the importers read.
ORIGINS = {
    "two-finger": Origin(
        "https://github.com/robinzhoucmu/PlanarManipulationToolBox",
        "09b70a4caff8300a021d12388d4ca8c897c68456",
        "differential_flat/exp_data/robot_exp_logs",
        "GPL-2.0",
    ),
    "mlab": Origin(
        "https://github.com/robinzhoucmu/MLab_EXP",
        "4d86db9438203f51c4368e5b886def5c402955f3",
        "",
        "Apache-2.0",
    ),
    "limit-surface": Origin(
        "https://github.com/robinzhoucmu/Pushing",
        "1ff9b01c345c205372ca59f29e9d12af7592844e",
        "",
        "Apache-2.0",
    ),
}


def fetch(data: str | Origin, out: str | os.PathLike[str]) -> Path:
    """Downloads public data with git into the new folder ``out``, and returns the data's folder.

    ``data``: a name of ``ORIGINS``, or an origin of your own.

    - ``two-finger``: runs for :func:`import_two_finger_set` (Zhou and Mason, ISRR 2017)
    - ``mlab``: files for :func:`read_alternating` (Zhou et al., ICRA 2016)
    - ``limit-surface``: the MIT pushes as Zhou, Bagnell and Mason evaluate them (RSS 2017)

    The data have the licence of their authors, which ``ORIGINS[data].licence`` names.
    """
    if isinstance(data, str):
        if data not in ORIGINS:
            raise Error(f"there are no data `{data}`; there are {', '.join(ORIGINS)}")
        data = ORIGINS[data]
    out = Path(out)
    if out.exists() and any(out.iterdir()):
        raise Error(f"{out} is not empty; give a new folder")
    out.mkdir(parents=True, exist_ok=True)
    steps = [
        ["init", "--quiet"],
        ["remote", "add", "origin", data.url],
        # files outside the folder are not downloaded
        *([["sparse-checkout", "set", data.folder]] if data.folder else []),
        ["fetch", "--quiet", "--depth=1", "--filter=blob:none", "origin", data.commit],
        ["checkout", "--quiet", data.commit],
    ]
    for step in steps:
        try:
            done = subprocess.run(["git", "-C", str(out), *step], capture_output=True, text=True, check=False)
        except FileNotFoundError as error:
            raise Error("`git` is not installed; it downloads data and checks them") from error
        if done.returncode != 0:
            raise Error(f"{data.url}: git {step[0]} failed: {done.stderr.strip()}; delete {out} and try again")
    folder = out / data.folder
    if not folder.is_dir():
        raise Error(f"{data.url}: commit {data.commit} has no folder `{data.folder}`")
    return folder
