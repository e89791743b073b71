"""What films say: outcome, what a structure is up against, words that fit."""

from __future__ import annotations

import math

from blocksim.simulation.motion import MOVED, UNMOVED
from blocksim.simulation.recording import Recording
from blocksim.simulation.shaken import outcome
from blocksim.simulation.verdict import Verdict
from blocksim.view.canvas import width_of

LENGTH = 6.0
"""How long the motion takes in a film whose slowness is not given, about [s]."""
SLOW = (1, 2, 3, 4, 5, 6, 8)
"""Slow motion is one of these times a power of ten."""


def verdict_words(recording: Recording, verdict: Verdict | None = None) -> str:
    """Say whether it falls: as a check does, or by how far it has moved."""
    if verdict is not None:
        return verdict.value
    if recording.problem.shaking is not None:
        return outcome(recording)[0].value
    moved = float(recording.displacement.max())
    if moved > MOVED:
        return Verdict.COLLAPSES.value
    if moved <= UNMOVED:
        return "at rest"
    if not recording.problem.has_size:
        return f"has moved {moved:.1g} r"
    return f"has moved {moved * recording.assembly.size:.1g} m"


def fitting(words: str, size: float, wide: float, *, bold: bool = False) -> str:
    """Cut words off where they would not fit into a width in pixels."""
    kept = words
    while len(kept) > 1 and (have := width_of(kept, size, bold=bold)) > wide:
        # Measuring is slow: cut in proportion.
        kept = kept[: min(len(kept) - 2, int(len(kept) * wide / have))].rstrip() + "…"
    return kept


def slowness(seconds: float) -> float:
    """Slow motion that makes a film about `LENGTH` long, never fast."""
    wanted = max(1.0, LENGTH / max(seconds, 1e-9))
    power = 10.0 ** math.floor(math.log10(wanted))
    return min((step * power for step in (*SLOW, 10)), key=lambda slow: abs(slow - wanted))


def digits_of(seconds: float) -> int:
    """Decimals of the clock: thousandths of what is shown."""
    return max(1, min(6, math.ceil(2 - math.log10(max(seconds, 1e-9)))))
