"""What makes problems in space: a table of parameters, and the solids it makes of them."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property

from blocksim.blocks.made import Built
from blocksim.blocks.maker import Kind
from blocksim.blocks.space.assembly import Solid, SpatialAssembly, assembly_in_space
from blocksim.blocks.space.problem import SpatialProblem


@dataclass(frozen=True, kw_only=True)
class SolidMaker(Kind):
    """What makes a problem in space of its parameters.

    A class of one's own has a `name`, parameters, and `solids`.
    """

    @abstractmethod
    def solids(self) -> tuple[Solid, ...]:
        """Make the blocks; joints are found."""

    @cached_property
    def built(self) -> Built[SpatialAssembly]:
        """The blocks and their joints, made once."""
        return Built(assembly=assembly_in_space(self.solids(), density=self.unit_weight))

    def problem(self) -> SpatialProblem:
        """Return what is made, under its own weight."""
        return SpatialProblem(
            mu=self.known_friction,
            assembly=self.built.assembly,
            title=self.name,
            maker=self,
            weighed=self.density is not None,
        )
