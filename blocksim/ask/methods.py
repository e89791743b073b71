"""Methods: which there are, what each sees, which one a question needs.

`METHODS` go from the cheapest to the dearest, and each says how fine a
bracket it is good for, both as measured (`analysis/costs.py`).
So `auto` is the first of them that sees what is asked to that width.
`theory` is passed over: it is of the continuous arch, which n voussoirs differ from by up to
33/n^2, and no cheaper, since answers state both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, cast

from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.later import Later
from blocksim.engines import ENGINES, NAMES, engine_named, make_known
from blocksim.engines.base import Engine, Method
from blocksim.kinds.offers import offers_of
from blocksim.limit.bearing import bears
from blocksim.simulation.simulated import BY_RULE, Overrides, require_setting

if TYPE_CHECKING:
    from blocksim.simulation.merging import Merging

_STATICS = (
    Method(
        name="theory",
        sees="the continuous arch: least thickness, mode, thrust, hinge and sliding angles",
        finest=0.0,
    ),
    Method(
        name="limit",
        sees="the arch as built: the same, and the joints that turn or slide",
        finest=0.0,
        moves_supports=True,
        chart={"voussoirs": (7, 13, 27, 53, 101, 201, 401)},
        colour="#E69F00",
        tint="#fbeccc",
        marker="v",
    ),
)
STATIC = tuple(method.name for method in _STATICS)
METHODS = Later[Method](
    {method.name: partial(_STATICS.__getitem__, k) for k, method in enumerate(_STATICS)}
    | {name: partial(ENGINES.__getitem__, name) for name in NAMES},
    beyond=ENGINES,
)
CHOICES = ("auto", *METHODS.shipped)
"""What comes with blocksim; `METHODS` has engines of one's own, too."""


def choose(
    method: str | Method,
    tol: float = 0.0,
    *,
    problem: Problem[Any] | None = None,
    moving: bool = False,
    settings: Overrides = BY_RULE,
    reduce: bool | None = None,
) -> Method:
    """Return the method asked for; for `auto` the cheapest that can answer.

    `method`: One of `CHOICES`; an engine of one's own by its name, as ``module:ENGINE``, or
        itself.
    `tol`: Relative width of the bracket asked for, 0 where there is none.
    `problem`: What the question is about, where it is known; an upright arch, if not.
    `moving`: Whether it is of motion at all.
    `reduce`: Whether no more blocks are to be simulated than it takes; see `reduces`.
    """
    auto = method == "auto"
    chosen = _cheapest(tol, problem, moving=moving) if auto else _named(method)
    beyond = _beyond(chosen, problem)
    if beyond:
        raise InputError("method", chosen.name, beyond)
    if moving and chosen.is_static:
        able = ", ".join(each.name for each in _shipped() if not _beyond(each, problem))
        raise InputError("method", chosen.name, f"one of {able}: {chosen.name} moves no blocks")
    still = problem is None or problem.has_statics
    in_space = problem is not None and problem.in_space
    able = chosen.name == "limit" if in_space else _can_reduce(chosen)
    if reduce and not (still and able):
        names = ", ".join(each.name for each in _shipped() if _can_reduce(each))
        allowed = (
            f"left out but for {names}, in the plane, and limit in space, on ground at rest"
        )
        raise InputError("reduce", reduce, allowed)
    if tol and tol < chosen.finest:
        raise InputError("tol", tol, f"at least {chosen.finest:g} for {chosen.name}")
    require_settings(chosen, settings)
    accuracy = settings.get("accuracy") if problem and problem.in_space else None
    allowed = "left out in space: there settings.step says how fine a motion is"
    require(accuracy is None, "settings.accuracy", accuracy, allowed)
    return chosen


def asked_as(problem: Problem[Any]) -> Problem[Any]:
    """Return what is asked about: prisms in space where a problem of the plane leans."""
    if problem.in_space or problem.is_planar:
        return problem
    from blocksim.blocks.space.extruded import extruded

    return extruded(problem)


