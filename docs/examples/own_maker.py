"""A structure of your own: a class with parameters, asked by the same calls as any other.

A pillar that tapers topples where its centre of mass stands above the edge of its base.
"""

from dataclasses import dataclass
from math import atan, degrees

from blocksim import Body, Made, Maker, bracket, check, metres


@dataclass(frozen=True, kw_only=True)
class Pillar(Maker):
    """A pillar with sloping sides on level ground."""

    name = "pillar"
    about = "a pillar that tapers"

    base: float = metres(1.0, "width of the base")
    top: float = metres(0.5, "width of the top", stands="high")
    height: float = metres(4.0, "height", stands="low")

    def made(self, density: float) -> Made:  # noqa: ARG002 - blocks weigh by area
        """Return the ground and the pillar; joints are found."""
        half, narrow, wide = self.base / 2, self.top / 2, 2 * self.base
        pillar = [[-half, 0], [half, 0], [narrow, self.height], [-narrow, self.height]]
        ground = [[-wide, -wide], [wide, -wide], [wide, 0], [-wide, 0]]
        return Made(
            bodies=(
                Body(polygons=(ground,), name="ground", fixed=True),
                Body(polygons=(pillar,), name="pillar"),
            )
        )


pillar = Pillar(friction=0.7)
print(f"it {check(pillar).verdict}; 12 deg: {check(pillar.problem().tilted(0.21)).verdict}")
check(pillar).plot().savefig("own_maker.png", dpi=70)
headline = bracket(pillar, over="tilt", method="direct").high
centre = pillar.height / 3 * (pillar.base + 2 * pillar.top) / (pillar.base + pillar.top)
print(f"falls at {headline:.2f} deg; by hand at {degrees(atan(pillar.base / 2 / centre)):.2f}")
