"""From which value on does it fall? An interval of one parameter, both ends tried."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from blocksim.ask.families import Family
from blocksim.ask.methods import choose, chosen_words
from blocksim.ask.search import Answer, Search
from blocksim.common.checks import is_number, require
from blocksim.common.progress import Progress, silent
from blocksim.evidence.setup import BY_RULE, Overrides, given_words
from blocksim.evidence.trial import Held, conclude, hold
from blocksim.evidence.verdict import Verdict
from blocksim.limit import equilibrium

SURE = 1e-8
"""How far to both sides of its value limit analysis is asked again, relative."""
FARTHEST = 1e3
"""How far from its first value a search goes, as a ratio."""
GUESS = 0.1
"""Share of the range at which a search begins where limit analysis gives no value."""


@dataclass(frozen=True, kw_only=True)
class Bracket:
    """Where a family of problems changes from standing to falling, between two values tried.

    Parameters
    ----------
    method, over, unit : str
    low, high : float or None
        The two values tried, low below high; None where the search came to the end of the
        range without an answer of that kind.
    stands : {"low", "high"}
        At which end it stands.
    limit : float or None
        The exact value, where limit analysis knows it; inf where it stands at all values.
    confirmed : bool or None
        Whether moving runs, or a second linear programme, at both ends agree; None where
        not both ends were found.
    runs, undecided : int
        Values tried, and those without an answer.
    reason : str
    wall_s : float
    """

    method: str
    over: str
    unit: str
    low: float | None
    high: float | None
    stands: str
    limit: float | None
    confirmed: bool | None
    runs: int
    undecided: int
    reason: str
    wall_s: float


def bracket(
    family: Family,
    *,
    method: str = "auto",
    tol: float = 0.005,
    within: tuple[float, float] | None = None,
    settings: Overrides = BY_RULE,
    progress: Progress = silent,
) -> Bracket:
    """Find the value of a family's parameter at which it changes from standing to falling.

    Engines search with the onset test and let the blocks go at both ends. The search starts
    at the value of limit analysis where there is one, and only starts there.

    Parameters
    ----------
    family : Family
    method : str
        `auto`, `limit`, or the name of an engine.
    tol : float
        Relative width at which to end, above 0 and at most 0.5.
    within : tuple of float, optional
        Where to search; by default where limit analysis says, within the family's range.
    settings : mapping of str to float
        Of `blocksim.evidence.setup.SETTINGS`, instead of what the engine's rule says.
    progress : Progress, optional

    Returns
    -------
    Bracket

    Raises
    ------
    InputError
        If a value is out of range, or the method cannot do what is asked for.
    MissingPart
        If the engine's library is not installed.
    """
    started = time.perf_counter()
    require(is_number(tol, 0, 0.5), "tol", tol, "above 0 and at most 0.5")
    low, high = within or (family.low, family.high)
    ranged = family.low <= low < high <= family.high
    allowed = f"two values, the lower first, from {family.low:g} to {family.high:g}"
    require(ranged, "within", f"{low:g} {high:g}", allowed)
    probe = family.at(low + GUESS * (high - low))
    chosen = choose(method, tol, problem=probe, settings=settings)
    exact = family.exact() if probe.is_planar else None
    said = family.remark() if probe.is_planar else ""
    if chosen.is_static:
        found = _by_limit(family, exact)
    else:
        start = exact if exact and math.isfinite(exact) and low <= exact <= high else None
        start = start or low + GUESS * (high - low)
        found = _by_engine(
            family, chosen.name, start, (low, high), tol, settings=settings, progress=progress
        )
    lower, upper, confirmed, runs, undecided, reason = found
    return Bracket(
        method=chosen.name,
        over=family.name,
        unit=family.unit,
        low=lower,
        high=upper,
        stands=family.stands,
        limit=exact,
        confirmed=confirmed,
        runs=runs,
        undecided=undecided,
        reason=reason + said + given_words(settings) + chosen_words(method, chosen),
        wall_s=time.perf_counter() - started,
    )


Found = tuple[float | None, float | None, bool | None, int, int, str]
"""Both ends, whether confirmed, values tried, those undecided, and the evidence."""


def _by_limit(family: Family, exact: float | None) -> Found:
    """Ask a linear programme a little to both sides of its own value."""
    if exact is None:
        return None, None, None, 0, 0, "no forces of equilibrium exist at any value"
    if math.isinf(exact):
        return None, None, None, 0, 0, "forces of equilibrium exist at all values"
    if exact < family.low:
        least = family.low
        return None, least, None, 1, 0, f"forces of equilibrium exist down to {least:.6g}"
    low, high = exact * (1 - SURE), exact * (1 + SURE)
    stood = [equilibrium(family.at(value)).exists for value in (low, high)]
    confirmed = stood == [family.stands == "low", family.stands == "high"]
    words = "confirmed" if confirmed else "not confirmed"
    reason = f"limit analysis: a linear programme, {words} by two others at the ends"
    return low, high, confirmed, 2, 0, reason


def _by_engine(
    family: Family,
    engine: str,
    start: float,
    within: tuple[float, float],
    tol: float,
    *,
    settings: Overrides,
    progress: Progress,
) -> Found:
    """Search with the onset test, then let the blocks go at both ends.

    The search knows parameters of which more is safer: of others it is given the inverse.
    """
    inverse = family.stands == "low"
    ends: dict[Verdict, tuple[float, Held]] = {}

    def turned(value: float) -> float:
        return 1 / value if inverse else value

    def judge(strength: float) -> Answer:
        value = turned(strength)
        held = hold(family.at(value), engine, settings=settings)
        # Every answer narrows the bracket: the last of each kind is that of its end.
        ends[held.onset.verdict] = value, held
        return Answer(held.onset.verdict, held.onset.acceleration)

    low, high = within
    weakest = 1 / high if inverse else max(low, start / FARTHEST)
    strongest = 1 / max(low, start / FARTHEST) if inverse else high
    search = Search(judge, progress, floor=weakest, ceiling=strongest, name=family.name)
    search.expand(turned(start))
    search.bisect(tol)
    agreed: list[bool] = []
    for expected in (Verdict.COLLAPSES, Verdict.STANDS):
        if expected in ends:
            value, held = ends[expected]
            progress(0.95, f"moving run at {family.name} {value:.6g}")
            agreed.append(conclude(held, moving=True).verdict is expected)
    confirmed = all(agreed) if len(agreed) == 2 else None
    words = {True: "confirmed", False: "not confirmed", None: "not both found"}[confirmed]
    reason = f"onset test at {search.runs} values, ends {words} by moving runs"
    falls, stands = (
        None if each is None else turned(each) for each in (search.low, search.high)
    )
    lower, upper = (stands, falls) if inverse else (falls, stands)
    return lower, upper, confirmed, search.runs, search.undecided, reason
