"""What a method said of a structure, against what is known, and where engines differ."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from blocksim.arch.modes import Mode
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Problem
from blocksim.simulation.recording import Recording
from blocksim.simulation.verdict import Verdict


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """A structure as it falls, by rates as of `Check.mechanism`, or stands, without."""

    problem: Problem
    rates: Array | None
    states: tuple[JointState, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Row:
    """One question about a structure, answered by one method, against what is known.

    Fields are the columns of validate.csv, as docs/guide/formats.md has them. Arches of which
    modes are known are asked how thin they can be, and have columns of their own.

    `expected`: The value known; of those arches that of limit analysis, None where none stands.
    `value`: By limit analysis, or the centre of a bracket.
    `error`: Of it, relative; the difference where 0 is expected.
    `low`, `high`: Where an engine was asked, or the bracket.
    `at_low`, `at_high`: What it said there; of those arches 1 % below and above the centre, by
        onset test and moving run. None where not tried.
    `half_angle`, `weight`: Of those arches [rad].
    `modes_published`, `modes_theory`: Modes of the continuous arch, and by theory: all that
        coincide on a line of the map, so that none of them is wrong.
    `mode_limit`: Of the voussoirs as built, by limit analysis.
    `mode`: Of the mechanism it starts with, at the bracket's lower end.
    `mode_in_motion`: In the moving run 1 % below the bracket, where more than the weakest mode
        may move.
    `miss`: What disagrees; empty where nothing does.
    `note`: Why, or what to keep in mind.
    `drawn`: How it falls.
    `recording`: Of those arches the moving run 1 % below the bracket, where there was one.
    """

    structure: str
    title: str
    source: str
    blocks: int
    mu: float
    question: str = ""
    unit: str = ""
    expected: float | None = None
    published: str = ""
    expected_verdict: Verdict | None = None
    expected_hinges: tuple[int, ...] = ()
    method: str = "limit"
    value: float | None = None
    error: float | None = None
    digits: bool | None = None
    low: float | None = None
    high: float | None = None
    at_low: Verdict | None = None
    at_high: Verdict | None = None
    verdict: Verdict | None = None
    hinges: tuple[int, ...] = ()
    half_angle: float | None = None
    weight: str = ""
    modes_published: tuple[Mode, ...] = ()
    modes_theory: tuple[Mode, ...] = ()
    mode_limit: Mode | None = None
    mode: Mode | None = None
    mode_in_motion: Mode | None = None
    miss: str = ""
    note: str = ""
    wall_s: float = 0.0
    drawn: Drawn | None = None
    recording: Recording | None = None


def parted(found: Iterable[Row]) -> tuple[list[Row], list[Row]]:
    """Return rows on arches of which modes are known, and all others."""
    arches, others = list[Row](), list[Row]()
    for row in found:
        (arches if row.modes_published else others).append(row)
    return arches, others


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


def numbered(rows: Sequence[Row]) -> dict[str, int]:
    """Give each structure its number, whatever the methods."""
    names = dict.fromkeys(row.structure for row in rows)
    return {name: number for number, name in enumerate(names, start=1)}


def agree(one: Mode | None, other: Mode | None, coincident: Collection[Mode]) -> bool:
    """Tell whether two modes are one, or two of those that coincide on a line of the map."""
    return one is other or (one in coincident and other in coincident)


def disagreements(rows: Sequence[Row]) -> list[str]:
    """List where engines differ on an arch (not in modes that coincide), with the cause."""
    found: list[str] = []
    for name in dict.fromkeys(row.structure for row in rows):
        first, *others = (row for row in rows if row.structure == name)
        for other in others:
            pair = f"{name}: {first.method} and {other.method}"
            # The note of the engine that differs from `limit` says why.
            cause = (first.note if first.miss else other.note) or "no cause known"
            if not agree(first.mode, other.mode, first.modes_theory):
                seen = f"{first.mode or 'unnamed'}, {other.mode or 'unnamed'}"
                found.append(f"{pair} see different modes ({seen}): {cause}")
            if (first.at_low, first.at_high) != (other.at_low, other.at_high):
                found.append(f"{pair} judge 1 % aside differently: {cause}")
            if _exclusive(first, other) or _exclusive(other, first):
                found.append(f"{pair} have brackets that exclude each other: {cause}")
    return found


def _exclusive(one: Row, other: Row) -> bool:
    """Tell whether one bracket lies wholly above the other."""
    return one.low is not None and other.high is not None and one.low > other.high
