"""Stacks of equal blocks that reach beyond what they stand on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from blocksim.blocks.given import Body
from blocksim.blocks.made import Made
from blocksim.blocks.maker import Maker, count, metres, parameter
from blocksim.kinds.blockwork import box


@dataclass(frozen=True, kw_only=True)
class Stack(Maker):
    """Rows of blocks; the origin is the edge of the table, or the middle of the foot.

    Patterns, from the lowest row up:

    - `harmonic`: one block a row, the k-th from the top beyond the one below in proportion to
      1/k, the farthest that stands when the overhang is length/2 (1 + 1/2 + ... + 1/rows);
    - `even`: one block a row, each as far beyond the one below;
    - `inverted-triangle`: 1, 2, 3, ... blocks a row, on a foot one block wide;
    - `diamond`: the same up to the middle row, and down again.
    """

    name: ClassVar[str] = "stack"
    about: ClassVar[str] = "equal blocks that reach beyond what they stand on"

    pattern: str = parameter(
        "harmonic",
        "how rows lie on each other",
        choices=("harmonic", "even", "inverted-triangle", "diamond"),
    )
    rows: int = count(5, "number of rows", high=200)
    length: float = metres(1.0, "length of a block")
    height: float = metres(0.25, "height of a block")
    overhang: float = metres(
        1.0, "how far the top block reaches beyond the table; of one block a row", stands="low"
    )
    depth: float = metres(1.0, "depth out of the plane")

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: each block lies on the one below."""
        low, high = super().limits(name)
        if name == "overhang":
            steps = self._steps()
            high = min(high, self.length * (1 - 1e-3) * sum(steps) / max(steps))
        if name == "rows" and self.pattern == "diamond":
            low = 1
        return low, high

    def _steps(self) -> list[float]:
        """How far each block goes beyond the one below, from the lowest up, in proportion."""
        if self.pattern != "harmonic":
            return [1.0] * self.rows
        return [1 / (self.rows - row) for row in range(self.rows)]

    def made(self, density: float) -> Made:  # noqa: ARG002
        """Make a table or a foot, and the blocks; joints are found."""
        if self.pattern in {"harmonic", "even"}:
            return self._leaning()
        foot = box("foot", (-self.length / 2, self.length / 2), (-self.height, 0.0), fixed=True)
        bodies: list[Body] = [foot]
        for row in range(self.rows):
            blocks = row + 1
            if self.pattern == "diamond":
                blocks = min(blocks, self.rows - row)
            for place in range(blocks):
                left = (place - blocks / 2) * self.length
                bodies.append(self._block(f"{row + 1}.{place + 1}", left, row))
        return Made(bodies=tuple(bodies))

    def _leaning(self) -> Made:
        steps = self._steps()
        beyond, bodies = 0.0, list[Body]()
        for row, step in enumerate(steps):
            beyond += step * self.overhang / sum(steps)
            bodies.append(self._block(str(row + 1), beyond - self.length, row))
        table = box("table", (-2 * self.length, 0.0), (-self.length / 2, 0.0), fixed=True)
        return Made(bodies=(table, *bodies))

    def _block(self, name: str, left: float, row: int) -> Body:
        levels = row * self.height, (row + 1) * self.height
        return box(name, (left, left + self.length), levels, depth=self.depth)
