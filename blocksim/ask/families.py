"""Families: a problem for each value of one parameter, from which on it falls, or stands."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np

from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.shaking import LONGEST, SHORTEST, STRONGEST, Shaking
from blocksim.common.errors import InputError
from blocksim.common.later import Library
from blocksim.limit import collapse, equilibrium

if TYPE_CHECKING:
    from scipy import optimize

    from blocksim.ask.spread import Spreading
else:
    optimize = Library("scipy.optimize")

Stands = Literal["low", "high"]
LARGEST_FRICTION = 1e3
"""Friction above which more of it is not looked for."""
ENOUGH = 1e-9
"""Lack of force at which limit analysis still calls blocks at rest [mean weights]."""
NEAR = 1e-6
"""How far from where force is lacking its margin is looked at, relative."""
WIDEST = 100.0
"""How far a kind's parameter goes from the value at hand, as a ratio to both sides."""
TRIED = 25
"""Values of a kind's parameter at which limit analysis looks for the change."""
HIGHEST_FACTOR = 1e6
"""Load factor above which no limit is looked for."""
LEANEST = 89.999
"""Farthest that gravity leans: by less than a right angle [deg]."""


@dataclass(frozen=True, kw_only=True)
class Family:
    """A problem for each value of one parameter.

    Parameters
    ----------
    name, unit : str
    at : callable
        Value to problem.
    low, high : float
        Range of values that make sense.
    stands : {"low", "high"}
        At which end of a bracket it stands.
    exact : callable
        The value at which limit analysis sees the change. None where the range has none, inf
        where it stands at all values, 0 where it stands down to the end of the range.
    remark : callable
        What else limit analysis saw on the way, to be added to a reason.
    start : float or None
        Where an engine begins its search if limit analysis knows no value.
    spreading : Spreading or None
        Where the parameter is the motion of supports.
    """

    name: str
    unit: str
    at: Callable[[float], Problem]
    low: float
    high: float
    stands: Stands
    exact: Callable[[], float | None]
    remark: Callable[[], str] = str
    start: float | None = None
    spreading: Spreading | None = None


def family_of(problem: Problem, over: str) -> Family:
    """Return the family of a problem over one parameter.

    Parameters
    ----------
    problem : Problem
    over : str
        One of `families_of`.

    Raises
    ------
    InputError
        If there is no such parameter, or nothing to multiply.
    """
    if over in FAMILIES:
        return FAMILIES[over](problem)
    known = families_of(problem)
    if over not in known:
        raise InputError("--over", over, f"one of {', '.join(known)}")
    return _over_parameter(problem, over)


def families_of(problem: Problem) -> tuple[str, ...]:
    """Names of the parameters there are: of any problem, of its shaking, and of its kind."""
    kind = problem.maker
    still = {"amplitude", "duration"} if problem.shaking is None else set[str]()
    always = [name for name in FAMILIES if name not in still]
    return (*always, *(() if kind is None else kind.bracketed))


def _over_load(problem: Problem) -> Family:
    if not problem.live:
        raise InputError("--over", "load", "another parameter: the structure has no live loads")
    return Family(
        name="load",
        unit="",
        at=problem.with_load,
        low=0.0,
        high=HIGHEST_FACTOR,
        stands="low",
        exact=lambda: collapse(problem).load_factor,
    )


def _over_tilt(problem: Problem) -> Family:
    return Family(
        name="tilt",
        unit="deg",
        at=lambda value: problem.tilted(math.radians(value)),
        low=0.0,
        high=90.0,
        stands="low",
        exact=lambda: _exact_tilt(problem),
    )


def _exact_tilt(problem: Problem) -> float | None:
    """Angle of the table, in degrees: one linear programme where gravity is all that acts.

    To tilt gravity is to add a force across it, of the tangent's size, and to scale both.
    """
    if problem.is_loaded:
        return _root(lambda value: problem.tilted(math.radians(value)), 0.0, 90.0, "low")
    x, y, _ = problem.gravity
    across = Load(
        force=np.array([-y, x]),
        blocks=tuple(range(len(problem.assembly.blocks))),
        per_weight=True,
    )
    found = collapse(replace(problem, live=(across,), load=0.0)).load_factor
    if found is None or found < 0:
        return None
    return math.inf if math.isinf(found) else math.degrees(math.atan(found))


def _over_lean(problem: Problem) -> Family:
    return Family(
        name="lean",
        unit="deg",
        at=lambda value: problem.leaning(math.radians(value)),
        low=0.0,
        high=LEANEST,
        stands="low",
        exact=lambda: None,
    )


def _over_mu(problem: Problem) -> Family:
    return Family(
        name="mu",
        unit="",
        at=problem.with_friction,
        low=0.0,
        high=LARGEST_FRICTION,
        stands="high",
        exact=lambda: _root(lambda mu: replace(problem, mu=mu), 0.0, LARGEST_FRICTION, "high"),
    )


def _over_spread(problem: Problem) -> Family:
    # It moves blocks, by an engine.
    from blocksim.ask.spread import Spreading

    spreading = Spreading(problem)
    return Family(
        name="spread",
        unit="m",
        at=spreading.at,
        low=0.0,
        high=spreading.farthest,
        stands="low",
        exact=lambda: spreading.exact,
        remark=lambda: spreading.words,
        spreading=spreading,
    )


