"""Kinds of structures by name: parameters in, blocks and joints out."""

from blocksim.kinds.arcade import Arcade
from blocksim.kinds.base import Kind as Kind
from blocksim.kinds.basket import BasketHandleArch
from blocksim.kinds.catenary import CatenaryArch
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.column import Column
from blocksim.kinds.elliptic import EllipticArch
from blocksim.kinds.flat import FlatArch
from blocksim.kinds.parabolic import ParabolicArch
from blocksim.kinds.pointed import PointedArch
from blocksim.kinds.portal import Portal
from blocksim.kinds.rubble import Rubble
from blocksim.kinds.stack import Stack
from blocksim.kinds.wall import Wall

KINDS: dict[str, type[Kind]] = {
    kind.name: kind
    for kind in (
        CircularArch,
        PointedArch,
        EllipticArch,
        ParabolicArch,
        CatenaryArch,
        BasketHandleArch,
        FlatArch,
        Portal,
        Arcade,
        Wall,
        Column,
        Stack,
        Rubble,
    )
}
"""All there are."""
