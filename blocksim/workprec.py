"""Speed against accuracy: how near each method comes to the exact answer, in what time.

The least thickness of a few arches is bracketed with settings from coarse to fine (`knobs`).
The error is that of the bracket's farther end (its centre may be right by luck) against limit
analysis of the same voussoirs; where the number of voussoirs is what is varied, against theory.
Time is all it takes, of the processor and by the clock; work is the contacts solved times the
sweeps over them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Literal

from blocksim import limit, theory
from blocksim.arch import Arch
from blocksim.engines import ENGINES, remedy
from blocksim.knobs import KNOBS, TOL, look
from blocksim.progress import Progress, silent
from blocksim.search import Answer, Search

START = 1.0037
"""Where brackets start, over the exact value: so that no tolerance is met by luck."""
REPEATS = 3
QUICK = slice(None, -1, 2)
"""Every other setting, and not the finest."""
LONG = 20.0
"""Processor time above which a bracket is not repeated, and no finer setting is tried [s]."""

Cost = Literal["time", "work"]


@dataclass(frozen=True, kw_only=True)
class Case:
    """An arch of the chart.

    Parameters
    ----------
    name : str
    half_angle : float
        alpha [rad].
    mu : float
    voussoirs : int
    """

    name: str
    half_angle: float
    mu: float
    voussoirs: int


@dataclass(frozen=True, kw_only=True)
class Point:
    """One bracket, measured.

    Parameters
    ----------
    case, method : str
    knob : str
        What was set, of `knobs.KNOBS`.
    value : float
        To what.
    error : float
        Of the bracket's farther end, relative; inf where there is no bracket.
    undecided : int
        Ratios without an answer.
    work : float
        Contacts solved, times the sweeps over them.
    processor_s, wall_s : tuple of float
        Time of the processor and by the clock [s], of every repeat.
    """

    case: str
    method: str
    knob: str
    value: float
    error: float
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
        """What the error is measured from."""
        return KNOBS[self.knob].against


def cases(*, quick: bool) -> tuple[Case, ...]:
    """Return arches spread over the map, hard ones too; small ones if quick."""
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
    return tuple(
        Case(
            name=f"{name}: {degrees} deg, mu {mu}, n {count}",
            half_angle=math.radians(degrees),
            mu=mu,
            voussoirs=count,
        )
        for name, degrees, mu, count in chosen
    )


def measure(
    chosen: Sequence[Case],
    methods: Iterable[str] | None = None,
    knobs: Iterable[str] = tuple(KNOBS),
    *,
    quick: bool = False,
    progress: Progress = silent,
) -> list[Point]:
    """Bracket arches by every method, with settings from coarse to fine.

    Parameters
    ----------
    chosen : sequence of Case
    methods : iterable of str, optional
        By default limit analysis and the engines installed here.
    knobs : iterable of str
        Of `KNOBS`.
    quick : bool
        With fewer settings, each once.
    progress : Progress, optional

    Returns
    -------
    list of Point
    """
    names = tuple(methods or ("limit", *(name for name in ENGINES if remedy(name) is None)))
    asked = [
        (case, knob, name)
        for knob in knobs
        for case in chosen[: KNOBS[knob].arches]
        for name in names
        if name in KNOBS[knob].values
    ]
    points: list[Point] = []
    for done, (case, knob, name) in enumerate(asked):
        values = KNOBS[knob].values[name]
        for value in values[QUICK] if quick else values:
            progress(done / len(asked), f"{case.name}, {name}, {knob} {value:.3g}")
            points.append(_measured(case, name, knob, value, 1 if quick else REPEATS))
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


def gain(points: Sequence[Point], method: str, over: str) -> float:
    """Finest error of one method over that of another in the same time or less."""
    finest = min((p for p in points if p.method == over), key=lambda p: p.error)
    affordable = [p.error for p in points if p.method == method and p.time <= finest.time]
    return finest.error / min(affordable, default=math.inf)


def _measured(case: Case, method: str, knob: str, value: float, repeats: int) -> Point:
    """Bracket one arch by one method with one setting, again and again."""
    count = int(value) if knob == "voussoirs" else case.voussoirs
    start = _least(case, count)
    truth = start
    if KNOBS[knob].against == "theory":
        truth = theory.least_thickness(case.half_angle, case.mu).eta
    if start is None or truth is None:
        message = "an arch that nothing lets stand has no error to measure"
        raise ValueError(message)
    finest = KNOBS["tolerance"].values.get(method, (0.0,))[-1]
    tol = {"tolerance": value, "voussoirs": finest}.get(knob, TOL)
    work = 0

    def judge(eta: float) -> Answer:
        nonlocal work
        arch = Arch(half_angle=case.half_angle, eta=eta, voussoirs=count)
        seen = look(arch, case.mu, method, knob, value)
        work += seen.work
        return Answer(seen.verdict, seen.acceleration)

    processor_s: list[float] = []
    wall_s: list[float] = []
    ends: tuple[float | None, ...] = ()
    undecided = 0
    for _ in range(repeats):
        work = 0
        wall, processor = time.perf_counter(), time.process_time()
        if method == "limit":
            ends = (_least(case, count),)
        else:
            search = Search(judge)
            search.expand(start * START)
            search.bisect(tol)
            ends, undecided = (search.low, search.high), search.undecided
        processor_s.append(time.process_time() - processor)
        wall_s.append(time.perf_counter() - wall)
        if processor_s[-1] > LONG:
            break
    return Point(
        case=case.name,
        method=method,
        knob=knob,
        value=value,
        error=max(math.inf if end is None else abs(end / truth - 1) for end in ends),
        undecided=undecided,
        work=work,
        processor_s=tuple(processor_s),
        wall_s=tuple(wall_s),
    )


def _least(case: Case, voussoirs: int) -> float | None:
    """Exact least thickness of so many voussoirs."""
    return limit.least_thickness(case.half_angle, case.mu, voussoirs).eta
