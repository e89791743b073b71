"""How a drawing is to be read: in which unit, which layers, which ends of lines are one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from blocksim.common.checks import LENGTH, is_number, require

ROLES = ("blocks", "supports", "ignored")
"""What a layer may be for; one of the name of a role is for it, if no other is named."""
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "in": 0.0254, "ft": 0.3048}
"""In metres."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """What a unit of the drawing is.

    `said`: What it was taken for, and why.
    """

    metres: float
    said: str


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a drawing or a mesh is to be read.

    Parameters
    ----------
    unit : float or str, optional
        Metres that a unit of the drawing is, or m, mm, cm, dm, in or ft; by default what the
        drawing says.
    layers : mapping of str to sequence of str
        Names of layers by their role: `blocks`, `supports`, `ignored`. Case does not matter.
    snap : float, optional
        Ends of lines that are so near to each other are one corner [m]; by default a
        ten-thousandth of the shorter line.
    up : {"y", "z"}, optional
        Coordinate of a mesh that points upwards; by default z, in GLB y.

    Raises
    ------
    InputError
        For a unit or a distance out of range, and for a layer with two roles.

    Examples
    --------
    >>> Reading(unit="mm", layers={"blocks": ["stones"]}).unit
    'mm'
    """

    unit: float | str | None = None
    layers: Mapping[str, Sequence[str]] = field(default_factory=dict[str, Sequence[str]])
    snap: float | None = None
    up: Literal["y", "z"] | None = None

    def __post_init__(self) -> None:
        """Check names and range."""
        if self.unit is not None:
            allowed = f"{', '.join(UNITS)}, or between 1e-6 and 1e6 m"
            ok = self.unit in UNITS or is_number(self.unit, 1e-6, 1e6)
            require(ok, "unit", self.unit, allowed)
        if self.snap is not None:
            LENGTH.require("snap", self.snap)
        require(self.up in {None, "y", "z"}, "up", self.up, "y or z")
        roles = self.roles
        for role, names in self.layers.items():
            require(role in ROLES, "layer", role, f"for one of {', '.join(ROLES)}")
            for name in names:
                once = roles[name.casefold()] == role
                require(once, "layer", name, "for one of blocks, supports and ignored")

    @property
    def roles(self) -> dict[str, str]:
        """Role of each layer that is read, or passed over without a word."""
        named = {role: self.layers.get(role, (role,)) for role in ROLES}
        return {name.casefold(): role for role, names in named.items() for name in names}

    def require_layers(self, seen: Iterable[str]) -> None:
        """Refuse a layer that is asked for and not there."""
        there = sorted(filter(None, seen))
        known = ", ".join(there[:20]) or "none"
        for name in (name for names in self.layers.values() for name in names):
            found = name.casefold() in map(str.casefold, there)
            require(found, "layer", name, f"one of the file's: {known}")

    def unit_of(self, found: Unit | None) -> Unit | None:
        """Return the unit that was asked for, or else the one the drawing says."""
        if self.unit is None:
            return found
        if isinstance(self.unit, str):
            metres, said = UNITS[self.unit], self.unit
        else:
            metres, said = self.unit, f"{self.unit:g} m"
        return Unit(metres=metres, said=f"a unit of the file is {said}, as asked")