def _cheapest(tol: float, problem: Problem[Any] | None, *, moving: bool) -> Method:
    """Return the cheapest method that can answer."""
    # Of engines of one's own it is not known which is right, nor how dear they are.
    for each in map(METHODS.__getitem__, METHODS.shipped):
        fine = each.finest <= (tol or math.inf) and each.is_static <= (not moving)
        if each.name != "theory" and fine and not _beyond(each, problem):
            return each
    last = ENGINES[NAMES[-1]]
    raise InputError("method", "auto", f"another: {_beyond(last, problem)}")


def require_settings(method: Method, settings: Overrides) -> None:
    """Raise `InputError` unless a method knows all settings, each within its range."""
    by_name = isinstance(cast(object, settings), Mapping)
    require(by_name, "settings", settings, 'values by name, such as {"step": 0.01}')
    known = ", ".join(method.adjustable)
    allowed = f"one of {known} for {method.name}" if known else f"left out for {method.name}"
    for name, value in settings.items():
        if name not in method.adjustable:
            raise InputError("settings", name, allowed)
        require_setting(name, value)


def _named(method: str | Method) -> Method:
    """Return the method of a name, or the one that is given itself."""
    if isinstance(method, Engine):
        return make_known(method, method.name)
    if isinstance(method, Method):
        return method
    if method in METHODS:
        return METHODS[method]
    if ":" in method:
        return engine_named(method)
    every = ", ".join(("auto", *METHODS))
    raise InputError("method", method, f"one of {every}, or your own as module:ENGINE")


def _shipped() -> Iterator[Engine]:
    """Go through the engines that come with blocksim, which errors offer instead."""
    return map(ENGINES.__getitem__, NAMES)


def _beyond(method: Method, problem: Problem[Any] | None) -> str:
    """Say what is allowed where a problem is beyond a method; empty where it is not."""
    if problem is None:
        return ""
    if problem.in_space and not (
        method.name == "limit" or (isinstance(method, Engine) and method.build_in_space)
    ):
        able = ", ".join(each.name for each in _shipped() if each.build_in_space)
        return f"one of limit, {able}: {method.name} knows no blocks in space"
    if problem.strength is not None and method.name != "limit":
        return f"limit, or no strength: blocks of {method.name} do not crush"
    if bears(problem) and method.name != "limit":
        return f"limit, or no --fill-passive: soil in {method.name} gives way to nothing"
    if problem.is_moving and not (isinstance(method, Engine) and method.shakes):
        known = (each for each in _shipped() if each.build_in_space or not problem.in_space)
        able = ", ".join(each.name for each in known if each.shakes)
        what = "ground that shakes" if problem.shaking else "blocks that begin in motion"
        return f"one of {able}: {method.name} knows no {what}"
    offered = offers_of(problem) if method.name == "theory" else None
    if method.name == "theory" and (offered is None or "theory" not in offered.methods):
        return "limit or an engine: theory is of symmetric circular arches only"
    return ""


def _can_reduce(method: Method) -> bool:
    """Tell whether it says what joints carry, which fewer blocks than all take."""
    return isinstance(method, Engine) and method.tells_forces


def reduces(
    method: Method, reduce: bool | None, problem: Problem, *, by_maker: bool = False
) -> bool:
    """Tell whether fewer blocks are simulated: as asked for, else as the engine says.

    By merging, or as the maker of the problem knows it.
    """
    if reduce is not None:
        return reduce
    still = problem.has_statics
    usual = isinstance(method, Engine) and (method.reduces if by_maker else method.merges)
    return still and usual


def chosen_words(method: str | Method, chosen: Method) -> str:
    """Say what `auto` took and why, to be added to the reason of an answer."""
    if method != "auto":
        return ""
    seen = "sees the blocks as built" if chosen.is_static else "can move blocks"
    fine = f"brackets down to {chosen.finest:g}" if chosen.finest else "is exact"
    return f"; {chosen.name}, as no cheaper method {seen} and {fine}"


def merged(method: Method, reduce: bool | None, problem: Problem[Any]) -> Merging | None:
    """Return the blocks that move as one, where fewer than all are simulated."""
    if problem.in_space or not reduces(method, reduce, problem):
        return None
    from blocksim.simulation.merging import Merging

    return Merging.of(problem)
