"""Speed against accuracy: how near each method comes to the exact answer, in what time.

The least thickness of a few arches is bracketed by onset test alone, to finer and finer
tolerances. The error is that of the bracket's farther end against limit analysis of the same
voussoirs (its centre may be right by luck); the time is all of it, the work the contacts
solved times the sweeps over them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

from blocksim import limit
from blocksim.arch import Arch
from blocksim.engines import remedy
from blocksim.progress import Progress, silent
from blocksim.search import Answer, Search
from blocksim.trial import trial

TOLERANCES = {
    "direct": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    "pymunk": (1e-2, 3e-3, 1e-3, 3e-4, 1e-4),
    "pybullet": (1e-2, 3e-3, 1e-3),
    "mujoco": (1e-2, 3e-3, 1e-3),
}
"""Methods that simulate, and the relative widths of their brackets."""
START = 1.0037
"""Where brackets start, over the exact value: so that no tolerance is met by luck."""
REPEATS = 3
LONG = 20.0
"""A bracket that takes longer is not repeated, and no finer one is tried [s]."""


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
    tol : float
        Relative width asked for.
    error : float
        Of the bracket's farther end, relative; inf where there is no bracket.
    undecided : int
        Ratios without an answer.
    work : float
        Contacts solved, times the sweeps over them.
    seconds : tuple of float
        Of every repeat.
    """

    case: str
    method: str
    tol: float
    error: float
    undecided: int
    work: float
    seconds: tuple[float, ...]

    @property
    def wall_s(self) -> float:
        """Median of the repeats [s]."""
        return median(self.seconds)


def cases(*, quick: bool) -> tuple[Case, ...]:
    """Return arches spread over the map, hard ones too; small ones if quick."""
    chosen = (
        (("semicircle", 90, 0.7, 11), ("sliding shoulder", 125, 0.9, 10))
        if quick
        else (
            ("semicircle", 90, 0.7, 27),
            ("sliding shoulder", 125, 0.9, 26),
            ("steep", 154, 2.6, 27),
            ("thin", 40, 0.9, 27),
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
    *,
    repeats: int = REPEATS,
    progress: Progress = silent,
) -> list[Point]:
    """Bracket every arch by every method, to finer and finer tolerances.

    Parameters
    ----------
    chosen : sequence of Case
    methods : iterable of str, optional
        Of `TOLERANCES`; by default those installed here.
    repeats : int
    progress : Progress, optional

    Returns
    -------
    list of Point
    """
    names = [name for name in TOLERANCES if remedy(name) is None]
    asked = [(case, name) for case in chosen for name in (methods or names)]
    points: list[Point] = []
    for done, (case, name) in enumerate(asked):
        for tol in TOLERANCES[name]:
            progress(done / len(asked), f"{case.name}, {name} to {tol:g}")
            points.append(_measured(case, name, tol, repeats))
            if points[-1].wall_s > LONG:
                break
    return points


def front(points: Sequence[Point]) -> list[Point]:
    """Return the points that no other beats in both time and error, fastest first."""
    best: list[Point] = []
    for point in sorted(points, key=lambda each: (each.wall_s, each.error)):
        if math.isfinite(point.error) and (not best or point.error < best[-1].error):
            best.append(point)
    return best


def on_front(points: Sequence[Point]) -> set[Point]:
    """Return the points that are on the front of their own arch."""
    names = {point.case for point in points}
    return {best for name in names for best in front([p for p in points if p.case == name])}


def gain(points: Sequence[Point], method: str, over: str) -> float:
    """Finest error of one method over that of another in the same time or less."""
    finest = min((p for p in points if p.method == over), key=lambda p: p.error)
    affordable = [p.error for p in points if p.method == method and p.wall_s <= finest.wall_s]
    return finest.error / min(affordable, default=math.inf)


def _measured(case: Case, method: str, tol: float, repeats: int) -> Point:
    exact = limit.least_thickness(case.half_angle, case.mu, case.voussoirs).eta
    if exact is None:
        message = "an arch that nothing lets stand has no error to measure"
        raise ValueError(message)
    work = 0.0

    def judge(eta: float) -> Answer:
        nonlocal work
        arch = Arch(half_angle=case.half_angle, eta=eta, voussoirs=case.voussoirs)
        seen = trial(arch, case.mu, method, moving=False)
        work += 2.0 * (case.voussoirs + 1) * seen.onset.sweeps
        return Answer(seen.verdict, seen.onset.acceleration)

    seconds: list[float] = []
    search = Search(judge)
    for _ in range(repeats):
        work, search = 0.0, Search(judge)
        started = time.perf_counter()
        search.expand(exact * START)
        search.bisect(tol)
        seconds.append(time.perf_counter() - started)
        if seconds[-1] > LONG:
            break
    low, high = search.low, search.high
    ends = (low, high)
    error = max(math.inf if end is None else abs(end / exact - 1) for end in ends)
    return Point(
        case=case.name,
        method=method,
        tol=tol,
        error=error,
        undecided=search.undecided,
        work=work,
        seconds=tuple(seconds),
    )
