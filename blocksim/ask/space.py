"""The questions of problems in space: does it stand, and up to where, and what falls."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Literal

import numpy as np

from blocksim.ask.families import HIGHEST_FACTOR, LARGEST_FRICTION
from blocksim.ask.methods import require_settings
from blocksim.ask.options import Taken
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import Field
from blocksim.engines.base import Engine
from blocksim.limit.space import (
    SpatialEquilibrium,
    can_rest,
    joint_states,
    largest_load,
    unit_rates,
)
from blocksim.simulation.motion import LONGEST
from blocksim.simulation.space import (
    SpatialRecording,
    engine_in_space,
    observe_in_space,
    simulate_in_space,
)
from blocksim.simulation.verdict import Evidence, Verdict, reason_of

STATIC = ("auto", "limit")
FAMILIES_IN_SPACE = {"load": "", "mu": "", "tilt": "deg"}
"""What may be bracketed over, with its unit."""
SCANNED = 13
"""Values of a parameter that are tried before one is halved."""
WIDEST = 10.0
"""How far they go from the value at hand, as a ratio to both sides."""
LEAST_FRICTION = 1e-6
LEAST_MARGIN = -100.0
"""What stands for no forces at all, even if contacts could pull."""
STEEPEST = 90.0
"""Farthest that a table tilts [deg]."""
BESIDE = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""Shares of a value by which it is tried to both sides, the least first."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialCheck:
    """Answer to *does it stand*, in space.

    Parameters
    ----------
    method : str
    verdict : Verdict
        *Stands* means that it can rest.
    evidence : tuple of Evidence
    problem : SpatialProblem
    static : SpatialEquilibrium or None
        Forces, or the mechanism, and the gap to which they were checked; None by an engine.
    mechanism : (blocks, 6) float or None
        Rates with which a collapse starts: x, y, z [size], and rotations about the axes.
    recording : SpatialRecording or None
        Of the moving run, by an engine.
    joints : tuple of JointState
        What each joint does as a collapse starts; closed where the blocks stand.
    load_factor : float or None
        Largest factor on the live loads at which forces of equilibrium exist, inf where no
        live load is too much; None without live loads, or where there is none.
    wall_s : float
        Seconds it took.
    """

    method: str
    verdict: Verdict
    evidence: tuple[Evidence, ...]
    problem: SpatialProblem
    static: SpatialEquilibrium | None
    mechanism: Array | None
    recording: SpatialRecording | None = None
    joints: tuple[JointState, ...]
    load_factor: float | None = None
    wall_s: float

    @property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    @property
    def forces(self) -> Array | None:
        """Forces of equilibrium at the joints, along normals and across, (joints, 3) [N]."""
        return None if self.static is None else self.static.forces

    def __repr__(self) -> str:
        return f"SpatialCheck({self.verdict}, by {self.method}, of {self.problem!r})"


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialBracket:
    """Where a problem in space changes from standing to falling, between two values tried.

    Parameters
    ----------
    method, over, unit : str
    low, high : float or None
        The two values tried; None where the search came to the end of the range.
    stands : {"low", "high"}
        At which end it stands.
    limit : float or None
        The value between them; inf where it stands at all values, None where at none.
    runs : int
        Values tried.
    evidence : tuple of Evidence
    problem : SpatialProblem
    tol : float
    wall_s : float
    """

    method: str
    over: str
    unit: str
    low: float | None
    high: float | None
    stands: Literal["low", "high"]
    limit: float | None
    runs: int
    evidence: tuple[Evidence, ...]
    problem: SpatialProblem
    tol: float
    wall_s: float

    @cached_property
    def reason(self) -> str:
        """The evidence as a sentence."""
        return reason_of(self.evidence)

    def __repr__(self) -> str:
        return f"SpatialBracket({self.over} {self.low} to {self.high}, stands at {self.stands})"


def check_in_space(problem: SpatialProblem, given: Taken) -> SpatialCheck:
    """Tell whether blocks in space stand; see `blocksim.check`."""
    if given.method not in STATIC:
        return _seen(problem, given)
    started = time.perf_counter()
    _require_static(given)
    static = can_rest(problem)
    verdict = {True: Verdict.STANDS, False: Verdict.COLLAPSES, None: Verdict.UNDECIDED}
    evidence = Evidence("limit analysis", static_words(static))
    return _answer(
        problem, "limit", verdict[static.exists], (evidence,), static.mechanism, started, static
    )


def _seen(problem: SpatialProblem, given: Taken) -> SpatialCheck:
    """Tell whether blocks stand by what an engine shows."""
    started, engine = time.perf_counter(), _engine(given)
    seen = observe_in_space(problem, engine, settings=given.settings, progress=given.progress)
    rates = None if seen.rates is None else unit_rates(problem, seen.rates)
    found = _answer(problem, engine.name, seen.verdict, seen.evidence, rates, started)
    return replace(found, recording=seen.recording)


def _answer(
    problem: SpatialProblem,
    method: str,
    verdict: Verdict,
    evidence: tuple[Evidence, ...],
    rates: Array | None,
    started: float,
    static: SpatialEquilibrium | None = None,
) -> SpatialCheck:
    """Return an answer with what every method's has."""
    states = (JointState.CLOSED,) * len(problem.assembly.joints)
    return SpatialCheck(
        method=method,
        verdict=verdict,
        evidence=(*evidence, *(Evidence("note", note) for note in problem.notes)),
        problem=problem,
        static=static,
        mechanism=rates,
        joints=states if rates is None else joint_states(problem, rates),
        load_factor=largest_load(problem).factor if problem.live else None,
        wall_s=time.perf_counter() - started,
    )


