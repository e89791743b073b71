"""What a kind makes of its parameters, and the blocks of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic

from blocksim.blocks.assembly import Blocks

if TYPE_CHECKING:
    from blocksim.blocks.acting import Load
    from blocksim.blocks.given import Body, GivenJoint


@dataclass(frozen=True, eq=False, kw_only=True)
class Fill:
    """What presses on a block besides gravity.

    Parameters
    ----------
    body : int
        Which of the bodies bears it.
    weight : float
        [N]
    point : (float, float)
        Where its line of action meets the block [m].
    """

    body: int
    weight: float
    point: tuple[float, float]


@dataclass(frozen=True, eq=False, kw_only=True)
class Made:
    """What a kind makes of its parameters.

    Parameters
    ----------
    bodies : tuple of Body
    joints : tuple of GivenJoint or None
        None where they are to be found.
    fills : tuple of Fill
    """

    bodies: tuple[Body, ...]
    joints: tuple[GivenJoint, ...] | None = None
    fills: tuple[Fill, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Built(Generic[Blocks]):
    """Blocks as engines and limit analysis take them.

    Parameters
    ----------
    assembly : Assembly or SpatialAssembly
    fills : tuple of Load
        What presses on blocks besides gravity.
    notes : tuple of str
        What was mended or assumed.
    bodies : tuple of Body
        Of which the blocks were made; none where they were made of nothing else.
    """

    assembly: Blocks
    fills: tuple[Load, ...] = ()
    notes: tuple[str, ...] = ()
    bodies: tuple[Body, ...] = ()
