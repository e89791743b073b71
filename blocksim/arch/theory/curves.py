"""The curves of the paper's Figs 3-5, each in the parameter in which it is explicit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from blocksim.arch.theory.equations import half_angle_at, meeting_hinges
from blocksim.arch.theory.map import special_angles
from blocksim.arch.theory.regions import divide_half_angle
from blocksim.blocks.assembly import Array

BRANCH, CURVE = 200, 400
"""Points on each branch, and on the curve of sliding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RotationalBranch:
    """A branch of the purely rotational mode, eq. (7).

    `half_angle`, `beta_r`, `eta`, `thrust`, (k,): alpha and beta_r [rad], eta, h.
    """

    half_angle: Array
    beta_r: Array
    eta: Array
    thrust: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SlidingCurve:
    """Sliding of an inner joint (9), and where the shoulder slides with it, (8).

    `mu`, (k,): Friction coefficient, from 0 to inf.
    `half_angle`, (k,): alpha at which both joints slide, from 0 to pi [rad].
    `beta_s`, `thrust`, (k,): Angle of the inner joint [rad]; h.
    """

    mu: Array
    half_angle: Array
    beta_s: Array
    thrust: Array


def rotational_branches() -> tuple[RotationalBranch, RotationalBranch]:
    """Give the two branches of eq. (7), with its upper and with its lower signs.

    Returns `upper`: From alpha = 0 to alpha_s-beta, where the inner hinge is farthest from the
        crown.
    Returns `lower`: From there to alpha_l, where the hinge is back at the crown.
    """
    special = special_angles()
    # Denser towards the end that both share, where alpha goes as a root.
    rising = special.hinge * (1 - np.linspace(1.0, 0.0, BRANCH) ** 2)
    # At one end of each (7) is 0/0.
    start, end = (0.0, 0.0, 0.0, 1.0), (special.zero_thrust, 0.0, 1.0, 0.0)
    upper = np.column_stack([start, _branch(rising[1:], 1.0)])
    lower = np.column_stack([_branch(rising[1:][::-1], -1.0), end])
    one, other = (
        RotationalBranch(half_angle=alpha, beta_r=beta, eta=eta, thrust=thrust)
        for alpha, beta, eta, thrust in (upper, lower)
    )
    return one, other


def _branch(beta: Array, sign: float) -> Array:
    """Rows alpha, beta, eta, h of eq. (7), hinges above 0."""
    sine, (f, g, square) = np.sin(beta), meeting_hinges(beta)
    gap = np.sqrt(np.maximum(square, 0.0))
    level = g * (f + sign * gap) / (sine * (2 * g - sine))
    eta = 2 * (g - sine - sign * gap) / (f + g)
    thrust = (f - sine + sign * gap) / (2 * sine)
    alpha = [half_angle_at(each) for each in level.tolist()]
    return np.array([alpha, beta, eta, thrust])


def sliding_curve() -> SlidingCurve:
    """Give thrust and angle of inner sliding, from no friction to unbounded friction.

    With h = cos^2(E/2) eq. (9) is mu = tan((E - sin E)/2), for E from 0 to pi.
    """
    # Denser towards pi, where half of the range of alpha is.
    anomaly = math.pi * (1 - np.linspace(1.0, 0.0, CURVE)[1:-1] ** 2)
    thrust, beta_s = np.cos(anomaly / 2) ** 2, np.sin(anomaly) / 2
    mu = np.tan((anomaly - np.sin(anomaly)) / 2)
    alpha = [divide_half_angle(each) for each in mu.tolist()]
    return SlidingCurve(
        mu=np.concatenate([[0.0], mu, [math.inf]]),
        half_angle=np.concatenate([[0.0], alpha, [math.pi]]),
        beta_s=np.concatenate([[0.0], beta_s, [0.0]]),
        thrust=np.concatenate([[1.0], thrust, [0.0]]),
    )
