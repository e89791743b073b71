"""Walls of rectangular blocks in courses, with openings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

from blocksim.blocks.made import Made
from blocksim.blocks.maker import Maker, Table, count, metres, parameter
from blocksim.common.checks import require
from blocksim.kinds.blockwork import box, floor
from blocksim.kinds.openings import ASKED, SLIVER, Opening, require_within, without


@dataclass(frozen=True, kw_only=True)
class Wall(Maker):
    """A wall on a floor; the origin is its lower left corner."""

    name: ClassVar[str] = "wall"
    about: ClassVar[str] = "courses of blocks in bond, with openings"
    row_types: ClassVar[Mapping[str, type[Table]]] = {"openings": Opening}

    length: float = metres(2.0, "length of the wall")
    courses: int = count(6, "number of courses")
    block_length: float = metres(0.4, "length of a block")
    block_height: float = metres(0.2, "height of a course")
    bond: float = parameter(
        0.5, "how far each course is set off from the one below, in block lengths", high=1.0,
        above=False,
    )  # fmt: skip
    first: float = parameter(
        1.0, "length of the first block of the lowest course, in block lengths", high=1.0
    )
    openings: tuple[Opening, ...] = parameter((), ASKED, nested="tables")
    depth: float = metres(1.0, "depth out of the plane")

    def __post_init__(self) -> None:
        """Check that openings lie in the wall."""
        super().__post_init__()
        blocks = self.length / self.block_length * self.courses
        require(blocks <= 1e5, "block_length", self.block_length, "longer: over 100000 blocks")
        require_within(self.openings, self.length, self.courses)

    def made(self, density: float) -> Made:  # noqa: ARG002
        """Make a floor and the blocks, named by course and place; joints are found."""
        levels = [course * self.block_height for course in range(self.courses + 1)]
        bodies = [
            box(f"{course}.{place}", ends, up, depth=self.depth)
            for course, up in enumerate(pairwise(levels), 1)
            for place, ends in enumerate(self._blocks(course), 1)
        ]
        reach = self.length / 10
        return Made(bodies=(floor(-reach, self.length + reach, 0.0, reach), *bodies))

    def _blocks(self, course: int) -> list[tuple[float, float]]:
        """Return where the blocks of a course begin and end."""
        sliver = SLIVER * self.block_length
        set_off = round(self.first + self.bond * (course - 1), 12) % 1.0
        cuts, number = [0.0], 0 if set_off > SLIVER else 1
        while (cut := (set_off + number) * self.block_length) < self.length - sliver:
            cuts.append(cut)
            number += 1
        found = list(zip(cuts, [*cuts[1:], self.length], strict=True))
        return without(found, self.openings, course, self.block_length)
