"""Speed against accuracy: how near each method comes to the exact answer, in what time.

The least thickness of a few arches is bracketed with settings from coarse to fine
(`refinement`). The error is that of the bracket's farther end (its centre may be right by
luck) against limit analysis of the same voussoirs; where the number of voussoirs is what is
varied, against theory.
Time is all it takes, of the processor and by the clock; work is the contacts solved times the
sweeps over them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median
from typing import Literal, NamedTuple

from blocksim.arch import limit, theory
from blocksim.arch.circular import Arch
from blocksim.ask.methods import METHODS
from blocksim.ask.search import Answer, Bisection
from blocksim.common.progress import Progress, silent
from blocksim.engines import ENGINES
from blocksim.studies.refinement import REFINEMENTS, TOL, look

START = 1.0037
"""Start of a bracket over the exact value, so that no tolerance is met by luck."""
REPEATS = 3
QUICK = slice(None, -1, 2)
"""Every other setting, and not the finest."""
LONG = 20.0
"""Processor time above which a bracket is not repeated, and no finer setting is tried [s]."""

Cost = Literal["time", "work"]
Cases = Mapping[str, tuple[Arch, float]]
"""Arches of any thickness, each with its friction, by name."""


@dataclass(frozen=True, kw_only=True)
class Point:
    """One bracket, measured.

    `knob`: What was set, of `REFINEMENTS`.
    `value`: To what.
    `error`: Of the bracket's farther end, relative; inf where there is no bracket.
    `low`, `high`: The bracket's ends, thickness over radius; None where there is none, or not
        told.
    `undecided`: Ratios without an answer.
    `work`: Contacts solved, times the sweeps over them.
    `processor_s`, `wall_s`: Time of the processor and by the clock [s], of every repeat.
    """

    case: str
    method: str
    knob: str
    value: float
    error: float
    low: float | None = None
    high: float | None = None
    undecided: int
    work: float
    processor_s: tuple[float, ...]
    wall_s: tuple[float, ...]

    @property
    def time(self) -> float:
        """Processor time, median of the repeats [s]: other work on the machine adds little."""
        return median(self.processor_s)

    @property
    def against(self) -> str:
        """The method from which the error is measured."""
        return REFINEMENTS[self.knob].against


def cases(*, quick: bool) -> Cases:
    """Return arches spread over the map, hard ones too, or small ones if quick."""
    chosen = (
        (("semicircle", 90, 0.7, 11), ("sliding shoulder", 125, 0.9, 10))
        if quick
        else (
            ("semicircle", 90, 0.7, 27),
            ("sliding shoulder", 125, 0.9, 26),
            ("thin", 40, 0.9, 27),
            ("steep", 154, 2.6, 27),
            ("long", 90, 0.7, 101),
        )
    )
    return {
        f"{name}: {degrees} deg, mu {mu}, n {count}": (
            Arch(half_angle=math.radians(degrees), eta=1.0, voussoirs=count),
            mu,
        )
        for name, degrees, mu, count in chosen
    }


def measure(
    chosen: Cases,
    methods: Iterable[str] | None = None,
    knobs: Iterable[str] = tuple(REFINEMENTS),
    *,
    quick: bool = False,
    progress: Progress = silent,
) -> list[Point]:
    """Bracket arches by methods (those installed), with settings from coarse to fine."""
    names = tuple(
        methods or ("limit", *(name for name, engine in ENGINES.items() if not engine.missing))
    )
    asked = [
        (case, knob, name)
        for knob in knobs
        for case in list(chosen)[: REFINEMENTS[knob].arches]
        for name in names
        if name in REFINEMENTS[knob].values
    ]
    points: list[Point] = []
    for done, (case, knob, name) in enumerate(asked):
        values = REFINEMENTS[knob].values[name]
        for value in values[QUICK] if quick else values:
            progress(done / len(asked), f"{case}, {name}, {knob} {value:.3g}")
            repeats = 1 if quick else REPEATS
            points.append(_measured(case, *chosen[case], name, knob, value, repeats))
            if points[-1].time > LONG:
                break
    return points


def front(points: Sequence[Point], cost: Cost = "time") -> list[Point]:
    """Return the points that no other beats in both cost and error, cheapest first."""

    def spent(point: Point) -> float:
        return point.time if cost == "time" else point.work

    best: list[Point] = []
    for point in sorted(points, key=lambda each: (spent(each), each.error)):
        if math.isfinite(point.error) and (not best or point.error < best[-1].error):
            best.append(point)
    return best


def on_front(points: Sequence[Point], cost: Cost = "time") -> set[Point]:
    """Return the points on the front of their own arch and of what they are held against."""
    peers: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        peers.setdefault((point.case, point.against), []).append(point)
    return {best for group in peers.values() for best in front(group, cost)}


class _Found(NamedTuple):
    """A bracket, and what it cost."""

    low: float | None = None
    high: float | None = None
    undecided: int = 0
    work: int = 0


def _measured(
    case: str, arch: Arch, mu: float, method: str, knob: str, value: float, repeats: int
) -> Point:
    """Bracket one arch by one method with one setting, again and again."""
    built = replace(arch, voussoirs=int(value)) if knob == "voussoirs" else arch
    exact = truth = _exact(built, mu)
    if REFINEMENTS[knob].against == "theory":
        truth = theory.least_thickness(arch.half_angle, mu).eta
    if exact is None or truth is None:
        raise ValueError("an arch that nothing lets stand has no error to measure")
    processor_s: list[float] = []
    wall_s: list[float] = []
    found = _Found()
    while len(wall_s) < repeats and max(processor_s, default=0.0) <= LONG:
        wall, processor = time.perf_counter(), time.process_time()
        if method == "limit":
            eta = _exact(built, mu)
            found = _Found(eta, eta)
        else:
            found = _bracketed(built, mu, exact * START, method, knob, value)
        processor_s.append(time.process_time() - processor)
        wall_s.append(time.perf_counter() - wall)
    ends = found.low, found.high
    return Point(
        case=case,
        method=method,
        knob=knob,
        value=value,
        error=max(math.inf if end is None else abs(end / truth - 1) for end in ends),
        low=found.low,
        high=found.high,
        undecided=found.undecided,
        work=found.work,
        processor_s=tuple(processor_s),
        wall_s=tuple(wall_s),
    )


def _bracketed(
    arch: Arch, mu: float, start: float, method: str, knob: str, value: float
) -> _Found:
    """Bisection for the least thickness of one arch by an engine."""
    finest = METHODS[method].finest
    tol = {"tolerance": value, "voussoirs": finest}.get(knob, TOL)
    work = 0

    def judge(eta: float) -> Answer:
        nonlocal work
        seen = look(replace(arch, eta=eta), mu, method, knob, value)
        work += seen.work
        return Answer(seen.verdict, seen.acceleration)

    search = Bisection(judge)
    search.expand(start)
    search.bisect(tol)
    return _Found(search.low, search.high, search.undecided, work)


def _exact(arch: Arch, mu: float) -> float | None:
    """Return the least thickness by limit analysis."""
    return limit.least_thickness(arch.half_angle, mu, arch.voussoirs).eta
