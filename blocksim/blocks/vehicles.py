"""Vehicles: axles that move along a road, as they are known, in a file, or as said."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

from blocksim.common.checks import COORDINATE, require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.files import read_file, shipped_files, toml_of

LARGEST_FILE = 64 * 1024
"""Bytes; a larger file is not read."""
MOST_AXLES = 100
HEAVIEST = 1e6
"""Axle [kN]."""


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """Axles that keep their distances.

    `axles`, tuple of (float, float): Place of each along the road, from an origin of the
        vehicle [m], and weight [N].
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
            ok = 0 < weight <= 1e3 * HEAVIEST
            require(ok, "axles", f"{weight / 1e3:g} kN", f"above 0, at most {HEAVIEST:g} kN")

    @property
    def turned(self) -> Vehicle:
        """The same going the other way."""
        axles = tuple((-place, weight) for place, weight in self.axles)
        return replace(self, axles=tuple(sorted(axles)))

    @property
    def is_alike(self) -> bool:
        """Whether it makes no difference which way it goes."""
        ahead, behind = sorted(self.axles), self.turned.axles
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
        axles = ", ".join(
            f"{weight / 1e3:.4g} kN at {place:.4g} m" for place, weight in self.axles
        )
        return f"{self.title}: {axles}" if self.title else axles


def shipped_vehicles() -> dict[str, Path]:
    """Vehicles that come with blocksim, by name."""
    return shipped_files("vehicles/*.toml")


def vehicle_of(said: str) -> Vehicle:
    """Return a vehicle by its name, from a file, or as axles.

    `said`: A shipped name; a .toml file with `axles`, a list of places [m] and weights [kN],
        and a `title` and `source` if wanted; or weights and places, as "10@0,10@1.2".

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
    where = str(path)
    text = read_file(where, "vehicle", "an existing .toml file", LARGEST_FILE)
    try:
        table: dict[str, Any] = toml_of(text)
    except ValueError as error:
        said = " ".join(str(error).split())
        raise InputError("file", said, "valid TOML", where=where) from None
    for key, value in table.items():
        known = key in {"axles", "title", "source"}
        if not known or (key != "axles" and not isinstance(value, str)):
            raise InputError(key, value, "axles, title and source, text both", where=where)
    axles: object = table.get("axles")
    pairs = cast("list[list[float]]", axles)
    if not isinstance(axles, list) or not all(map(_is_pair, pairs)):
        raise InputError(
            "axles", str(pairs), "a list of [place in m, weight in kN]", where=where
        )
    try:
        return Vehicle(
            axles=tuple((float(place), 1e3 * float(weight)) for place, weight in pairs),
            title=table.get("title", ""),
            source=table.get("source", ""),
        )
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=where) from None


def _is_pair(value: object) -> bool:
    pair = cast("list[object]", value) if isinstance(value, list) else []
    return len(pair) == 2 and all(
        isinstance(each, int | float) and not isinstance(each, bool) for each in pair
    )
