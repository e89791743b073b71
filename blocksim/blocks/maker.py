"""What makes problems: a table of parameters, and the blocks it makes of them.

Every kind of structure is one. So is a class of a user's own, which needs a name, parameters
(`parameter`, `metres`, `count`) and `made`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any, ClassVar, Generic, Self, cast

from blocksim.blocks.assembly import Assembly, Blocks
from blocksim.blocks.made import Built, Made
from blocksim.blocks.problem import Problem
from blocksim.common.checks import LENGTH, PER_VOLUME, SMOOTH_OR_ROUGH, Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import Field, fields_of
from blocksim.common.shown import Shown

Array = Any
FARTHEST = LENGTH.high
"""Largest length [m]."""
MOST = 1000
"""Largest number of voussoirs, courses or stones."""
UNIT_WEIGHT = 1.0
"""Weight per volume where none is given: only ratios of forces have a meaning [N/m^3]."""


def parameter(
    default: object,
    about: str,
    *,
    unit: str = "",
    low: float = 0.0,
    high: float = math.inf,
    above: bool = True,
    whole: bool = False,
    **known: Any,
) -> Any:
    """Make a field of a kind: a number, but for `choices` and `nested`; see `Field`.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from blocksim.common.fields import fields_of
    >>> @dataclass(frozen=True)
    ... class Pile(Maker):
    ...     width: float = metres(1.0, "of the base")
    ...     stones: int = count(10, "in all", low=2)
    ...     slope: float = parameter(0.5, "rise over run", high=2.0)
    >>> [each.allowed for each in fields_of(Pile).values()]
    ['1e-06 to 1e+06 m', 'a whole number from 2 to 1000', 'above 0 and at most 2']
    """
    numbers = Range(low=low, high=high, unit=unit, above=above, whole=whole)
    is_number = not (known.get("choices") or known.get("nested"))
    said = Field(about=about, range=numbers if is_number else None, **known)
    return field(default=default, metadata={Field.__name__: said})


def metres(
    default: float | None,
    about: str,
    *,
    low: float = LENGTH.low,
    high: float = LENGTH.high,
    above: bool = False,
    **known: Any,
) -> Any:
    """Make a field that is a length [m]; see `parameter`.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from blocksim.common.fields import fields_of
    >>> @dataclass(frozen=True)
    ... class Slab(Maker):
    ...     width: float = metres(1.0, "of the base", high=3.0)
    >>> fields_of(Slab)["width"].allowed
    '1e-06 to 3 m'
    """
    return parameter(default, about, unit="m", low=low, high=high, above=above, **known)


def count(default: int, about: str, *, low: int = 1, high: float = MOST, **known: Any) -> Any:
    """Make a field that is a number of things; see `parameter`.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from blocksim.common.fields import fields_of
    >>> @dataclass(frozen=True)
    ... class Pile(Maker):
    ...     stones: int = count(10, "in all", low=2)
    >>> fields_of(Pile)["stones"].allowed
    'a whole number from 2 to 1000'
    """
    return parameter(default, about, whole=True, low=low, high=high, above=False, **known)


@dataclass(frozen=True, kw_only=True)
class Table:
    """Parameters, each checked against its range.

    Raises
    ------
    InputError
        Naming the parameter, its value, and what it may be.
    """

    def __post_init__(self) -> None:
        """Check first each value alone, then those that depend on others."""
        for name, known in fields_of(type(self)).items():
            value = getattr(self, name)
            known.require(name, value)
            if known.whole and isinstance(value, float):
                # 40.0 of a file is 40.
                object.__setattr__(self, name, int(value))
        # What all kinds have comes first and depends on what comes after it.
        for name, known in reversed(fields_of(type(self)).items()):
            within = None if known.range is None else self.limits(name)
            known.require(name, getattr(self, name), within)

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter beside the others."""
        known = fields_of(type(self))[name].range
        assert known is not None  # noqa: S101 - asked of numbers only
        return known.low, known.high

    def table(self) -> dict[str, object]:
        """Return the parameters as a file has them."""
        return {name: _plain(getattr(self, name)) for name in fields_of(type(self))}


