"""What can be said of an arch."""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """Outcome of a check; `UNDECIDED` is an answer, not a failure."""

    STANDS = "stands"
    COLLAPSES = "collapses"
    UNDECIDED = "undecided"
