"""What makes problems in space: a table of parameters, and the solids it makes of them."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

from blocksim.blocks.made import Built
from blocksim.blocks.maker import Kind
from blocksim.blocks.space.assembly import Solid, SpatialAssembly
from blocksim.blocks.space.joining import assembly_in_space


@dataclass(frozen=True, kw_only=True)
class SolidMaker(Kind[SpatialAssembly]):
    """What makes a problem in space of its parameters.

    A class of one's own has a `name`, parameters, and `solids`.
    """

    in_space = True

    @abstractmethod
    def solids(self) -> tuple[Solid, ...]:
        """Make the blocks; joints are found."""

    @cached_property
    def named(self) -> tuple[Solid, ...]:
        """The blocks as they were made; one without a name is called by its place."""
        made = self.solids()
        return tuple(replace(each, name=each.name or str(at)) for at, each in enumerate(made))

    @cached_property
    def built(self) -> Built[SpatialAssembly]:
        """The blocks and their joints, made once."""
        return Built(assembly=assembly_in_space(self.named, density=self.unit_weight))