def recorded_in_space(
    problem: SpatialProblem, duration: float | None, given: Taken
) -> SpatialRecording:
    """Let blocks in space go, and record them; see `blocksim.simulate`."""
    until = LONGEST if duration is None else duration
    return simulate_in_space(
        problem, _engine(given), until=until, settings=given.settings, progress=given.progress
    )


def _engine(given: Taken) -> Engine:
    """Return the engine asked for, which moves blocks in space."""
    method = given.method
    named = method if isinstance(method, str | Engine) else method.name
    engine = engine_in_space("direct" if named == "auto" else named)
    require(given.reduce is None, "reduce", given.reduce, "left out in space")
    require_settings(engine, given.settings)
    accuracy = given.settings.get("accuracy")
    allowed = "left out in space: there settings.step says how fine a motion is"
    require(accuracy is None, "settings.accuracy", accuracy, allowed)
    return engine


def static_words(static: SpatialEquilibrium) -> str:
    """Say what limit analysis found, and how near it was held to."""
    own = "of the lighter block's share of weight beside it"
    if static.exists:
        left = f", but for {static.gap:.1g} of a weight" if static.gap else ""
        return (
            f"forces of equilibrium exist{left}; each contact presses by {static.margin:.3g} "
            f"{own} more than its friction needs"
        )
    if static.exists is None:
        return (
            "neither forces nor a motion pass the check: contacts press by "
            f"{static.margin:.1g} {own} at most, "
            "which is nearer to the limit than floating-point numbers tell"
        )
    most = 1 / static.gap if static.gap else math.inf
    far = "" if math.isinf(most) else f" that are less than {most:.1g} times all weight"
    if math.isinf(static.margin):
        return "no forces of equilibrium exist, even if contacts could pull"
    return (
        f"no forces of equilibrium exist{far}: contacts would have to pull by "
        f"{-static.margin:.3g} {own}"
    )


def bracket_in_space(
    problem: SpatialProblem,
    over: str | None,
    within: tuple[float, float] | None,
    given: Taken,
) -> SpatialBracket:
    """Find the value at which blocks in space change; see `blocksim.bracket`."""
    started = time.perf_counter()
    _require_static(given)
    maker = problem.maker
    own: dict[str, Field] = {}
    if maker is not None:
        own = {name: maker.number(name)[0] for name in maker.bracketed}
    allowed = f"one of {', '.join([*FAMILIES_IN_SPACE, *own])}"
    over = "thickness" if over is None and "thickness" in own else over
    if over is None:
        raise InputError("over", MISSING, allowed)
    require(over in FAMILIES_IN_SPACE or over in own, "over", over, allowed + ", in space")
    require(within is None, "within", within, "left out by limit, which searches no range")
    made_over = partial(_made, name=over)
    families = {"load": _loaded, "mu": _rough, "tilt": _tilted}
    tried = _Tried(families.get(over, made_over)(problem))
    rises, unit = over == "mu", FAMILIES_IN_SPACE.get(over, "")
    if over in own:
        rises, unit = own[over].stands == "high", own[over].unit
        limit = _scanned(tried, *_range(problem, over), rises=rises)
    elif over == "load":
        require(bool(problem.live), "over", over, "left out: there are no live loads")
        factor = largest_load(problem).factor
        limit = math.inf if factor is not None and factor > HIGHEST_FACTOR else factor
    elif over == "mu":
        limit = _halved(tried, LEAST_FRICTION, LARGEST_FRICTION, rises=True)
    else:
        still = not problem.dead and not (problem.live and problem.load)
        allowed = "left out with loads besides gravity: they would not turn with it"
        require(still, "over", over, allowed)
        limit = _halved(tried, 0.0, STEEPEST, rises=False)
    low, high = (None, None) if limit is None else tried.ends(limit, given.tol, rises=rises)
    if over == "mu" and limit == 0:
        low, high = None, LEAST_FRICTION
    return SpatialBracket(
        method="limit",
        over=over,
        unit=unit,
        low=low,
        high=high,
        stands="high" if rises else "low",
        limit=limit,
        runs=tried.runs,
        evidence=(Evidence("search", _search_words(limit, low, high, over)),),
        problem=problem,
        tol=given.tol,
        wall_s=time.perf_counter() - started,
    )


def _require_static(given: Taken) -> None:
    """Refuse what is of engines."""
    allowed = "limit: engines bracket nothing in space yet; check asks them"
    require(given.method in STATIC, "method", str(given.method), allowed)
    require(not given.settings, "settings", dict(given.settings), "left out: limit has none")
    require(given.reduce is None, "reduce", given.reduce, "left out by limit")


