"""What can be said of blocks, and what it rests on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """Outcome of a check; `UNDECIDED` is an answer, not a failure."""

    STANDS = "stands"
    COLLAPSES = "collapses"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Evidence:
    """What was seen, by which test.

    Parameters
    ----------
    test : str
        `onset test`, `moving run`, `limit analysis`, `closed form`, `search`, `shaking`,
        `motion`; and what else there is to know of it: `method`, `settings`, `reduction`,
        `note`.
    found : str
        In words, in one line.
    """

    test: str
    found: str


def aside(test: str, words: str) -> tuple[Evidence, ...]:
    """Return words that follow others after a semicolon as evidence; none of none."""
    return (Evidence(test, words.removeprefix("; ")),) if words else ()


SEEN = {"onset test", "moving run"}
"""Tests that are named in a sentence, too, where there were both."""


def reason_of(evidence: Sequence[Evidence]) -> str:
    """Return all evidence as one sentence."""
    named = SEEN if {each.test for each in evidence} >= SEEN else set[str]()
    return "; ".join(
        f"{each.test}: {each.found}" if each.test in named else each.found for each in evidence
    )
