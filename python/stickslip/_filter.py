"""Estimates, particles and samples of one method on one log."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip import _native
from stickslip._columns import Columns, Log
from stickslip._estimate import Estimate
from stickslip._files import log_of, scene_of
from stickslip._native import Error, Scene
from stickslip._options import FilterOptions, arguments, with_options
from stickslip._page import run_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_options
def filter(log: Log, scene: Scene | str | os.PathLike[str], **options: Unpack[FilterOptions]) -> Estimate:
    """Tracks the object of a log.

    ``log``: path of a log (see :func:`stickslip.load_log`), dict of columns, or data frame, with
    the columns of ``log.csv``. NaN, None and masked values are missing measurements. ``scene``: a
    scene, or the path of its file.

    Reasons to doubt the estimate are issued as :class:`stickslip.Warning`, as the program prints
    them, and kept as ``warnings``. Ctrl-C ends the call.

    Returns the columns of ``estimate.csv``, each (rows,), one row per log row, with the bits of the
    program's file, and facts of the run (see :class:`Estimate`). NaN: the method has no value.

    - ``time`` (s)
    - pose: ``x``, ``y`` (m), ``theta`` (rad, unwrapped)
    - twist: ``vx``, ``vy`` (m/s), ``omega`` (rad/s)
    - friction ``mu_s``, ``mu_p``, ``mu_f`` and tripod radius ``d_tri`` (m)
    - posterior contact probabilities: ``contact_pusher``, ``contact_1``, ...
    - standard deviations: ``std_x``, ...
    - effective sample size ``ess``; ``resampled`` and ``visual`` (0 or 1)
    - ``unsolved``: particles without a certified solution; ``failed``: those of them whose solver
      gave up
    - covariances: ``cov_x_y``, ``cov_x_theta``, ``cov_y_theta``
    - ``collapsed`` (0 or 1); surviving particles ``distinct`` and ``ancestors``
    - number of ``modes``; weight and pose of the likeliest mode: ``mode_weight``, ``mode_x``,
      ``mode_y``, ``mode_theta``
    - probability of each contact mode: ``stick_pusher``, ``left_pusher``, ``right_pusher``,
      ``stick_1``, ...
    - probability that the object is held (frictional form closure): ``p_held``

    Raises :class:`stickslip.Error` if log, scene or options are invalid, and without ``force`` also
    if units, frames or columns are found to be wrong.
    """
    known = scene_of(scene)
    table = log_of(log, known)
    columns, facts = _native.filter(table, known, arguments(options), options.get("progress"))
    return Estimate(columns, facts, run_of(table, known, options))


@with_options
def particles(
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    rows: Sequence[int] | None = None,
    **options: Unpack[FilterOptions],
) -> dict[str, NDArray[np.float64]]:
    """Returns the particles of the particle filter after the rows in ``rows`` (None: all rows).

    ``row`` (R,) has the rows with particles, in rising order. Rows before the first object pose
    have none. The other arrays are (R, N), with weights that sum to 1 in a row: ``weight``, ``x``,
    ``y`` (m), ``theta`` (rad), ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m).

    Offsets of the rig and positions of the feet are not included.
    """
    if options.get("method", "particle") != "particle":
        raise Error(f"method is `{options.get('method')}`; only `particle` has particles")
    known = scene_of(scene)
    table = log_of(log, known)
    wanted = None if rows is None else _places(rows, table)
    kept, columns = _native.particles(table, known, arguments(options), wanted, options.get("progress"))
    shape = (len(kept), -1 if len(kept) else 0)
    return {"row": kept.astype(np.float64)} | {name: column.reshape(shape) for name, column in columns.items()}


@with_options
def samples(
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    rows: Sequence[int],
    chains: int = 4,
    draws: int | None = None,
    **options: Unpack[FilterOptions],
) -> dict[str, NDArray[np.float64]]:
    """Draws samples of equal weight from the posterior after some rows, in the shape of ArviZ.

    Chain c is a separate filter with the seed ``seed + c``. Its ``draws`` samples (None: one per
    particle) are drawn from its particles by systematic resampling. The samples are not a sequence:
    chains can be compared (R-hat), autocorrelation has no meaning. Pose and friction of a sample
    are those of one particle.

    Returns ``x``, ``y`` (m), ``theta`` (rad), ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m), each
    (chains, draws, R) for the R rows in ``rows``. ArviZ 1.0 and later takes them by
    ``arviz.from_dict({"posterior": samples})``, older versions by
    ``arviz.from_dict(posterior=samples)``.
    """
    scene = scene_of(scene)
    columns = log_of(log, scene)
    seed = options.get("seed", 0)
    per_chain: list[dict[str, NDArray[np.float64]]] = []
    for chain in range(chains):
        own = FilterOptions(**{**options, "seed": seed + chain})
        cloud = particles(columns, scene, rows=rows, **own)
        missing = sorted({int(row) for row in rows} - {int(row) for row in cloud["row"]})
        if missing:
            raise Error(f"row {missing[0]} has no particles; rows go from the first object pose to the last row")
        order = np.searchsorted(cloud["row"], np.asarray(rows, dtype=np.float64))
        per_chain.append(_drawn(cloud, order, draws, seed + chain))
    return {name: np.stack([chain[name] for chain in per_chain]) for name in per_chain[0]}


def _drawn(
    cloud: dict[str, NDArray[np.float64]], order: NDArray[np.intp], draws: int | None, seed: int
) -> dict[str, NDArray[np.float64]]:
    """Draws joint samples (draws, R) of pose and friction."""
    picked = [_systematic(cloud["weight"][row], draws, seed) for row in order]
    return {
        name: np.stack([cloud[name][row, pick] for row, pick in zip(order, picked, strict=True)], axis=-1)
        for name in ("x", "y", "theta", "mu_s", "mu_p", "mu_f", "d_tri")
    }


def _systematic(weights: NDArray[np.float64], draws: int | None, seed: int) -> NDArray[np.intp]:
    """Returns particle indices (draws,) by systematic resampling, in random order."""
    count = len(weights) if draws is None else draws
    rng = np.random.default_rng(seed)
    places = (np.arange(count) + rng.random()) / count
    picked = np.searchsorted(np.cumsum(weights), places).clip(max=len(weights) - 1)
    return rng.permutation(picked)


def _places(rows: Sequence[int], log: Columns) -> list[int]:
    """Returns the numbers of rows of a log; refuses others."""
    count = len(next(iter(log.values())))
    try:
        places = [operator.index(row) for row in rows]
    except TypeError as error:
        raise Error(f"rows is {rows!r}; give a list of row numbers") from error
    wrong = [place for place in places if not 0 <= place < count]
    if wrong:
        raise Error(f"rows has {wrong[0]}; the log's rows go from 0 to {count - 1}")
    return places