@dataclass(frozen=True, kw_only=True)
class Kind(Shown, Table, ABC, Generic[Blocks]):
    """What makers in the plane and in space are: a name, friction and density.

    Parameters
    ----------
    friction : float or None
        Friction coefficient of every joint, inf allowed; needed for a problem.
    density : float or None
        Weight per volume [N/m^3]; without it only ratios of forces have a meaning.
    """

    name: ClassVar[str]
    about: ClassVar[str] = ""
    is_arch: ClassVar[bool] = False
    in_space: ClassVar[bool] = False
    row_types: ClassVar[Mapping[str, type[Table]]] = {}

    friction: float | None = None
    density: float | None = None

    def __post_init__(self) -> None:
        """Check the parameters, then friction and density."""
        super().__post_init__()
        self._check_forces()

    def _check_forces(self) -> None:
        if self.friction is not None:
            SMOOTH_OR_ROUGH.require("friction", self.friction)
        if self.density is not None:
            PER_VOLUME.require("density", self.density)

    @property
    def known_friction(self) -> float:
        """Friction coefficient, which a problem needs.

        Raises
        ------
        InputError
            If there is none.
        """
        if self.friction is None:
            raise InputError("friction", MISSING, "given, for example 0.7")
        return self.friction

    @property
    def unit_weight(self) -> float:
        """Weight per volume [N/m^3]; 1 where none was given."""
        return UNIT_WEIGHT if self.density is None else self.density

    @cached_property
    @abstractmethod
    def built(self) -> Built[Blocks]:
        """The blocks, made once."""

    def problem(self) -> Problem[Blocks]:
        """Return what is made, under its own weight and that of its fill.

        Raises
        ------
        InputError
            If there is no friction, or nothing can be built of the parameters.
        """
        mu, built = self.known_friction, self.built
        return Problem(
            assembly=built.assembly,
            mu=mu,
            dead=built.fills,
            title=self.name,
            maker=self,
            weighed=self.density is not None,
            notes=built.notes,
        )

    def offers(self, problem: Any) -> Any:  # noqa: ARG002 - one of its own may
        """Return what it knows of its problem better than the general way; None for nothing.

        See `blocksim.kinds.offers.Offers`.
        """
        return None

    @property
    def length_name(self) -> str:
        """What the unit of length of engines is called."""
        return "L"

    @property
    def has_size(self) -> bool:
        """Whether its lengths are metres."""
        return True

    @property
    def measures(self) -> tuple[str, ...]:
        """What it is known by, in words for drawings; nothing where its title says enough."""
        return ()

    def table(self) -> dict[str, object]:
        """Return the parameters as a file has them, with the kind's name."""
        return {"kind": self.name, **super().table()}

    def origin(self) -> dict[str, object]:
        """Return what a recording keeps of it."""
        return {**self.table(), "density": self.unit_weight}

    @classmethod
    def beside(
        cls,
        table: Mapping[str, Any],
        changes: Mapping[str, object],  # noqa: ARG003 - as below
    ) -> dict[str, Any]:
        """Return what a table of a file still says where other values replace some of it."""
        return {**table}

    def but(self, **changes: Any) -> Self:
        """Return the same with other values; `**{"arch.thickness": 0.2}`: of its arch."""
        given = {each.name: getattr(self, each.name) for each in fields(self) if each.init}
        for name, value in changes.items():
            here, _, rest = name.partition(".")
            require(here in given, name, value, f"one of {', '.join(given)}")
            given[here] = cast("Kind[Any]", given[here]).but(**{rest: value}) if rest else value
        return type(self)(**given)

    def number(self, name: str) -> tuple[Field, float, float]:
        """Return what is known of a number that may be bracketed over, and its range."""
        here, _, rest = name.partition(".")
        if rest:
            return cast("Kind[Any]", getattr(self, here)).number(rest)
        return fields_of(type(self))[here], *self.limits(here)

    def value(self, name: str) -> float:
        """Return the value of such a number."""
        here, _, rest = name.partition(".")
        if rest:
            return cast("Kind[Any]", getattr(self, here)).value(rest)
        return float(getattr(self, here))

    @property
    def bracketed(self) -> tuple[str, ...]:
        """Names of the parameters that may be bracketed over."""
        names: list[str] = []
        for name, known in fields_of(type(self)).items():
            if known.stands is not None and getattr(self, name) is not None:
                names.append(name)
            elif known.nested == "table":
                names += [f"{name}.{each}" for each in getattr(self, name).bracketed]
        return tuple(names)


@dataclass(frozen=True, kw_only=True)
class Maker(Kind[Assembly]):
    """What makes a problem of its parameters.

    A class of one's own has a `name`, parameters, and `made`.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from blocksim import Body
    >>> @dataclass(frozen=True, kw_only=True)
    ... class Cube(Maker):
    ...     name = "cube"
    ...     side: float = metres(1.0, "side of the cube")
    ...     def made(self, density: float) -> Made:
    ...         a = self.side
    ...         bed = [[-a, -a], [2 * a, -a], [2 * a, 0], [-a, 0]]
    ...         cube = [[0, 0], [a, 0], [a, a], [0, a]]
    ...         return Made(bodies=(Body(polygons=(bed,), fixed=True), Body(polygons=(cube,))))
    >>> Cube(side=2.0, friction=0.5).problem().assembly.size
    1.0
    """

    @abstractmethod
    def made(self, density: float) -> Made:
        """Make the bodies.

        Parameters
        ----------
        density : float
            Weight per volume [N/m^3].
        """

    @cached_property
    def built(self) -> Built[Assembly]:
        """The blocks, made once."""
        return self.built_of()

    def built_of(self, size: float | None = None) -> Built[Assembly]:
        """Make the blocks, with another characteristic length [m] if one is given."""
        # Joints are found with libraries that blocks which know theirs do not need.
        from blocksim.blocks.making import built_of

        return built_of(self.made(self.unit_weight), self.unit_weight, size)


def _plain(value: object) -> object:
    if isinstance(value, Table):
        return value.table()
    if isinstance(value, tuple):
        return [_plain(each) for each in cast("tuple[object, ...]", value)]
    return value
