"""Openings in walls of courses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from blocksim.blocks.maker import Table, count, metres
from blocksim.common.checks import require

SLIVER = 1e-6
"""Width of what is left of a block, over its length, that counts as nothing."""
ASKED = "tables with left, right, from_course and to_course"
"""What a wall says of its parameter."""


@dataclass(frozen=True, kw_only=True)
class Opening(Table):
    """A gap in a wall: blocks are cut at its sides, and those above it span it."""

    left: float = metres(0.0, "its left side, from the wall's left end", low=-1e-9)
    right: float = metres(1.0, "its right side")
    from_course: int = count(1, "lowest course it cuts; 1 is on the ground")
    to_course: int = count(1, "highest course it cuts")


def require_within(openings: Sequence[Opening], length: float, courses: int) -> None:
    """Raise `InputError` unless openings lie in a wall of a length [m] and some courses."""
    for at, gap in enumerate(openings):
        field = f"openings[{at}]"
        within = f"from left = {gap.left:g} to length = {length:g} m"
        require(gap.left < gap.right <= length, f"{field}.right", gap.right, within)
        above = f"a whole number from {gap.from_course} to {courses}"
        ok = gap.from_course <= gap.to_course <= courses
        require(ok, f"{field}.to_course", gap.to_course, above)


def without(
    found: Sequence[tuple[float, float]], openings: Sequence[Opening], course: int, long: float
) -> list[tuple[float, float]]:
    """Return where blocks of a course begin and end beside its openings [m].

    `found`: Where they would without.
    `long`: Length of a block.
    """
    left = list(found)
    for gap in openings:
        if gap.from_course <= course <= gap.to_course:
            pieces = [
                piece
                for start, end in left
                for piece in (
                    (start, min(end, max(0.0, gap.left))),
                    (max(start, gap.right), end),
                )
            ]
            left = [(start, end) for start, end in pieces if end - start > SLIVER * long]
    return left
