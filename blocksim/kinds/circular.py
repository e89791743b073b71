"""Circular arches between any two springings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from blocksim.arch.circular import Arch, Weight
from blocksim.arch.dimensions import LINES, Line
from blocksim.arch.limit import least_thickness
from blocksim.blocks.assembly import Assembly
from blocksim.blocks.made import Built
from blocksim.blocks.maker import metres, parameter
from blocksim.blocks.problem import Problem
from blocksim.common.checks import (
    ETA,
    FRICTION,
    HALF_ANGLE,
    HALF_ANGLE_DEG,
    LENGTH,
    RATIO,
    VOUSSOIRS,
    Range,
    require,
)
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import Field, fields_of
from blocksim.kinds.archkind import CurvedArch
from blocksim.kinds.curves import Curve, Voussoirs, circle
from blocksim.kinds.ways import SPRINGINGS, left_by, without_following

if TYPE_CHECKING:
    from blocksim.kinds.archoffers import ArchOffers

ROUND = 360.0
WEIGHTS: dict[str, Weight] = {"centreline": "centreline", "curved": "sector"}
"""What an arch calls the weights of a kind that it has, too."""
LEAST_DENSITY = 100.0
"""Weight per volume below which weights are taken for ratios, not for newtons [N/m^3]."""


def _instead(about: str, known: Range) -> Any:
    """Make a field that may be given in place of others."""
    said = Field(about=about, range=known, optional=True)
    return field(default=None, metadata={Field.__name__: said})


@dataclass(frozen=True, kw_only=True)
class CircularArch(CurvedArch):
    """A circular arch; the origin is the centre of the circle.

    It is made in one of three ways: by the angles to its springings (`left_deg`, `right_deg`),
    by its half-angle and thickness-to-radius ratio (`half_angle_deg`, or `half_angle` in
    radians, and `eta` or `ratio`), or by what can be measured (`span`, `rise` and `thickness`
    [m]). The first draws supports, which may move; the unit of length of engines is then half
    its larger side. Of the others it is the radius, and supports are the planes of the
    springings. All that is known of a symmetric arch is known of it, however it was made.

    Parameters
    ----------
    half_angle : float or None
        Crown to springing [rad].
    on_supports : bool
        Whether supports are drawn however it is made.
    half_angle_deg : float or None
        The same [deg].
    eta : float or None
        Thickness-to-radius ratio.
    ratio : float or None
        Thickness over the least one that stands, of the voussoirs as built; it takes friction.
    span, rise : float or None
        Of the line `at`, which stays where it is as the thickness changes [m].
    at : {"intrados", "centreline", "extrados"}

    Examples
    --------
    >>> arch = CircularArch(span=8, rise=3, thickness=0.45, voussoirs=31, friction=0.7)
    >>> round(arch.radius, 3), arch.but(thickness=0.2).span
    (4.392, 8)
    """

    name: ClassVar[str] = "circular-arch"
    about: ClassVar[str] = "part of a ring between any two springings"

    radius: float = metres(1.0, "radius of the centreline", stands="low")
    left_deg: float = parameter(
        90.0, "angle from the crown to the left springing", unit="deg", low=-90.0, high=179.0
    )
    right_deg: float = parameter(
        90.0, "angle from the crown to the right springing", unit="deg", low=-90.0, high=179.0
    )
    weight: Literal["curved", "chord", "centreline", "sector"] = parameter(
        "curved",
        "weight and centre of each voussoir: with curved faces, with straight ones, or at its "
        "arc of the centreline",
        choices=("curved", "chord", "centreline"),
    )
    half_angle: float | None = None
    on_supports: bool = False
    half_angle_deg: float | None = _instead(
        "crown to springing, in place of left_deg and right_deg", HALF_ANGLE_DEG
    )
    eta: float | None = _instead("thickness over radius, in place of thickness", ETA)
    ratio: float | None = _instead(
        "thickness over the least one that stands, as built, in place of thickness", RATIO
    )
    span: float | None = _instead("of the line at, in place of radius and springings", LENGTH)
    rise: float | None = _instead("of the line at", LENGTH)
    at: Literal["intrados", "centreline", "extrados"] = parameter(
        "intrados", "line that span and rise are of", choices=LINES
    )

    @classmethod
    def of(cls, arch: Arch, friction: float | None = None) -> Self:
        """Return what makes an arch, exactly."""
        return cls(
            half_angle=arch.half_angle,
            eta=arch.eta,
            voussoirs=arch.voussoirs,
            weight="centreline" if arch.weight == "centreline" else "curved",
            radius=arch.radius,
            depth=arch.depth,
            density=arch.specific_weight,
            friction=friction,
        )

    def __post_init__(self) -> None:
        """Work out radius, springings and thickness, and check all."""
        if self.weight == "sector":
            # As an arch calls it.
            object.__setattr__(self, "weight", "curved")
        fields_of(CircularArch)["weight"].require("weight", self.weight)
        if VOUSSOIRS.has(self.voussoirs):
            # 40.0 of a file is 40.
            object.__setattr__(self, "voussoirs", int(self.voussoirs))
        for name, beside in (("span", self.rise), ("rise", self.span)):
            alone = beside is not None and getattr(self, name) is None
            require(not alone, name, MISSING, "given")
        line = self.line
        ok = line is not None or self.at == "intrados"
        require(ok, "at", self.at, "left out: it is of span and rise")
        if line is not None:
            both = self.half_angle_deg is not None
            require(not both, "half_angle_deg", self.half_angle_deg, "left out beside span")
            self._derive("half_angle", line.half_angle)
        elif self.half_angle_deg is not None:
            HALF_ANGLE_DEG.require("half_angle_deg", self.half_angle_deg)
            self._derive("half_angle", math.radians(self.half_angle_deg))
        if self.half_angle is not None:
            HALF_ANGLE.require("half_angle", self.half_angle)
            for name in SPRINGINGS:
                self._derive(name, math.degrees(self.half_angle))
        if self.ratio is not None:
            self._derive("eta", self.ratio * self._least(self.ratio))
        if line is not None:
            line.require_measured(self.thickness if self.eta is None else None)
            eta = self.eta
            radius = line.around(self.thickness) if eta is None else line.mean_radius(eta)
            self._derive("radius", radius)
        if self.eta is not None:
            ETA.require("eta", self.eta)
            self._derive("thickness", self.eta * self.radius)
        if not self.in_radii:
            super().__post_init__()
        else:
            # Its ranges are wider than those of its kind.
            _ = self.shape
            if self.friction is not None:
                FRICTION.require("friction", self.friction)
            self._check_forces()

    def _least(self, ratio: float) -> float:
        """Return the least thickness over radius that stands, of which a ratio is taken."""
        RATIO.require("ratio", ratio)
        if self.half_angle is None or self.weight not in WEIGHTS:
            allowed = "left out: it is of symmetric arches by half-angle, or span and rise"
            raise InputError("ratio", ratio, allowed)
        if self.friction is None:
            raise InputError("friction", MISSING, "given beside ratio")
        VOUSSOIRS.require("voussoirs", self.voussoirs)
        FRICTION.require("friction", self.friction)
        weight = WEIGHTS[self.weight]
        least = least_thickness(self.half_angle, self.friction, self.voussoirs, weight).eta
        if not least:
            why = "no thickness up to 2 stands" if least is None else "any thickness stands"
            raise InputError("eta", MISSING, f"given in place of ratio: {why} here")
        most = ETA.high / least
        require(ratio <= most, "ratio", ratio, f"at most {most:.6g}, eta = {ETA.high:g}")
        return least

    def _derive(self, name: str, value: float) -> None:
        """Set what follows from others; another value that was given is refused."""
        given, usual = getattr(self, name), type(self).__dataclass_fields__[name].default
        same = given in (usual, value)
        require(same, name, given, f"left out: from the others it is {value:.6g}")
        object.__setattr__(self, name, value)

    @classmethod
    def beside(cls, table: Mapping[str, Any], changes: Mapping[str, object]) -> dict[str, Any]:
        """Return what a table still says: of how thick it is, and how wide, one thing."""
        return left_by(changes, table, lambda known: cls(**known).radius)

    def but(self, **changes: Any) -> Self:
        """Return the same with other values; the line that was measured stays where it is."""
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        given = without_following(given, changes)
        for name, value in changes.items():
            known = name in type(self).__dataclass_fields__
            require(known, name, value, f"one of {', '.join(fields_of(type(self)))}")
        return type(self)(**{**given, **changes})

    @property
    def in_radii(self) -> bool:
        """Whether it is a symmetric ring by its half-angle, without fill, on two planes."""
        ring = self.half_angle is not None and self.weight in WEIGHTS
        drawn = self.on_supports or self.fill is not None
        return ring and not drawn and self.joints != "vertical"

    @cached_property
    def shape(self) -> Arch | None:
        """The symmetric arch it is; None where it is none, or its joints are not radial."""
        angle = self.half_angle
        if angle is None:
            angle = math.radians(self.left_deg)
            equal = self.left_deg == self.right_deg and HALF_ANGLE.has(angle)
            if not equal or not VOUSSOIRS.has(self.voussoirs):
                return None
        if self.weight not in WEIGHTS or self.joints == "vertical":
            return None
        eta = self.thickness / self.radius if self.eta is None else self.eta
        return Arch(
            half_angle=angle,
            eta=min(ETA.high, eta) if self.span is not None else eta,
            voussoirs=self.voussoirs,
            weight=WEIGHTS[self.weight],
            radius=self.radius,
            depth=self.depth,
            specific_weight=self.unit_weight,
        )

    def problem(self) -> Problem:
        """Return the arch under its own weight and that of its fill."""
        made = super().problem()
        return replace(made, title="") if self.in_radii else made

    def built_of(self, size: float | None = None) -> Built[Assembly]:
        """Make the blocks."""
        plain = self.shape if self.in_radii and size is None else None
        return super().built_of(size) if plain is None else Built(assembly=plain.assembly())

    def offers(self, problem: Problem) -> ArchOffers | None:
        """Return what is known of the arch, upright under its own weight."""
        arch = self.shape
        # Blocks or friction may have been exchanged.
        mine = self.fill is None and problem.assembly is self.built.assembly
        alike = bool((problem.friction == problem.mu).all()) and problem.mu > 0
        upright = problem.has_statics and not problem.gravity[0]
        still = upright and not problem.is_loaded
        if arch is None or not (mine and alike and still) or problem.strength is not None:
            return None
        from blocksim.kinds.archoffers import ArchOffers

        return ArchOffers(arch, problem, self)

    @property
    def line(self) -> Line | None:
        """The line that was measured; None where none was."""
        if self.span is None or self.rise is None:
            return None
        return Line(span=self.span, rise=self.rise, at=self.at)

    def mean_radius(self, eta: float) -> float:
        """Return the radius of the centreline at a thickness-to-radius ratio [m].

        The centreline stays as it is, wherever it is known. A line that was measured says
        where that line is, and the centreline follows.
        """
        return self.radius if self.line is None else self.line.mean_radius(eta)

    @property
    def length_name(self) -> str:
        """What the unit of length of engines is called."""
        return "r" if self.in_radii else "L"

    @property
    def has_size(self) -> bool:
        """Whether a line of it was measured, or its radius given: 1 stands for none."""
        return not self.in_radii or self.radius != 1 or self.line is not None

    @property
    def measures(self) -> tuple[str, ...]:
        """Half-angle and thickness-to-radius ratio of a symmetric ring, and how it weighs."""
        if self.shape is None or not self.in_radii:
            return ()
        angle = f"\N{GREEK SMALL LETTER ALPHA} = {math.degrees(self.shape.half_angle):.4g}°"
        ratio = f"\N{GREEK SMALL LETTER ETA} = {self.shape.eta:.4g}"
        own = self.shape.weight != "centreline"
        return (angle, ratio, f"weight {self.shape.weight}") if own else (angle, ratio)

    def origin(self) -> dict[str, object]:
        """Return what a recording keeps of it."""
        if self.in_radii and self.shape is not None:
            return {"kind": self.name, **asdict(self.shape)}
        return super().origin()

    @property
    def tightest(self) -> float:
        """Least radius of curvature of the centreline [m]."""
        return self.radius

    @property
    def radial_is_normal(self) -> bool:
        """Radial joints are the normal ones."""
        return True

    def limits(self, name: str) -> tuple[float, float]:
        """Range of a parameter: the left springing lies left of the right one."""
        low, high = super().limits(name)
        if name == "right_deg":
            low, high = max(low, -self.left_deg), min(high, ROUND - 1.0 - self.left_deg)
        if name in {"left_deg", "right_deg"} and self.joints == "vertical":
            high = min(high, 90.0)
        return low, high

    def curve(self) -> Curve:
        """Return the centreline, by the angle from the crown."""
        return circle(
            0.0, self.radius, -math.radians(self.left_deg), math.radians(self.right_deg)
        )

    @cached_property
    def stones(self) -> Voussoirs:
        """Measure the voussoirs."""
        found = super().stones
        if self.weight != "centreline":
            return found
        curve = self.curve()
        inner, outer = self.cuts(curve)
        ends = (inner + outer) / 2
        half, middle = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
        arm = self.radius * np.sin(half) / half
        centre = arm[:, None] * np.column_stack([np.sin(middle), np.cos(middle)])
        return Voussoirs(**{**vars(found), "centre": centre})
