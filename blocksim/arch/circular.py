"""The generator: a symmetric circular arch of equal voussoirs with radial joints."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Block, Joint
from blocksim.blocks.problem import STANDARD_GRAVITY as GRAVITY
from blocksim.blocks.rows import Rows
from blocksim.common.checks import ETA, HALF_ANGLE, LENGTH, PER_VOLUME, VOUSSOIRS, require
from blocksim.common.shown import Shown

Weight = Literal["centreline", "sector"]
WEIGHTS: tuple[str, ...] = get_args(Weight)

ETA_MAX = 2.0
"""Largest thickness ratio: the intrados has shrunk to the centre."""
LIMITS: dict[str, tuple[float, str]] = {
    "half_angle": (math.nextafter(math.pi, 0), "above 0 and below pi"),
    "eta": (ETA_MAX, "above 0 and at most 2"),
    "mu": (math.inf, "above 0 (inf for unbounded friction)"),
}
"""Greatest values that theory and statics take, in words."""
SMALL = 0.1
"""Angle below which a series is better than a difference [rad]."""


@dataclass(frozen=True, kw_only=True)
class Arch(Shown):
    """A symmetric circular arch; the crown is at angle 0, x to the right, y up.

    Parameters
    ----------
    half_angle : float
        Half-angle of embrace alpha, crown to springing, 0.001 to below pi [rad].
    eta : float
        Thickness-to-radius ratio t/r, 1e-15 to 2.
    voussoirs : int
        Number of equal voussoirs n, 3 to 10000.
    weight : {"centreline", "sector"}
        Where the weight of a voussoir acts: at the centroid of its arc of the mean
        circle (the paper's model), or at the centroid of the annular sector.
    radius : float
        Mean radius r, 1e-6 to 1e6 [m].
    depth : float
        Depth d out of the plane, 1e-6 to 1e6 [m].
    specific_weight : float
        gamma, 1e-6 to 1e9 [N/m^3].

    Raises
    ------
    InputError
        If a value is out of range.
    """

    half_angle: float
    eta: float
    voussoirs: int
    weight: Weight = "centreline"
    radius: float = 1.0
    depth: float = 1.0
    specific_weight: float = 20_000.0

    def __post_init__(self) -> None:
        """Check the ranges."""
        HALF_ANGLE.require("half_angle", self.half_angle)
        ETA.require("eta", self.eta)
        VOUSSOIRS.require("voussoirs", self.voussoirs)
        require_weight(self.weight)
        LENGTH.require("radius", self.radius)
        LENGTH.require("depth", self.depth)
        PER_VOLUME.require("specific_weight", self.specific_weight)

    @property
    def thickness(self) -> float:
        """Thickness t [m]."""
        return self.eta * self.radius

    @property
    def joint_angles(self) -> Array:
        """Angles of the joints from the crown, shape (n + 1,) [rad].

        Exactly antisymmetric, so that mirrored joints mirror to the last bit.
        """
        steps = 2.0 * np.arange(self.voussoirs + 1) - self.voussoirs
        return self.half_angle * steps / self.voussoirs

    @property
    def voussoir_weight(self) -> float:
        """Weight of one voussoir, gamma t r d 2 alpha/n [N]."""
        per_angle = self.specific_weight * self.thickness * self.radius * self.depth
        return per_angle * 2.0 * self.half_angle / self.voussoirs

    @property
    def centroid_factor(self) -> float:
        """Radius of the distributed weight over the mean radius: 1, or 1 + eta^2/12."""
        return centroid_factor(self.eta, self.weight)

    @property
    def voussoir_centres(self) -> Array:
        """Centres of mass of the voussoirs about that of the arch, shape (n, 2), r = 1."""
        angles, half = self.joint_angles, self.half_angle / self.voussoirs
        middle = (angles[:-1] + angles[1:]) / 2
        arm = self.centroid_factor * math.sin(half) / half
        return arm * np.column_stack([np.sin(middle), np.cos(middle)])

    def assembly(self) -> Assembly:
        """Build the voussoirs and their joints, both springings fixed.

        Mass and centre of mass come from the weight model, not from the chord-sided
        collision polygon: each joint then carries exactly the resultant of the continuous
        arch. The inertia is that of the annular sector about its centroid in both models:
        where the weight acts says nothing of how a voussoir turns.

        Returns
        -------
        Assembly
            n blocks and n + 1 joints, both from the left springing to the right, each made
            when it is looked at.
        """
        angles = self.joint_angles
        intrados, extrados = self.radius - self.thickness / 2, self.radius + self.thickness / 2
        rays = np.column_stack([np.sin(angles), np.cos(angles)])
        inner, outer = intrados * rays, extrados * rays
        half = self.half_angle / self.voussoirs
        mass = self.voussoir_weight / GRAVITY
        # Polar moment of the sector about the centre of the arch, 1 + eta^2/4, less the
        # parallel-axis term, with 1 - (sin x/x)^2 kept apart: it is x^2/3 for small x.
        factor = centroid_factor(self.eta, "sector")
        thick = 1.0 + self.eta**2 / 4 - factor**2
        inertia = mass * self.radius**2 * (thick + factor**2 * _sine_deficit(half))
        centres = self.radius * self.voussoir_centres
        corners = np.stack([inner[:-1], inner[1:], outer[1:], outer[:-1]], axis=1)
        if intrados == 0:
            corners = corners[:, 1:]
        count = self.voussoirs
        blocks = Rows(
            Block,
            vertices=corners,
            centre=centres,
            mass=[mass] * count,
            inertia=[inertia] * count,
            depth=[self.depth] * count,
            name=[str(i + 1) for i in range(count)],
        )
        joints = Rows(
            Joint,
            before=[SUPPORT, *range(count)],
            after=[*range(count), SUPPORT],
            inner=inner,
            outer=outer,
        )
        # They are alike: what is wrong with the first is so with all, and told at once.
        _ = blocks[0]
        return Assembly(blocks=blocks, joints=joints, size=self.radius)


def require_weight(weight: object) -> None:
    """Raise `InputError` unless it is one of `WEIGHTS`."""
    require(weight in WEIGHTS, "weight", weight, f"one of {', '.join(WEIGHTS)}")


def checked_arrays(weight: Weight, **given: ArrayLike) -> list[Array]:
    """Return arrays of one shape, of which each number is above 0 and within `LIMITS`."""
    require_weight(weight)
    arrays = np.broadcast_arrays(*(np.asarray(each, dtype=float) for each in given.values()))
    for name, values in zip(given, arrays, strict=True):
        most, allowed = LIMITS[name]
        wrong = ~((values > 0) & (values <= most))
        if wrong.any():
            require(False, name, float(values[wrong].flat[0]), allowed)
    return list(arrays)


def centroid_factor(eta: float, weight: Weight) -> float:
    """Radius at which the weight is spread, over the mean radius."""
    return 1.0 if weight == "centreline" else 1.0 + eta**2 / 12


def crown_width(half_angle: float, voussoirs: int) -> float:
    """Largest angle of a joint that counts as at the crown [rad].

    Half a keystone where the number of voussoirs is odd, a hair where it is even.
    """
    share = 1.0 if voussoirs % 2 else 1e-9
    return half_angle / voussoirs * share * (1 + 1e-9)


def _sine_deficit(x: float) -> float:
    """Return 1 - (sin x/x)^2, without cancellation for small x."""
    if x > SMALL:
        return 1.0 - (math.sin(x) / x) ** 2
    square = x * x
    series = 1 / 3 - square * (2 / 45 - square * (1 / 315 - square * (2 / 14175)))
    return square * series
