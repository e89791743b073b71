"""Families: a problem for each value of one parameter, from which on it falls, or stands."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Generic, Literal

import numpy as np

from blocksim.ask.methods import asked_as
from blocksim.ask.scan import TRIED, Scan, least_friction, standing_at
from blocksim.blocks.assembly import Blocks
from blocksim.blocks.maker import Kind
from blocksim.blocks.problem import Problem
from blocksim.blocks.road import require_upright
from blocksim.blocks.shaking import AMPLITUDE, DURATION
from blocksim.common.checks import PUSH
from blocksim.common.errors import InputError
from blocksim.common.fields import Stands
from blocksim.limit.intervals import Interval, over_factor, over_tilt

if TYPE_CHECKING:
    from blocksim.ask.spread import Spreading

Over = Literal[
    "load", "tilt", "lean", "mu", "spread", "push", "amplitude", "duration", "thickness"
]  # fmt: skip
"""Parameters of any problem, and of arches; a text may name another of its kind as well."""
LARGEST_FRICTION = 1e3
"""Friction above which more of it is not looked for."""
WIDEST = 100.0
"""How far a kind's parameter goes from the value at hand, as a ratio to both sides."""
HIGHEST_FACTOR = 1e6
"""Load factor above which no limit is looked for."""
LEANEST = 89.999
"""Farthest that gravity leans: by less than a right angle [deg]."""


@dataclass(frozen=True, kw_only=True)
class Family(Generic[Blocks]):
    """A problem for each value of one parameter.

    `problem`: What it is a family of.
    `at`: Value to problem.
    `low`, `high`: Range of values that make sense.
    `stands`, {"low", "high"}: At which end of a bracket it stands.
    `standing`: The values at which forces of equilibrium exist, by limit analysis. None where
        it does not know them.
    `remark`: What else limit analysis saw on the way, to be added to a reason.
    `start`: Where an engine begins its search if limit analysis knows no value.
    `spreading`: Where the parameter is the motion of supports.
    """

    problem: Problem[Blocks]
    name: str
    at: Callable[[float], Problem[Blocks]]
    high: float
    low: float = 0.0
    unit: str = ""
    stands: Stands = "low"
    standing: Callable[[], tuple[Interval, ...] | None] = lambda: None
    remark: Callable[[], str] = str
    start: float | None = None
    spreading: Spreading | None = None

    @cached_property
    def intervals(self) -> tuple[Interval, ...] | None:
        """The values within the range at which forces of equilibrium exist, in order.

        None where limit analysis does not know them. Ends are infinite where it stands up to
        the end of the range.
        """
        found = self.standing()
        if found is None:
            return None
        return tuple(
            Interval(
                low=-math.inf if each.low <= self.low else each.low,
                high=math.inf if each.high >= self.high else each.high,
            )
            for each in found
            if each.low < self.high and each.high >= self.low
        )

    def of(self, problem: Problem[Blocks]) -> Family[Blocks]:
        """Return the same family of another problem."""
        return family_of(problem, self.name)

    def exact(self) -> float | None:
        """Return the first value at which limit analysis sees the change.

        None where the range has none, inf where it stands at all values, 0 where it stands
        down to the end of the range.
        """
        if not self.intervals:
            return None
        first = self.intervals[0]
        return first.high if self.stands == "low" else max(first.low, 0.0)


def family_of(problem: Problem[Any], over: str) -> Family[Any]:
    """Return the family of a problem over one parameter.

    `over`: One of `families_of`; makers call mu `friction`.
    Raises `InputError`: If there is no such parameter, or nothing to multiply.
    """
    known = families_of(problem)
    over = "mu" if over == "friction" else over
    if over in FAMILIES and (problem.is_planar or over in known):
        return FAMILIES[over](problem if over == "lean" else asked_as(problem))
    kind = problem.maker
    if kind is None or over not in kind.bracketed:
        raise InputError("--over", over, f"one of {', '.join(known)}")
    return _over_parameter(problem, kind, over)


def families_of(problem: Problem[Any]) -> tuple[str, ...]:
    """Names of the parameters there are: of any problem, of its shaking, and of its kind."""
    kind = problem.maker
    own = () if kind is None else kind.bracketed
    still = SHAKES if problem.shaking is None else ()
    known = IN_SPACE if problem.in_space or not problem.is_planar else FAMILIES
    aside = () if problem.in_space or problem.is_planar else ("lean",)
    return (*(name for name in known if name not in still), *aside, *own)


def _over_load(problem: Problem[Any]) -> Family[Any]:
    if not problem.live:
        raise InputError("--over", "load", "another parameter: the structure has no live loads")
    return Family(
        problem=problem,
        name="load",
        at=problem.with_load,
        high=HIGHEST_FACTOR,
        standing=lambda: over_factor(problem),
    )


