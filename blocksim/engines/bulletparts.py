"""What `bulletmotion` asks of blocks that are put into Bullet: in the plane, or in space."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple, Protocol

from blocksim.blocks.assembly import Array
from blocksim.engines.bulletspace import Framed, Space, State
from blocksim.engines.energy import Balance
from blocksim.engines.solids import Meeting


class Built(NamedTuple):
    """Bodies in a space.

    Parameters
    ----------
    bodies : list of int
        Of each block.
    joints : dict
        By two bodies and the link of each, as `bulletspace.Contact.pair`: the joints at which
        they touch, and 1 if the first is `after`, else -1.
    """

    bodies: list[int]
    joints: dict[tuple[int, int, int, int], list[tuple[int, float]]]


Ends = dict[int, list[tuple[int, int, float]]]
"""By joint: on its first side a body, a link of it, 1 if on `after` and else -1; then what it
touches on the other, likewise."""


def met(space: Space, ends: Ends) -> dict[tuple[int, int, int, int], list[tuple[int, float]]]:
    """Let the two sides of each joint touch each other."""
    joints: dict[tuple[int, int, int, int], list[tuple[int, float]]] = defaultdict(list)
    for joint, ((one, first, sense), *others) in ends.items():
        for other, second, against in others:
            joints[one, other, first, second].append((joint, sense))
            joints[other, one, second, first].append((joint, against))
            space.meet(one, other, first, second)
    return joints


class Pulled(Protocol):
    """A problem with gravity."""

    @property
    def gravity(self) -> Array:
        """Force on each block in units of its weight, (3,)."""
        ...


class Parts(Protocol):
    """Blocks as bodies of Bullet, in the plane or in space."""

    @property
    def turns(self) -> list[int]:
        """Columns of poses that make a rotation vector."""
        ...

    @property
    def problem(self) -> Pulled:
        """What is asked about."""
        ...

    @property
    def frame(self) -> Framed:
        """Where the assembly lies in Bullet's frame."""
        ...

    @property
    def states(self) -> list[State]:
        """How blocks are built."""
        ...

    @property
    def reach(self) -> Array:
        """How far corners are from centres, (blocks,) [size]."""
        ...

    @property
    def breaking(self) -> float:
        """Breaking threshold for blocks with links."""
        ...

    @property
    def solids(self) -> Meeting:
        """When they may meet others."""
        ...

    @property
    def can_be_layered(self) -> bool:
        """Whether blocks can be bodies without links."""
        ...

    def balance(self, poses: Array) -> Balance:
        """Return what looks at energy."""
        ...

    def displacement(self, moved: Array) -> float:
        """Return the largest displacement of any corner."""
        ...

    def loads(self, poses: Array) -> Array | None:
        """Return loads besides gravity, (blocks, 6), or None."""
        ...

    def pressures(self, forces: Array) -> Array:
        """Return pressures at contacts, of forces of limit analysis."""
        ...

    def flatten(self, space: Space, bodies: list[int], poses: Array) -> None:
        """Put back what has left the plane, where motion lies in one."""
        ...

    def linked(self, space: Space, reaches: Array | None = None) -> Built:
        """Create bodies with links; sides of joints may reach into each other."""
        ...

    def layered(self, space: Space) -> Built:
        """Build anew, of bodies without links."""
        ...

    def solid(self, space: Space, states: Sequence[State]) -> list[int]:
        """Build anew, as solid bodies that may meet any other."""
        ...
