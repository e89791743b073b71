"""A case: one question about one arch, its identity, and its row."""

from __future__ import annotations

import math
from collections.abc import Iterator
from hashlib import blake2b
from typing import TYPE_CHECKING, NamedTuple, Protocol

from blocksim.arch.circular import Weight
from blocksim.engines import NAMES

if TYPE_CHECKING:
    from blocksim.many.structurecase import StructureCase

Row = dict[str, object]
Pace = tuple[object, ...]
Given = tuple[tuple[str, float], ...]
"""Settings by name."""


def identity_of(case: tuple[object, ...], version: str) -> bytes:
    """Hash of what is asked and of the version of the method that answers."""
    return blake2b(f"{tuple(case)!r} {version}".encode(), digest_size=12).digest()


class Case(NamedTuple):
    """One question about one arch.

    Parameters
    ----------
    half_angle_deg : float
        Half-angle of embrace [deg].
    mu : float
    voussoirs : int
    weight : str
    eta : float or None
        Thickness-to-radius ratio.
    ratio : float or None
        Thickness over the least thickness of the voussoirs as built. Where this and
        `eta` are None, the question is how thin the arch can be.
    method : str
    band : float
        An engine simulates arches within this share of their least thickness.
    tol : float
        Relative width of the bracket of an engine; 0 where nothing is bracketed.
    confirm : bool
        Let the arch go at both ends of an engine's bracket.
    settings : tuple of (str, float)
        Given to the engine instead of what its rule says.
    """

    half_angle_deg: float
    mu: float
    voussoirs: int
    weight: Weight
    eta: float | None
    ratio: float | None
    method: str
    band: float
    tol: float
    confirm: bool = True
    settings: Given = ()

    @property
    def engine(self) -> str:
        """Method that answers where simulation is worth it: of `auto` the cheapest engine."""
        return NAMES[0] if self.method == "auto" else self.method

    @property
    def is_bracket(self) -> bool:
        """Whether the question is how thin the arch can be."""
        return self.eta is None and self.ratio is None

    @property
    def pace(self) -> Pace:
        """What cases that take about the same time have in common."""
        return self.method, self.voussoirs, self.is_bracket, self.settings

    def row(self, identity: bytes, version: str) -> Row:
        """Return the row with nothing answered."""
        return {
            "id": identity.hex(),
            "half_angle_deg": self.half_angle_deg,
            "mu": "inf" if math.isinf(self.mu) else self.mu,
            "voussoirs": self.voussoirs,
            "weight": self.weight,
            "eta": self.eta,
            "ratio": self.ratio,
            "asked": self.method,
            "settings": dict(self.settings) or None,
            "method": "limit" if self.method == "auto" else self.method,
            "version": version,
            "verdict": None,
            "mode": None,
            "mode_in_motion": None,
            "mode_theory": None,
            "eta_theory": None,
            "eta_limit": None,
            "eta_low": None,
            "eta_high": None,
            "confirmed": None,
            "reason": None,
            "error": None,
            "wall_s": 0.0,
        }

    def identity(self, version: str) -> bytes:
        """Hash of what is asked and of the version of the method that answers."""
        return identity_of(self, version)


class Questions(Protocol):
    """What a sweep asks: a `Design`, a `KindDesign`, or anything else with these three."""

    @property
    def method(self) -> tuple[str, ...]:
        """Methods that occur."""
        ...

    @property
    def size(self) -> int:
        """Number of cases, by which progress is told."""
        ...

    def cases(self) -> Iterator[Case | StructureCase]:
        """Give the cases, always in the same order."""
        ...
