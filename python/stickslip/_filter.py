"""One method over one log: estimates, particles, samples."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from stickslip import _native
from stickslip._columns import Columns, Log
from stickslip._files import log_of, scene_of
from stickslip._native import Error, Scene

if TYPE_CHECKING:
    from stickslip._native import RunArguments


class FilterOptions(TypedDict, total=False):
    """How a log is run; the defaults are those of the program."""

    #: ``particle`` (default), ``kalman`` (knows nothing of contact), ``kalman-stops`` (the same, stops at touch),
    #: ``with-pusher`` (moves with it), ``extended-kalman`` (knows contact, feels no touch) or ``nominal`` (looks once).
    method: Literal["particle", "kalman", "kalman-stops", "with-pusher", "extended-kalman", "nominal"]
    #: Rules of the particle filter: ``contact`` (default) or ``paper``.
    model: Literal["robust", "paper"]
    #: Number of particles, 500 by default.
    particles: int
    #: Seed of all random numbers, 0 by default.
    seed: int
    #: Whether tactile readings count, True by default.
    tactile: bool
    #: Whether the pusher is tracked from the rows so far only, as live; False by default.
    causal: bool
    #: Forced number of substeps from row to row; None: by the length of the step.
    substeps: int | None
    #: Rows whose object pose is hidden from the method: ``60`` (from there on) or ``(60, 90)`` (90 excluded).
    occlude: int | tuple[int, int | None] | None
    #: Length of a blackout about the middle of the log (s).
    occlude_middle: float | None
    #: Threads; None: as many as help. They change no bit.
    threads: int | None


def filter(log: Log, scene: Scene | str | os.PathLike[str], **options: Unpack[FilterOptions]) -> Columns:
    """Tracks the object of a log.

    ``log``: path of ``log.csv`` or ``log.mcap``, dict of columns, or data frame, in the columns of
    ``log.csv`` (see :func:`stickslip.load_log`). ``scene``: a scene, or the path of its file. ``options``: see
    :class:`FilterOptions`.

    Returns the columns of ``estimate.csv``, each (rows,), one row per log row: ``time`` (s); pose ``x``,
    ``y`` (m), ``theta`` (rad, unwrapped); twist ``vx``, ``vy`` (m/s), ``omega`` (rad/s); friction
    ``mu_s``, ``mu_p``, ``mu_f`` and tripod radius ``d_tri`` (m); posterior probabilities of contact
    ``contact_pusher``, ``contact_1``, ...; standard deviations ``std_x``, ...; effective sample size
    ``ess``; ``resampled`` and ``visual`` (0 or 1); particles without a certified solution ``unsolved``
    and, of them, ``failed``; covariances ``cov_x_y``, ``cov_x_theta``, ``cov_y_theta``; ``collapsed`` (0 or 1);
    surviving particles ``distinct`` and ``ancestors``; the number of ``modes``, weight and pose of the likeliest
    one, ``mode_weight``, ``mode_x``, ``mode_y``, ``mode_theta``; and how the object slips on what it touches,
    ``stick_pusher``, ``left_pusher``, ``right_pusher``, ``stick_1``, ... NaN where the method has no value. The
    numbers have the bits of those in the program's ``estimate.csv``.

    Raises :class:`stickslip.Error` where log, scene or options cannot be used.
    """
    return _native.filter(log_of(log), scene_of(scene), arguments(options))


def particles(
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    rows: Sequence[int] | None = None,
    **options: Unpack[FilterOptions],
) -> dict[str, NDArray[np.float64]]:
    """The particles of the particle filter after the rows in ``rows`` (None: all rows).

    Returns ``row`` (R,), the rows that have particles, rising; ``weight``, ``x``, ``y`` (m), ``theta``
    (rad), ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m), each (R, N), of the particles that say where the object is.
    The friction of the estimate is learned by others in contact mode: ``friction_weight``, ``friction_mu_s``,
    ``friction_mu_p``, ``friction_mu_f``, ``friction_d_tri``, each (R, N), as they were when the camera last saw the
    object move; in paper mode, and where friction is told exactly, by the same. Weights of a row sum to 1. Rows
    before the first object pose have none. Offsets of the rig and where each one's feet stand are not among them.
    """
    if options.get("method", "particle") != "particle":
        raise Error(f"method is `{options.get('method')}`; only `particle` has particles")
    wanted = None if rows is None else [int(row) for row in rows]
    kept, columns = _native.particles(log_of(log), scene_of(scene), arguments(options), wanted)
    shape = (len(kept), -1 if len(kept) else 0)
    return {"row": kept.astype(np.float64)} | {name: column.reshape(shape) for name, column in columns.items()}


def samples(
    log: Log,
    scene: Scene | str | os.PathLike[str],
    *,
    rows: Sequence[int],
    chains: int = 4,
    draws: int | None = None,
    **options: Unpack[FilterOptions],
) -> dict[str, NDArray[np.float64]]:
    """Samples of equal weight from the posterior after some rows, as ArviZ takes them.

    Chain c is a filter of its own with the seed ``seed + c``; its ``draws`` samples (None: one per
    particle) are drawn from its particles by systematic resampling, so they are not in sequence: chains
    can be compared (R-hat), autocorrelation has no meaning. In contact mode friction is learned by particles of its
    own: samples of friction go together, and those of the pose, but not these with those.

    Returns ``x``, ``y`` (m), ``theta`` (rad), ``mu_s``, ``mu_p``, ``mu_f``, ``d_tri`` (m), each
    (chains, draws, R) for the R rows in ``rows``: ``arviz.from_dict({"posterior": samples})``, before
    ArviZ 1.0 ``arviz.from_dict(posterior=samples)``.
    """
    columns, scene = log_of(log), scene_of(scene)
    seed = options.get("seed", 0)
    per_chain: list[dict[str, NDArray[np.float64]]] = []
    for chain in range(chains):
        own = FilterOptions(**{**options, "seed": seed + chain})
        cloud = particles(columns, scene, rows=rows, **own)
        missing = sorted({int(row) for row in rows} - {int(row) for row in cloud["row"]})
        if missing:
            raise Error(f"row {missing[0]} has no particles; rows go from the first object pose to the last row")
        order = np.searchsorted(cloud["row"], np.asarray(rows, dtype=np.float64))
        per_chain.append(
            _drawn(cloud, ("x", "y", "theta"), "", order, draws, (seed + chain, 0))
            | _drawn(cloud, ("mu_s", "mu_p", "mu_f", "d_tri"), "friction_", order, draws, (seed + chain, 1))
        )
    return {name: np.stack([chain[name] for chain in per_chain]) for name in per_chain[0]}


def _drawn(
    cloud: dict[str, NDArray[np.float64]],
    names: Sequence[str],
    prefix: str,
    order: NDArray[np.intp],
    draws: int | None,
    seed: tuple[int, int],
) -> dict[str, NDArray[np.float64]]:
    """Samples (draws, R) of each of ``names``, which go together, from the columns with ``prefix`` before them."""
    picked = [_systematic(cloud[f"{prefix}weight"][row], draws, seed) for row in order]
    return {
        name: np.stack([cloud[prefix + name][row, pick] for row, pick in zip(order, picked, strict=True)], axis=-1)
        for name in names
    }


def _systematic(weights: NDArray[np.float64], draws: int | None, seed: tuple[int, int]) -> NDArray[np.intp]:
    """Indices (draws,) of particles, each as often as its weight says, to one; in random order."""
    count = len(weights) if draws is None else draws
    rng = np.random.default_rng(seed)
    places = (np.arange(count) + rng.random()) / count
    picked = np.searchsorted(np.cumsum(weights), places).clip(max=len(weights) - 1)
    return rng.permutation(picked)


def arguments(options: FilterOptions) -> RunArguments:
    """The options with their defaults, as the library takes them."""
    unknown = sorted(set(options) - set(FilterOptions.__annotations__))
    if "mode" in unknown:
        raise TypeError("option `mode` is called `model`: `robust` (formerly contact) or `paper`")
    if unknown:
        known = ", ".join(FilterOptions.__annotations__)
        raise TypeError(f"there is no option `{unknown[0]}`; there are {known}")
    return {
        "method": options.get("method", "particle"),
        "model": options.get("model", "robust"),
        "particles": options.get("particles", 500),
        "seed": options.get("seed", 0),
        "tactile": options.get("tactile", True),
        "causal": options.get("causal", False),
        "substeps": options.get("substeps"),
        "occlude": _rows(options.get("occlude")),
        "occlude_middle": options.get("occlude_middle"),
        "threads": options.get("threads"),
    }


def _rows(occlude: int | tuple[int, int | None] | None) -> tuple[int, int | None] | None:
    """First hidden row and the first visible one after it."""
    if occlude is None:
        return None
    rule = f"occlude is {occlude!r}; give the first hidden row, from 0, or that and the first visible one after it"
    try:
        first, last = occlude if isinstance(occlude, tuple) else (operator.index(occlude), None)
    except (TypeError, ValueError) as error:
        raise Error(rule) from error
    if first < 0 or (last is not None and last <= first):
        raise Error(rule)
    return first, last
