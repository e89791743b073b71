"""What makes problems in space: a table of parameters, and the solids it makes of them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Self

from blocksim.blocks.maker import Kind
from blocksim.blocks.space.assembly import Solid, SpatialAssembly, assembly_in_space
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.checks import require
from blocksim.common.fields import Field, fields_of


@dataclass(frozen=True, kw_only=True)
class SolidMaker(Kind):
    """What makes a problem in space of its parameters.

    A class of one's own has a `name`, parameters, and `solids`.

    Parameters
    ----------
    friction : float or None
        Friction coefficient of every joint, inf allowed; needed for a problem.
    density : float or None
        Weight per volume [N/m^3]; without it only ratios of forces have a meaning.
    """

    @abstractmethod
    def solids(self) -> tuple[Solid, ...]:
        """Make the blocks; joints are found."""

    @cached_property
    def assembly(self) -> SpatialAssembly:
        """The blocks and their joints, made once."""
        return assembly_in_space(self.solids(), density=self.unit_weight)

    def problem(self) -> SpatialProblem:
        """Return what is made, under its own weight.

        Raises
        ------
        InputError
            If there is no friction, or nothing can be built of the parameters.
        """
        mu = self.known_friction
        return SpatialProblem(
            assembly=self.assembly,
            mu=mu,
            title=self.name,
            maker=self,
            weighed=self.density is not None,
        )

    def but(self, **changes: Any) -> Self:
        """Return the same with other values."""
        given = {each.name: getattr(self, each.name) for each in fields(self) if each.init}
        for name, value in changes.items():
            known = ", ".join(fields_of(type(self)))
            require(name in given, name, value, f"left out: a {self.name} has {known}")
        return type(self)(**{**given, **changes})

    @property
    def bracketed(self) -> Mapping[str, Field]:
        """The parameters that may be bracketed over."""
        known = fields_of(type(self))
        return {name: each for name, each in known.items() if each.stands is not None}
