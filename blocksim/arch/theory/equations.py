"""The equations of the continuous arch, scaled by radius and weight per angle.

Numbers in brackets are those of Cocchetti and Rizzi (2024). Every function takes floats
or arrays that broadcast; angles are in radians. `beta` is measured from the crown.
"""

from __future__ import annotations

import numpy as np

from blocksim.arch.circular import Weight, centroid_factor
from blocksim.arch.roots import root
from blocksim.blocks.assembly import Array

Value = float | Array

BEYOND = 4.0
"""Stands for a thickness ratio that does not exist; ratios end at 2."""


def normal_force(angle: Value, thrust: Value) -> Value:
    """Compressive force N/(gamma t d r) at a radial section."""
    return thrust * np.cos(angle) + angle * np.sin(angle)


def shape(half_angle: Value) -> Value:
    """A(alpha) = alpha cot(alpha/2) (3)."""
    return half_angle / np.tan(half_angle / 2)


def half_angle_at(level: float, least: float = 1e-9) -> float:
    """Solve A(alpha) = level for alpha, from `least` on (3)."""
    return root(lambda angle: float(shape(angle)) - level, least, 3.1)


def meeting_hinges(beta: Value) -> tuple[Value, Value, Value]:
    """Give f and g of eq. (7), and what its root is taken of: 0 where both branches meet."""
    sine, cosine = np.sin(beta), np.cos(beta)
    f, g = sine + beta * cosine, beta + sine * cosine
    return f, g, f * f - 2 * g * sine + sine * sine


def shoulder_friction(half_angle: Value, thrust: Value) -> Value:
    """Friction at which the shoulder slides, mu_ss (8)."""
    sine, cosine = np.sin(half_angle), np.cos(half_angle)
    return (thrust * sine - half_angle * cosine) / (thrust * cosine + half_angle * sine)


def inner_sliding_angle(thrust: Value) -> Value:
    """Where the inner joint slides, beta_s = sqrt(h (1 - h)) (9)."""
    return np.sqrt(thrust * (1 - thrust))


def inner_friction(thrust: Value) -> Value:
    """Friction at which an inner joint slides, mu_is (9)."""
    beta = inner_sliding_angle(thrust)
    sine, cosine = np.sin(beta), np.cos(beta)
    return ((1 - thrust) * cosine - beta * sine) / ((1 - thrust) * sine + beta * cosine)


def touching_eta(
    thrust: Value, extrados: Value, intrados: Value, weight: Weight = "centreline"
) -> Value:
    """Thickness ratio at which the line of thrust touches both faces.

    Moment equilibrium between two sections, with the line of thrust at the extrados of
    one and the intrados of the other. For the centreline it is (1) or (2) solved for
    eta; for the sector the lever 1 + eta^2/12 of the weight makes it quadratic.

    `thrust`: h.
    `extrados`, `intrados`: Angles of the two sections [rad].
    Returns: eta; at least `BEYOND` where no thickness will do, since a thicker annular sector
        also weighs farther out.
    """
    drop = np.cos(intrados) - np.cos(extrados)
    gap = intrados * np.sin(intrados) - extrados * np.sin(extrados) + (1 + thrust) * drop
    force = normal_force(extrados, thrust) + normal_force(intrados, thrust)
    if weight == "centreline":
        return 2 * gap / force
    root = force**2 - 4 / 3 * drop * gap
    eta = 4 * gap / (force + np.sqrt(np.maximum(root, 0.0)))
    return np.where((root < 0) & (gap > 0), np.maximum(eta, BEYOND), eta)[()]


def hinge_slope(thrust: float, extrados: float, beta: float, weight: Weight) -> float:
    """Tell on which side of beta the intrados asks for more thickness.

    It is h_e - h of (4), times 2 - eta, with the weight at its own radius.

    `thrust`, `extrados`, `beta`: h; angles of the extrados hinge and of the place asked about
        [rad].
    Returns: Positive where `touching_eta` grows with beta, 0 at the inner hinge.
    """
    eta = float(touching_eta(thrust, extrados, beta, weight))
    turn = 1.0 + (beta / float(np.tan(beta)) if beta > 0 else 1.0) - thrust
    return turn * (2.0 - eta) - 2.0 * centroid_factor(eta, weight)
