"""What makes problems in space: a table of parameters, and the solids it makes of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar, Self

from blocksim.blocks.maker import UNIT_WEIGHT, Table
from blocksim.blocks.space.assembly import Solid, SpatialAssembly, assembly_in_space
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.checks import PER_VOLUME, SMOOTH_OR_ROUGH, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import Field, fields_of


@dataclass(frozen=True, kw_only=True)
class SolidMaker(Table, ABC):
    """What makes a problem in space of its parameters.

    A class of one's own has a `name`, parameters, and `solids`.

    Parameters
    ----------
    friction : float or None
        Friction coefficient of every joint, inf allowed; needed for a problem.
    density : float or None
        Weight per volume [N/m^3]; without it only ratios of forces have a meaning.
    """

    name: ClassVar[str]
    about: ClassVar[str] = ""

    friction: float | None = None
    density: float | None = None

    def __post_init__(self) -> None:
        """Check the parameters, then friction and density."""
        super().__post_init__()
        for known, field in ((SMOOTH_OR_ROUGH, "friction"), (PER_VOLUME, "density")):
            if getattr(self, field) is not None:
                known.require(field, getattr(self, field))

    @abstractmethod
    def solids(self) -> tuple[Solid, ...]:
        """Make the blocks; joints are found."""

    @cached_property
    def assembly(self) -> SpatialAssembly:
        """The blocks and their joints, made once."""
        density = UNIT_WEIGHT if self.density is None else self.density
        return assembly_in_space(self.solids(), density=density)

    def problem(self) -> SpatialProblem:
        """Return what is made, under its own weight.

        Raises
        ------
        InputError
            If there is no friction, or nothing can be built of the parameters.
        """
        if self.friction is None:
            raise InputError("friction", MISSING, "given")
        return SpatialProblem(
            assembly=self.assembly,
            mu=self.friction,
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