def _over_tilt(problem: Problem[Any]) -> Family[Any]:
    require_upright(problem, "--over", "tilt")

    def standing() -> tuple[Interval, ...]:
        if problem.strength is not None:
            # Of blocks that crush, tilts are tried, as parameters of a kind are.
            turns = np.linspace(0.0, math.pi / 2, TRIED).tolist()
            found = standing_at(problem.tilted, turns)
        else:
            found = over_tilt(problem, 0.0, math.pi / 2)
        return _in_degrees(found)

    return Family(
        problem=problem,
        name="tilt",
        unit="deg",
        at=lambda value: problem.tilted(math.radians(value)),
        high=90.0,
        standing=standing,
    )


def _over_lean(problem: Problem) -> Family[Any]:
    """Return the family over lean, of the same blocks in space."""
    from blocksim.blocks.space.extruded import extruded

    require_upright(problem, "--over", "lean")

    def at(value: float) -> Problem[Any]:
        return extruded(problem.leaning(math.radians(value)))

    def standing() -> tuple[Interval, ...]:
        if problem.gravity[0]:
            return standing_at(at, np.linspace(0.0, LEANEST, TRIED).tolist())
        # Out of the plane is against y.
        tilting = replace(at(0.0), azimuth=-math.pi / 2)
        return _in_degrees(over_tilt(tilting, 0.0, math.pi / 2))

    return Family(
        problem=at(0.0), name="lean", unit="deg", at=at, high=LEANEST, standing=standing
    )


def _in_degrees(found: Sequence[Interval]) -> tuple[Interval, ...]:
    return tuple(
        Interval(low=math.degrees(each.low), high=math.degrees(each.high)) for each in found
    )


def _over_mu(problem: Problem[Any]) -> Family[Any]:
    return Family(
        problem=problem,
        name="mu",
        at=problem.with_friction,
        high=LARGEST_FRICTION,
        stands="high",
        standing=lambda: least_friction(problem, LARGEST_FRICTION),
    )


def _over_spread(problem: Problem) -> Family:
    # It moves blocks, by an engine.
    from blocksim.ask.spread import Spreading

    spreading = Spreading(problem)

    def standing() -> tuple[Interval, ...] | None:
        value = spreading.exact
        return None if value is None else (Interval(low=-math.inf, high=value),)

    return Family(
        problem=problem,
        name="spread",
        unit="m",
        at=spreading.at,
        high=spreading.farthest,
        standing=standing,
        remark=lambda: spreading.words,
        spreading=spreading,
    )


def _over_push(problem: Problem[Any]) -> Family[Any]:
    # It follows blocks that move.
    from blocksim.ask.push import asked, borne, borne_words, without_mass, worse

    both = borne(problem)
    given, said = asked(problem, worse(both)), borne_words(both)
    return Family(
        problem=problem,
        name="push",
        unit="g",
        at=given.with_load,
        high=PUSH.high,
        standing=lambda: over_factor(given),
        remark=lambda: f"; {said}{without_mass(problem)}",
    )


def _over_shaking(problem: Problem, name: str) -> Family:
    shaking = problem.shaking
    if shaking is None:
        raise InputError("--over", name, "another parameter, or --shake: the ground is at rest")
    known, start = {
        "amplitude": (AMPLITUDE, shaking.amplitude or None),
        "duration": (DURATION, shaking.duration),
    }[name]
    return Family(
        problem=problem,
        name=name,
        unit=known.unit,
        at=lambda value: replace(problem, shaking=replace(shaking, **{name: value})),
        low=known.low,
        high=known.high,
        start=start,
    )


FAMILIES: dict[str, Callable[[Any], Family[Any]]] = {
    "load": _over_load,
    "tilt": _over_tilt,
    "lean": _over_lean,
    "mu": _over_mu,
    "spread": _over_spread,
    "push": _over_push,
    "amplitude": partial(_over_shaking, name="amplitude"),
    "duration": partial(_over_shaking, name="duration"),
}
SHAKES = ("amplitude", "duration")
IN_SPACE = ("load", "tilt", "mu", "push", *SHAKES)
"""Those that problems in space have."""


def _over_parameter(problem: Problem[Any], kind: Kind[Any], name: str) -> Family[Any]:
    """Return the family over a parameter of the kind a problem was made from.

    Its range is where the kind can be built, around the value at hand.
    """
    known, low, high = kind.number(name)
    now = kind.value(name)
    ends = max(low, now / WIDEST), min(high, now * WIDEST)
    scan = Scan(lambda value: asked_as(problem.but(**{name: value})), ends, now)
    return Family(
        problem=problem,
        name=name,
        unit=known.unit,
        at=scan.at,
        low=scan.values[0],
        high=scan.values[-1],
        stands=known.stands or "high",
        standing=lambda: scan.standing,
        remark=lambda: scan.remark,
    )
