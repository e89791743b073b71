"""One arch by one engine against what is known, and where engines differ."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from typing import TypeVar

from blocksim.arch.modes import Mode
from blocksim.common.processes import Hands
from blocksim.common.progress import Progress
from blocksim.simulation.recording import Recording
from blocksim.simulation.verdict import Verdict

Job = TypeVar("Job")
Found = TypeVar("Found")


def answered(
    ask: Callable[[Job], Found],
    jobs: Sequence[tuple[str, Job]],
    workers: int,
    progress: Progress,
) -> list[Found]:
    """Do named jobs by so many processes, and return their results in order."""
    if workers == 1:
        found: list[Found] = []
        for done, (name, job) in enumerate(jobs):
            progress(done / len(jobs), name)
            found.append(ask(job))
        return found
    with Hands(workers) as hands:
        futures = {hands.submit(ask, job): name for name, job in jobs}
        for done, future in enumerate(as_completed(futures)):
            progress((done + 1) / len(jobs), futures[future])
        return [future.result() for future in futures]


@dataclass(frozen=True, kw_only=True)
class Validation:
    """One scenario by one engine, against what is known.

    `modes_published`: Of the continuous arch: several on a line of the map.
    `modes_theory`: The same by theory: all that coincide there, so that none of them is wrong.
    `eta_low`, `eta_high`: The bracket.
    `error`: Centre of the bracket over `eta_limit`, less 1.
    `mode_observed`: Of the mechanism it starts with, at the bracket's lower end.
    `mode_in_motion`: In the moving run 1 % below the bracket, where more than the weakest mode
        may move.
    `below`, `above`: 1 % below and above the bracket, by onset test and moving run; None where
        not tried.
    `miss`: What disagrees; empty where nothing does.
    `note`: Why, or what to keep in mind.
    `title`, `source`: Of the scenario.
    `recording`: The moving run 1 % below the bracket; None where there was none.
    """

    scenario: str
    half_angle: float
    engine: str
    mu: float
    voussoirs: int
    weight: str
    modes_published: tuple[Mode, ...]
    modes_theory: tuple[Mode, ...] = ()
    eta_published: float | None
    eta_limit: float | None = None
    mode_limit: Mode | None = None
    eta_low: float | None = None
    eta_high: float | None = None
    error: float | None = None
    mode_observed: Mode | None = None
    mode_in_motion: Mode | None = None
    below: Verdict | None = None
    above: Verdict | None = None
    miss: str = ""
    note: str = ""
    wall_s: float = 0.0
    title: str
    source: str
    recording: Recording | None = None


@dataclass(frozen=True, kw_only=True)
class Unasked:
    """Scenarios, by name, that an engine was not asked about."""

    engine: str
    scenarios: tuple[str, ...]
    why: str

    @property
    def words(self) -> str:
        """Engine, scenarios and reason in a line."""
        return f"{self.engine}: {', '.join(self.scenarios)} ({self.why})"


def numbered(rows: Sequence[Validation]) -> dict[str, int]:
    """Give each scenario its number, whatever the engines."""
    names = dict.fromkeys(row.scenario for row in rows)
    return {name: number for number, name in enumerate(names, start=1)}


def agree(one: Mode | None, other: Mode | None, coincident: Collection[Mode]) -> bool:
    """Tell whether two modes are one, or two of those that coincide on a line of the map."""
    return one is other or (one in coincident and other in coincident)


def disagreements(rows: Sequence[Validation]) -> list[str]:
    """List where engines differ on a scenario (not in modes that coincide), with the cause."""
    found: list[str] = []
    for name in dict.fromkeys(row.scenario for row in rows):
        first, *others = (row for row in rows if row.scenario == name)
        for other in others:
            pair = f"{name}: {first.engine} and {other.engine}"
            # The note of the engine that differs from `limit` says why.
            cause = (first.note if first.miss else other.note) or "no cause known"
            if not agree(first.mode_observed, other.mode_observed, first.modes_theory):
                seen = f"{first.mode_observed or 'unnamed'}, {other.mode_observed or 'unnamed'}"
                found.append(f"{pair} see different modes ({seen}): {cause}")
            if (first.below, first.above) != (other.below, other.above):
                found.append(f"{pair} judge 1 % aside differently: {cause}")
            if _exclusive(first, other) or _exclusive(other, first):
                found.append(f"{pair} have brackets that exclude each other: {cause}")
    return found


def _exclusive(one: Validation, other: Validation) -> bool:
    """Tell whether one bracket lies wholly above the other."""
    return (
        one.eta_low is not None and other.eta_high is not None and one.eta_low > other.eta_high
    )
