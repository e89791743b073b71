"""The continuous arch, one at a time: arrays of size one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.arch.circular import Arch, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.arch.theory.rotation import rotational_mode
from blocksim.arch.theory.sliding import inner_slidings
from blocksim.common.checks import ANY_FRICTION

CROWN_ETA: dict[Weight, float] = {"centreline": 1.0, "sector": 6 * (math.sqrt(4 / 3) - 1)}
"""Thickness of the arch that overturns with its inner hinge just at the crown."""


@dataclass(frozen=True, kw_only=True)
class Critical:
    """The continuous arch at its least thickness.

    Parameters
    ----------
    eta : float or None
        Least thickness-to-radius ratio; None where none up to 2 stands.
    modes : tuple of Mode
        Collapse modes: several on a line of the map, where they coincide.
        Where `eta` is None, what no thickness prevents.
    thrust : float or None
        h; None where no thrust is compatible with friction.
    beta_r, beta_s : float or None
        Angles from the crown of the inner hinge and of the inner sliding joint [rad];
        None where the mode has none.
    """

    eta: float | None
    modes: tuple[Mode, ...]
    thrust: float | None
    beta_r: float | None
    beta_s: float | None

    @property
    def mode(self) -> Mode:
        """The collapse mode, the first of several that coincide."""
        return self.modes[0]


def least_thickness(half_angle: float, mu: float, weight: Weight = "centreline") -> Critical:
    """Least thickness, mode, thrust, hinge and sliding angles of the continuous arch.

    Parameters
    ----------
    half_angle : float
        In (0, pi) [rad].
    mu : float
        Friction coefficient, above 0, inf allowed.
    weight : {"centreline", "sector"}
        The paper treats the centreline; the sector follows from the same equations
        with the weight at radius 1 + eta^2/12.

    Returns
    -------
    Critical

    Raises
    ------
    InputError
        If a value is out of range.
    """
    Arch(half_angle=half_angle, eta=1.0, voussoirs=3, weight=weight)
    ANY_FRICTION.require("mu", mu)
    found = least_thicknesses(half_angle, mu, weight)
    eta, thrust, beta_r, beta_s = (
        None if math.isnan(value) else float(value)
        for value in (found.eta, found.thrust, found.beta_r, found.beta_s)
    )
    return Critical(eta=eta, modes=found.names, thrust=thrust, beta_r=beta_r, beta_s=beta_s)


def inner_sliding(mu: float) -> tuple[float, float]:
    """Thrust and angle at which an inner joint slides, (9); see `inner_slidings`."""
    thrusts, beta_s = inner_slidings(np.array([mu]))
    return float(thrusts.thrust[0]), float(beta_s[0])


def rotational_thrust(half_angle: float, weight: Weight) -> float:
    """Thrust of the purely rotational mode, or 0 where each half overturns by itself."""
    return float(rotational_mode(np.array([half_angle]), weight)[0].thrust[0])
