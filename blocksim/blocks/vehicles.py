"""Vehicles: axles that move along a road, as they are known, in a file, or as said."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from blocksim.common.checks import AXLE, COORDINATE, MOST_AXLES, require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.files import read_toml, shipped_files


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """Axles that keep their distances.

    Parameters
    ----------
    axles : tuple of (float, float)
        Place of each along the road, from an origin of the vehicle [m], and weight [N].
    title, source : str

    Raises
    ------
    InputError
        If there is none, or one is out of range.
    """

    axles: tuple[tuple[float, float], ...]
    title: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        """Check the number of axles, their places and weights."""
        count = len(self.axles)
        require(1 <= count <= MOST_AXLES, "axles", count, f"1 to {MOST_AXLES} axles")
        for place, weight in self.axles:
            COORDINATE.require("axles", place)
            heavy = weight / 1e3
            require(AXLE.has(heavy), "axles", f"{heavy:g} kN", AXLE.words)

    @property
    def turned(self) -> Vehicle:
        """The same going the other way; its axles are named in the same order."""
        return replace(self, axles=tuple((-place, weight) for place, weight in self.axles))

    @property
    def is_alike(self) -> bool:
        """Whether it makes no difference which way it goes."""
        ahead, behind = sorted(self.axles), sorted(self.turned.axles)
        shift = ahead[0][0] - behind[0][0]
        return all(
            math.isclose(one, other + shift, abs_tol=1e-9) and math.isclose(mine, others)
            for (one, mine), (other, others) in zip(ahead, behind, strict=True)
        )

    @property
    def weight(self) -> float:
        """Of all axles [N]."""
        return sum(weight for _, weight in self.axles)

    @property
    def words(self) -> str:
        """Its title and its axles."""
        axles = ", ".join(axle_words(self.axles))
        return f"{self.title}: {axles}" if self.title else axles


def axle_words(
    axles: Iterable[tuple[float, float]], *, weigh: int = 4, stand: int = 4
) -> list[str]:
    """Say of each axle what it weighs, and where it stands.

    `axles`: Place [m] and weight [N] of each.
    `weigh`, `stand`: Digits of weights and places.
    """
    return [f"{heavy / 1e3:.{weigh}g} kN at {x:.{stand}g} m" for x, heavy in axles]


def shipped_vehicles() -> dict[str, Path]:
    """Vehicles that come with blocksim, by name."""
    return shipped_files("vehicles/*.toml")


def vehicle_of(said: str) -> Vehicle:
    """Return a vehicle by its name, from a file, or as axles.

    Parameters
    ----------
    said : str
        A shipped name; a .toml file with `axles`, a list of places [m] and weights [kN],
        and a `title` and `source` if wanted; or weights and places, as "10@0,10@1.2".

    Raises
    ------
    InputError
        If it is none of them.

    Examples
    --------
    >>> vehicle_of("10@0, 10@1.2").axles
    ((0.0, 10000.0), (1.2, 10000.0))
    """
    known = shipped_vehicles()
    if "@" in said:
        return Vehicle(axles=tuple(_axle(each, said) for each in said.split(",")))
    if said in known or said.endswith(".toml"):
        return _read(known.get(said, Path(said)))
    allowed = f"axles as 10@0,10@1.2 (kN at m), a .toml file, or one of {', '.join(known)}"
    raise InputError("vehicle", said, allowed + perhaps(said, known))


def _axle(text: str, said: str) -> tuple[float, float]:
    weight, _, place = text.partition("@")
    try:
        return float(place), 1e3 * float(weight)
    except ValueError:
        raise InputError("vehicle", said, "axles as 10@0,10@1.2: kN at m") from None


def _read(path: Path) -> Vehicle:
    # Tables of files take a while to load, and most vehicles have a name.
    from blocksim.blocks.entries import VehicleFile
    from blocksim.common.tables import as_said

    table = read_toml(path, "vehicle", "an existing .toml file")
    said = as_said(VehicleFile, table, str(path))
    axles = tuple((place, 1e3 * weight) for place, weight in said.axles)
    return Vehicle(axles=axles, title=said.title, source=said.source)
