"""Flat arches, of wedges between two level faces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from blocksim.blocks.maker import metres, parameter
from blocksim.common.checks import VOUSSOIRS, require
from blocksim.kinds.archkind import ArchKind
from blocksim.kinds.curves import Voussoirs, chords


@dataclass(frozen=True, kw_only=True)
class FlatArch(ArchKind):
    """Wedges with a level soffit; the origin is its middle."""

    name: ClassVar[str] = "flat-arch"
    about: ClassVar[str] = "wedges between a level soffit and a level back"

    thickness: float = metres(0.4, "height, soffit to back", stands="high")
    voussoirs: int = parameter(
        9, "number of wedges", whole=True, low=1, high=VOUSSOIRS.high, above=False
    )
    span: float = metres(2.0, "span of the soffit", stands="low")
    skew_deg: float = parameter(
        30.0, "angle of the springings from the vertical", unit="deg", high=80.0, above=False
    )
    joints: Literal["fanned", "inclined"] = parameter(
        "fanned",
        "direction of the joints: fanned from one point, or all as inclined as the springings",
        choices=("fanned", "inclined"),
    )

    def __post_init__(self) -> None:
        """Check that there is a keystone between inclined joints."""
        super().__post_init__()
        odd = self.joints == "fanned" or self.voussoirs % 2 == 1
        require(odd, "voussoirs", self.voussoirs, "an odd number where joints are inclined")

    @property
    def top(self) -> float:
        """Height of the back [m]."""
        return self.thickness

    @cached_property
    def stones(self) -> Voussoirs:
        """Measure the wedges."""
        share = 2 * np.arange(self.voussoirs + 1) / self.voussoirs - 1
        low = self.span / 2 * share
        reach = self.thickness * math.tan(math.radians(self.skew_deg))
        high = low + reach * (share if self.joints == "fanned" else np.sign(share))
        inner = np.column_stack([low, np.zeros_like(low)])
        outer = np.column_stack([high, np.full_like(low, self.thickness)])
        corners = np.stack([inner[:-1], inner[1:], outer[1:], outer[:-1]], axis=1)
        return chords(corners)
