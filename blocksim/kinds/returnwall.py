"""Walls in running bond with a return and openings, asked in space."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from blocksim.blocks.maker import Table, count, metres, parameter
from blocksim.blocks.space.assembly import Solid
from blocksim.blocks.space.maker import SolidMaker
from blocksim.kinds.openings import ASKED, Opening, require_within, without
from blocksim.kinds.solids import box, ground


@dataclass(frozen=True, kw_only=True)
class ReturnWall(SolidMaker):
    """A wall along x in running bond, with a return along y at its left end.

    Bricks are twice as long as they are wide, so that the corner is in bond, too.
    """

    name: ClassVar[str] = "return-wall"
    about: ClassVar[str] = "a wall in running bond with a return and openings"
    row_types: ClassVar[Mapping[str, type[Table]]] = {"openings": Opening}

    courses: int = count(6, "number of courses", high=200)
    bricks: int = count(4, "bricks of a course along the wall", high=200)
    returned: int = count(2, "bricks of a course along the return", low=0, high=200)
    width: float = metres(0.2, "width of a brick; its length is twice that")
    height: float = metres(0.15, "height of a brick")
    openings: tuple[Opening, ...] = parameter((), ASKED, nested="tables")

    def __post_init__(self) -> None:
        """Check that openings lie in the wall along x."""
        super().__post_init__()
        require_within(self.openings, 2 * self.width * self.bricks, self.courses)

    def solids(self) -> tuple[Solid, ...]:
        """Make the ground and the bricks, course by course."""
        far = 2 * self.width * (self.bricks + self.returned + 2)
        solids = [ground(2 * far, self.width)]
        for course in range(self.courses):
            levels = course * self.height, (course + 1) * self.height
            odd = course % 2
            bricks = list(itertools.pairwise(self._cuts(self.bricks, odd)))
            bricks = without(bricks, self.openings, course + 1, 2 * self.width)
            for at, ends in enumerate(bricks):
                name = f"{course + 1}.{at + 1}"
                solids.append(box(name, ends, (0.0, self.width), levels))
            if not self.returned:
                continue
            cuts = [self.width + each for each in self._cuts(self.returned, odd, ends=False)]
            for at, ends in enumerate(itertools.pairwise(cuts)):
                name = f"{course + 1}.r{at + 1}"
                solids.append(box(name, (0.0, self.width), ends, levels))
        return tuple(solids)

    def _cuts(self, bricks: int, odd: int, *, ends: bool = True) -> list[float]:
        """Return where bricks of a course end: in every other one half a brick on [m]."""
        long = 2 * self.width
        if not odd:
            return [at * long for at in range(bricks + 1)]
        inner = [0.0, *(self.width + at * long for at in range(bricks))]
        return [*inner, bricks * long] if ends else [*inner, self.width + bricks * long]