def _loaded(problem: SpatialProblem) -> Callable[[float], SpatialProblem]:
    return problem.with_load


def _rough(problem: SpatialProblem) -> Callable[[float], SpatialProblem]:
    return problem.with_friction


def _tilted(problem: SpatialProblem) -> Callable[[float], SpatialProblem]:
    return lambda degrees: problem.tilted(math.radians(degrees))


def _made(problem: SpatialProblem, name: str) -> Callable[[float], SpatialProblem]:
    """Return what makes it with another value of a parameter, under gravity as it is."""
    maker = problem.maker
    assert maker is not None  # noqa: S101 - asked of kinds only
    allowed = "left out with loads besides gravity: they are of blocks that are made anew"
    require(not problem.live and not problem.dead, "over", name, allowed)
    return lambda value: problem.but(**{name: value})


def _range(problem: SpatialProblem, name: str) -> tuple[float, float]:
    """Return the values of a parameter that are looked at."""
    maker = problem.maker
    assert maker is not None  # noqa: S101 - asked of kinds only
    (low, high), value = maker.limits(name), float(maker.value(name))
    # Of a parameter that is 0 there is no multiple.
    return max(low, value / WIDEST), min(high, WIDEST * value) if value else high


class _Tried:
    """Problems of a family as they are asked for, counted."""

    def __init__(self, at: Callable[[float], SpatialProblem]) -> None:
        self._at, self.runs = at, 0

    def __call__(self, value: float) -> SpatialEquilibrium:
        """Ask limit analysis at a value."""
        self.runs += 1
        return can_rest(self._at(value))

    def _tells(self, value: float, stands: bool) -> bool:
        """Tell whether a verdict is shown at a value, of which something can be made."""
        with suppress(InputError):
            return self(value).exists is stands
        return False

    def ends(
        self, limit: float, tol: float, *, rises: bool
    ) -> tuple[float | None, float | None]:
        """Return the nearest values at which it is told to stand, and to fall."""
        if not math.isfinite(limit) or limit == 0:
            return None, None
        found: dict[bool, float | None] = {}
        for stands in (True, False):
            up = stands == rises
            step = (1 if up else -1) * max(abs(limit), 1e-6)
            near = (limit + by * step for by in BESIDE if by <= max(tol, BESIDE[0]))
            found[up] = next((each for each in near if self._tells(each, stands)), None)
        return found[False], found[True]


def _scanned(tried: _Tried, low: float, high: float, *, rises: bool) -> float | None:
    """Find the first change from the end that is unsafe, of values tried at even ratios.

    None where it falls at all of them, inf where it stands at all.
    """
    low = max(low, high / WIDEST**2)
    values, standing = list[float](), list[bool]()
    for value in np.geomspace(low, high, SCANNED).tolist():
        # The range ends where nothing can be made.
        with suppress(InputError):
            standing.append(tried(value).margin > 0)
            values.append(value)
    if all(standing):
        return math.inf
    if not any(standing):
        return None
    at = [k for k in range(len(values) - 1) if standing[k] != standing[k + 1]]
    # From the end at which it falls.
    right = [k for k in at if standing[k + 1] == rises]
    if not right:
        return None
    k = right[0] if rises else right[-1]
    return _halved(tried, values[k], values[k + 1], rises=rises)


def _halved(tried: _Tried, low: float, high: float, *, rises: bool) -> float | None:
    """Find the value in an interval at which contacts no longer press.

    None where it falls at the end that is safest; inf where it stands at the other as well
    (0 where it needs no friction). The margin grows from the one to the other, and is a
    continuous function of the value: bracketed by Alefeld, Potra and Shi's method (1995).
    """
    from scipy.optimize import toms748

    safe, unsafe = (high, low) if rises else (low, high)
    if not tried(safe).exists:
        return None
    if tried(unsafe).exists:
        return 0.0 if rises else math.inf
    over = math.log(high) - math.log(low) > 1 if low > 0 else False

    def margin(at: float) -> float:
        # No forces at all are as far from standing as it gets.
        return max(tried(math.exp(at) if over else at).margin, LEAST_MARGIN)

    ends = (math.log(low), math.log(high)) if over else (low, high)
    if margin(ends[0]) * margin(ends[1]) >= 0:
        return None
    found = toms748(margin, *ends, xtol=1e-14 * abs(ends[1]) or 1e-300, rtol=1e-14)
    return math.exp(found) if over else float(found)


def _search_words(limit: float | None, low: float | None, high: float | None, over: str) -> str:
    """Say what a search found; of a parameter 13 values are tried."""
    tried = "" if over in FAMILIES_IN_SPACE else f" of {SCANNED} that were tried"
    if limit is None:
        return f"no forces of equilibrium exist at any value{tried}"
    if math.isinf(limit):
        return f"forces of equilibrium exist at all values{tried}"
    if over == "mu" and limit == 0:
        return "it needs no friction"
    if low is None or high is None:
        return "limit analysis tells the value, but not both sides of it within the tolerance"
    return "limit analysis tells both sides"