def _over_amplitude(problem: Problem) -> Family:
    shaking = _shaking(problem, "amplitude")
    return Family(
        name="amplitude",
        unit="g",
        at=lambda value: replace(problem, shaking=shaking.with_amplitude(value)),
        low=0.0,
        high=STRONGEST,
        stands="low",
        exact=lambda: None,
        start=shaking.amplitude or None,
    )


def _over_duration(problem: Problem) -> Family:
    shaking = _shaking(problem, "duration")
    return Family(
        name="duration",
        unit="s",
        at=lambda value: replace(problem, shaking=shaking.with_duration(value)),
        low=SHORTEST,
        high=LONGEST,
        stands="low",
        exact=lambda: None,
        start=shaking.duration,
    )


def _shaking(problem: Problem, name: str) -> Shaking:
    if problem.shaking is None:
        raise InputError("--over", name, "another parameter, or --shake: the ground is at rest")
    return problem.shaking


FAMILIES: dict[str, Callable[[Problem], Family]] = {
    "load": _over_load,
    "tilt": _over_tilt,
    "lean": _over_lean,
    "mu": _over_mu,
    "spread": _over_spread,
    "amplitude": _over_amplitude,
    "duration": _over_duration,
}


def _over_parameter(problem: Problem, name: str) -> Family:
    """Return the family over a parameter of the kind a problem was made from.

    Its range is where the kind can be built, around the value at hand.
    """
    kind = problem.maker
    assert kind is not None  # noqa: S101
    known, low, high = kind.number(name)
    now = kind.value(name)
    ends = max(low, now / WIDEST), min(high, now * WIDEST)

    @lru_cache(maxsize=2 * TRIED)
    def at(value: float) -> Problem:
        return problem.but(**{name: value})

    values = _built(at, np.geomspace(*ends, TRIED).tolist(), now)
    stands: Stands = known.stands or "high"
    scan = _Scan(at, values, stands)
    return Family(
        name=name,
        unit=known.unit,
        at=at,
        low=values[0],
        high=values[-1],
        stands=stands,
        exact=lambda: scan.exact,
        remark=lambda: scan.remark,
    )


def _built(at: Callable[[float], Problem], values: list[float], now: float) -> list[float]:
    """Return the values around the one at hand of which something can be built."""

    def able(way: list[float]) -> list[float]:
        found: list[float] = []
        for value in way:
            try:
                at(value)
            except InputError:
                break
            found.append(value)
        return found

    below = [value for value in values if value < now]
    return [*able(below[::-1])[::-1], now, *able([value for value in values if value > now])]


class _Scan:
    """What limit analysis says at values of a parameter, from the falling side on."""

    def __init__(
        self, at: Callable[[float], Problem], values: list[float], stands: Stands
    ) -> None:
        self._at = at
        self._stands: Stands = stands
        self._values = values if stands == "high" else values[::-1]

    @cached_property
    def _standing(self) -> list[bool]:
        return [equilibrium(self._at(value)).margin >= -ENOUGH for value in self._values]

    @cached_property
    def exact(self) -> float | None:
        """The first change from falling to standing."""
        if True not in self._standing:
            return None
        first = self._standing.index(True)
        if first == 0:
            return 0.0 if self._stands == "high" else math.inf
        ends = sorted(self._values[first - 1 : first + 1])
        return _root(self._at, ends[0], ends[1], self._stands)

    @property
    def remark(self) -> str:
        """Say whether that is the only change among the values tried."""
        tried = f"{len(self._values)} values from {min(self._values):.3g} to "
        tried += f"{max(self._values):.3g}"
        if True not in self._standing:
            return f"; tried: {tried}"
        first = self._standing.index(True)
        beyond = zip(self._values[first:], self._standing[first:], strict=True)
        again = next((value for value, stood in beyond if not stood), None)
        if again is None:
            return f"; the only change, as far as {tried} tell"
        return f"; not the only change: it falls again at {again:.6g} (of {tried})"


def _root(
    at: Callable[[float], Problem], low: float, high: float, stands: Stands
) -> float | None:
    """Find where the margin of equilibrium vanishes."""

    def margin(value: float) -> float:
        # Where nothing would hold the blocks any number will do that is far below zero.
        return max(equilibrium(at(value)).margin, -1.0) + ENOUGH

    standing, falling = (low, high) if stands == "low" else (high, low)
    if margin(standing) < 0:
        return None
    if margin(falling) >= 0:
        return math.inf if stands == "low" else 0.0
    found = float(optimize.brentq(margin, low, high, xtol=1e-13, rtol=1e-12))
    # What is enough is a little too little: where the margin grows evenly on the standing
    # side, its zero is taken from there.
    step = NEAR * max(found, low) * (1 if stands == "high" else -1)
    one, two = (margin(min(max(found + k * step, low), high)) - ENOUGH for k in (1, 2))
    if one < 10 * ENOUGH or two <= one:
        return found
    zero = found + step - one * step / (two - one)
    # Where blocks can be wedged the margin jumps, and its zero is found already.
    return zero if abs(zero - found) <= abs(step) else found
