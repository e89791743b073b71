"""Columns of drums."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from blocksim.blocks.made import Made
from blocksim.blocks.maker import Maker, count, metres
from blocksim.common.errors import InputError
from blocksim.kinds.blockwork import floor, pier


@dataclass(frozen=True, kw_only=True)
class Column(Maker):
    """Drums on each other; the origin is the middle of the foot."""

    name: ClassVar[str] = "column"
    about: ClassVar[str] = "drums on each other"

    drums: int = count(6, "number of drums")
    drum_height: float = metres(0.6, "height of a drum", stands="low")
    width: float = metres(1.0, "width of the column at its foot", stands="high")
    top_width: float | None = metres(
        None, "width of the column at its top; as at its foot if left out", optional=True
    )
    depth: float = metres(1.0, "depth out of the plane")

    def __post_init__(self) -> None:
        """Check that it does not widen into a needle."""
        super().__post_init__()
        if self.top_width is not None and self.top_width < self.width / 1e3:
            raise InputError("top_width", self.top_width, "a thousandth of width or more")

    def made(self, density: float) -> Made:  # noqa: ARG002
        """Make a floor and the drums; joints are found."""
        foot = self.width / 2
        head = foot if self.top_width is None else self.top_width / 2
        high = self.drums * self.drum_height
        drums = pier("drum", (-foot, foot), (-head, head), 0.0, high, self.drums, self.depth)
        return Made(bodies=(floor(-4 * foot, 4 * foot, 0.0, foot), *drums))
