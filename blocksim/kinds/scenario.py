"""An arch to ask about, from a file or from options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from blocksim.arch.circular import Arch
from blocksim.blocks.problem import Problem
from blocksim.kinds.circular import CircularArch

if TYPE_CHECKING:
    from blocksim.arch.modes import Mode
    from blocksim.simulation.verdict import Verdict

ASIDE = 0.99
"""Thickness where none is given, over its least: the arch collapses, in one mode."""
USUAL = {"weight": "centreline", "density": 20_000.0}
"""Of arches by their half-angle; those in metres have their weight where it truly acts."""
MEASURES = ("span", "rise", "thickness", "at")
"""By which an arch is measured."""
THICK = ("eta", "thickness", "ratio")
"""Each of which says how thick it is."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """An arch to ask about, and what is known of it.

    `name`: File name without its ending.
    `given`: Parameters of `CircularArch`; a thickness need not be among them.
    `lean`: Angle by which gravity leans out of the plane [rad].
    `expected_modes`: Empty where nothing is said.
    `expected_verdict`: Of the arch at its own thickness.
    `quick`: Whether `validate --quick` takes it.
    """

    name: str = ""
    title: str = ""
    source: str = ""
    given: Mapping[str, Any]
    lean: float = 0.0
    expected_modes: tuple[Mode, ...] = ()
    expected_eta: float | None = None
    expected_verdict: Verdict | None = None
    quick: bool = False

    @property
    def has_thickness(self) -> bool:
        """Whether it says how thick the arch is."""
        return any(name in self.given for name in THICK)

    @cached_property
    def maker(self) -> CircularArch:
        """What makes the arch, at `ASIDE` of its least thickness where none is given."""
        return CircularArch(**self.given) if self.has_thickness else self.of(ratio=ASIDE)

    def of(self, **thickness: Any) -> CircularArch:
        """Return what makes the arch of another thickness, by `eta` or `ratio`."""
        others = {name: self.given[name] for name in self.given if name not in THICK}
        return CircularArch(**others, **thickness)

    def arch(self, eta: float) -> Arch:
        """Return the arch of a thickness over radius."""
        shape = self.of(eta=eta).shape
        assert shape is not None  # noqa: S101 - made by its half-angle, or by a line
        return shape

    @property
    def mu(self) -> float:
        """Friction coefficient of every joint."""
        return self.given["friction"]

    def problem(self, *, supports: bool = False) -> Problem:
        """Return the arch under its own weight, on supports that are drawn where asked for."""
        note = f"no thickness was given, so it is {ASIDE:g} of the least as built"
        built = (self.maker.between_supports() if supports else self.maker).problem()
        built = built if self.has_thickness else replace(built, notes=(note,))
        return built.leaning(self.lean) if self.lean else built
