"""The options that say what is built, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import ClassVar

from blocksim.arch.dimensions import LINES, friction_of
from blocksim.cli.arguments import option
from blocksim.common.checks import FRICTION_ANGLE, LEAN_DEG, RATIO, require

OF_ANY = {"mu", "friction_angle", "unit_weight", "lean", "parameters", "tolerance", "depth",
          "unit", "layer", "snap"}  # fmt: skip
"""Options that say how anything is built, not only an arch."""
PARAMETERS = {"alpha": "half_angle_deg"}
"""Options that are not called as the parameter that they give."""
LARGEST_FRICTION = 10.0
"""Coefficient above which, up to 90, one is taken for an angle."""

MU = option("Friction coefficient, above 0; inf allowed.")
DEPTH = option("Depth out of the plane in m; 1 if left out.")
TOLERANCE = option(
    "Mortar joints, gaps and overlaps of a drawing up to this are closed, in m; "
    "what rounding of its coordinates explains if left out."
)
UNIT = option("Of a drawing that has none: m, mm, cm, dm, in, ft, or metres that a unit is.")
LAYER = option(
    "Layer of a drawing that is read as blocks or as supports, or is ignored; "
    "repeatable. If left out, layers of these names are.",
    metavar="ROLE=NAME",
)
SNAP = option(
    "Ends of lines of a drawing that are so near are one corner, in m; 1e-4 of "
    "the shorter line if left out."
)


@dataclass(frozen=True, kw_only=True)
class Given:
    """Options that say what is built. Those not given are None.

    All but those of `OF_ANY` are parameters of the circular arch, and of each kind that has
    one of that name.
    """

    heading: ClassVar[str] = "What is built"

    alpha: float | None = option("Half-angle of embrace in degrees, 0 to 180.")
    eta: float | None = option("Thickness-to-radius ratio, up to 2.")
    span: float | None = option(
        "Instead of --alpha and --eta: distance between the springings in m."
    )
    rise: float | None = option("Beside --span: height of the crown above them in m.")
    thickness: float | None = option("Beside --span: thickness of the arch in m.")
    at: str | None = option(
        f"Line of --span and --rise: {', '.join(LINES)}; the intrados if left out, "
        "which gives the clear span.",
        metavar="LINE",
    )
    ratio: float | None = option(
        "Instead of --eta or --thickness: thickness over the least one that stands, as built.",
        range=RATIO,
    )
    mu: float | None = MU
    friction_angle: float | None = option(
        "Instead of --mu: angle of friction in degrees.", range=FRICTION_ANGLE
    )
    voussoirs: int | None = option("Number of voussoirs, 3 to 10000; 27 if left out.")
    weight: str | None = option(
        "Where weight acts: centreline, or sector, as it does in true voussoirs. "
        "If left out: sector with --span, else centreline."
    )
    unit_weight: float | None = option(
        "Unit weight of the blocks in kN/m3; 20 in arches if left out."
    )
    depth: float | None = DEPTH
    lean: float | None = option(
        "Angle by which gravity leans out of the plane, in degrees.", range=LEAN_DEG
    )
    parameters: list[str] | None = option(
        "Parameter of a kind of structure (blocksim kinds NAME lists them); repeatable.",
        name="--with",
        metavar="NAME=VALUE",
    )
    tolerance: float | None = TOLERANCE
    unit: str | None = UNIT
    layer: list[str] | None = LAYER
    snap: float | None = SNAP

    @property
    def sizes(self) -> dict[str, object]:
        """Those that are parameters of a kind, friction among them, by its name of each."""
        names = [one.name for one in fields(self) if one.name not in OF_ANY]
        found = given_of(self, *names, "friction")
        return {PARAMETERS.get(name, name): each for name, each in found.items()}

    @property
    def drawn(self) -> dict[str, object]:
        """Options given of drawings."""
        return given_of(self, "tolerance", "unit", "layer", "snap")

    @property
    def measured(self) -> dict[str, object]:
        """Options given of an arch in metres."""
        return given_of(self, "span", "rise", "thickness", "at")

    @property
    def friction(self) -> float | None:
        """Friction coefficient, given as such or as an angle."""
        mu, angle = self.mu, self.friction_angle
        if angle is None:
            slip = mu is not None and LARGEST_FRICTION < mu < 90
            words = f"a coefficient: as an angle it would be --friction-angle {mu or 0:g}"
            require(not slip, "--mu", mu, words)
            return mu
        require(mu is None, "--friction-angle", angle, "left out where --mu is given")
        smooth = angle < math.pi / 2
        words = f"in degrees: as a coefficient it would be --mu {angle:g}, in radians "
        words += f"--friction-angle {math.degrees(angle):.4g}"
        require(not smooth, "--friction-angle", angle, words)
        return friction_of(angle)


def given_of(options: object, *names: str) -> dict[str, object]:
    """Return those of some options that are given."""
    found = {name: getattr(options, name) for name in names}
    return {name: each for name, each in found.items() if each is not None}
