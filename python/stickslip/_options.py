"""Options of a run on a log."""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, TypeAlias, TypedDict, TypeVar, get_type_hints

from stickslip._native import Error

if TYPE_CHECKING:
    from stickslip._native import RunArguments

#: Function of what is done and of the total. An exception in it ends the call.
Progress: TypeAlias = Callable[[int, int], object]

_Function = TypeVar("_Function", bound=Callable[..., object])


class FilterOptions(TypedDict, total=False):
    """Options of a run on a log, with the defaults of the program:

    - ``method``: ``particle`` (default), ``kalman`` (constant velocity, no contact),
      ``kalman-stops`` (``kalman``, at rest from the first touch in an occlusion), ``with-pusher``
      (glued to the pusher in an occlusion), ``extended-kalman`` (contact dynamics, no touch) or
      ``nominal`` (simulation from the first pose)
    - ``model``: of the particle filter, ``robust`` (default) or ``paper`` (as published)
    - ``particles``: their number, 500 by default
    - ``seed``: of all random numbers, 0 by default
    - ``tactile``: True (default) to use tactile readings
    - ``causal``: True to track the pusher without later rows, as live; False by default
    - ``substeps``: their number from row to row; None: by the length of the step
    - ``occlude``: rows with a hidden object pose, ``60`` (from row 60 on) or ``(60, 90)`` (90
      excluded)
    - ``occlude_middle``: length of an occlusion about the middle of the log (s)
    - ``force``: True to run also if units, frames or columns are found to be wrong; False by
      default
    - ``threads``: their number; None: as many as help. Results do not depend on it
    - ``progress``: called with the finished rows and all rows, some twenty times a second, and at
      the end
    """

    method: Literal["particle", "kalman", "kalman-stops", "with-pusher", "extended-kalman", "nominal"]
    model: Literal["robust", "paper"]
    particles: int
    seed: int
    tactile: bool
    causal: bool
    substeps: int | None
    occlude: int | tuple[int, int | None] | None
    occlude_middle: float | None
    force: bool
    threads: int | None
    progress: Progress | None


#: Every option with its default.
DEFAULTS = FilterOptions(
    method="particle",
    model="robust",
    particles=500,
    seed=0,
    tactile=True,
    causal=False,
    substeps=None,
    occlude=None,
    occlude_middle=None,
    force=False,
    threads=None,
    progress=None,
)


def with_options(function: _Function) -> _Function:
    """Names each option in the signature and the documentation of a function of ``**options``."""
    signature = inspect.signature(function)
    own = [given for given in signature.parameters.values() if given.kind is not given.VAR_KEYWORD]
    options = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for (name, annotation), default in zip(get_type_hints(FilterOptions).items(), DEFAULTS.values(), strict=True)
    ]
    function.__signature__ = signature.replace(parameters=[*own, *options])  # type: ignore[attr-defined]
    function.__doc__ = f"{inspect.getdoc(function)}\n\n{inspect.getdoc(FilterOptions)}\n"
    return function


def arguments(options: FilterOptions) -> RunArguments:
    """Returns the options with their defaults, as the library takes them."""
    unknown = sorted(set(options) - set(DEFAULTS))
    if "mode" in unknown:
        raise Error("option `mode` is called `model`: `robust` (formerly contact) or `paper`")
    if unknown:
        raise Error(f"there is no option `{unknown[0]}`; there are {', '.join(DEFAULTS)}")
    given = DEFAULTS | options
    return {
        "method": given["method"],
        "model": given["model"],
        "particles": given["particles"],
        "seed": given["seed"],
        "tactile": given["tactile"],
        "causal": given["causal"],
        "substeps": given["substeps"],
        "occlude": _rows(given["occlude"]),
        "occlude_middle": given["occlude_middle"],
        "force": given["force"],
        "threads": given["threads"],
    }


def _rows(occlude: int | tuple[int, int | None] | None) -> tuple[int, int | None] | None:
    """Returns the first hidden row and the first visible one after it."""
    if occlude is None:
        return None
    rule = f"occlude is {occlude!r}; give the first hidden row, from 0, or that and the first visible one after it"
    try:
        first, last = occlude if isinstance(occlude, tuple) else (occlude, None)
        first, last = operator.index(first), None if last is None else operator.index(last)
    except (TypeError, ValueError) as error:
        raise Error(rule) from error
    if first < 0 or (last is not None and last <= first):
        raise Error(rule)
    return first, last
