"""Simulated experiments with known truth."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from stickslip import _native
from stickslip._columns import Columns
from stickslip._files import scene_of
from stickslip._native import Error, Scene
from stickslip._options import Progress
from stickslip._warnings import warn


@dataclass(frozen=True)
class Simulation:
    """A simulated experiment."""

    #: Scene of the simulation.
    scene: Scene
    #: Columns of ``log.csv``: the measurements.
    log: Columns
    #: Columns of ``truth.csv``: ``time``, ``x``, ``y``, ``theta``, twists, forces; exact.
    truth: Columns
    #: Content of ``truth.json``: true friction, first contacts, ``occlude_from``.
    facts: dict[str, Any]

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes scene.toml, log.csv, truth.csv and truth.json into a new or empty folder."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise Error(f"{folder} is not empty; give a new folder, so that nothing recorded is lost")
        (folder / "scene.toml").write_text(self.scene.text, encoding="utf-8")
        (folder / "log.csv").write_bytes(_native.write_log(self.log))
        (folder / "truth.json").write_text(json.dumps(self.facts, indent=2) + "\n", encoding="utf-8")
        rows = np.column_stack(list(self.truth.values()))
        text = "\n".join(",".join(repr(float(value)) for value in row) for row in rows)
        (folder / "truth.csv").write_text(",".join(self.truth) + "\n" + text + "\n", encoding="utf-8")


def simulate(
    scene: Scene | str | os.PathLike[str],
    *,
    physics: Literal["testbed", "model"] = "testbed",
    seed: int = 0,
    rig_seed: int | None = None,
    noise_seed: int | None = None,
    rate: float = 30.0,
    friction: Mapping[str, float] | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """Simulates the experiment that the scene's ``[start]`` describes.

    ``physics``: ``testbed``, a rig with compliant contacts, uneven friction and a lagging drive, or
    ``model``, the filter's own contact dynamics without noise. ``seed``: of all random numbers;
    ``rig_seed`` of the rig alone, ``noise_seed`` of the sensors' noise alone. ``rate``: frames per
    second (Hz). ``friction``: true ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m); the scene's values
    by default.
    ``progress``: gets the finished frames and all frames.
    """
    true = dict(friction or {})
    unknown = sorted(set(true) - {"mu_s", "mu_p", "mu_f", "d_tri"})
    if unknown:
        raise Error(f"friction has a `{unknown[0]}`; it may have mu_s, mu_p, mu_f, d_tri")
    known = scene_of(scene)
    log, truth, facts, unsolved = _native.simulate(
        known,
        {
            "physics": physics,
            "rig_seed": seed if rig_seed is None else rig_seed,
            "noise_seed": seed if noise_seed is None else noise_seed,
            "rate": rate,
            "mu_s": true.get("mu_s"),
            "mu_p": true.get("mu_p"),
            "mu_f": true.get("mu_f"),
            "d_tri": true.get("d_tri"),
        },
        progress,
    )
    if unsolved:
        warn([f"{unsolved} steps have no certified solution"])
    return Simulation(known, log, truth, json.loads(facts))
