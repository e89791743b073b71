"""What an arch carries: the engineer's numbers, by its own statics."""

from __future__ import annotations

import math

import numpy as np

from blocksim.arch.circular import Arch
from blocksim.arch.limit.statics import (
    Bound,
    half_joints,
    least_friction,
    least_thickness,
    slack,
    spread_of,
    thrust_bounds,
)
from blocksim.ask.carried import Carried, inverse
from blocksim.blocks.assembly import Array


def carried_by_arch(arch: Arch, mu: float, joint: int | None = None) -> Carried:
    """Find what an arch carries under its own weight; any joint has the same thrust.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient, inf allowed.
    joint : int, optional
        Where thrust is told; by default the crown, or the joint to its right.

    Returns
    -------
    Carried
    """
    problem = arch.problem(mu)
    least = least_thickness(arch.half_angle, mu, arch.voussoirs, arch.weight).eta
    needed = least_friction(arch)
    used = 1 - slack(arch, mu)
    unit = arch.specific_weight * arch.thickness * arch.depth * arch.radius
    lower, upper = _bounds(arch, mu, 1.0)
    stands = lower.short >= upper.short
    return Carried(
        problem=problem,
        geometrical_factor=inverse(None if least is None else least / arch.eta),
        friction_factor=inverse(None if needed is None else needed / mu),
        least_friction=needed,
        strength_used=used if math.isfinite(used) else None,
        joint=(arch.voussoirs + 1) // 2 if joint is None else joint,
        thrust=(lower.thrust * unit, upper.thrust * unit) if stands else None,
        forces=joint_forces(arch, mu, used) * (unit / problem.unit_force) if stands else None,
    )


def joint_forces(arch: Arch, mu: float, share: float = 1.0) -> Array:
    """Return forces at the ends of joints, (n + 1, 2, 2), in units of gamma t d r.

    Those of equilibrium that are in the middle of what a share of width and friction allows.
    """
    lower, upper = _bounds(arch, mu, share)
    thrust = (lower.thrust + upper.thrust) / 2
    angle, size = arch.joint_angles, np.abs(arch.joint_angles)
    normal = thrust * np.cos(size) + size * np.sin(size)
    shear = thrust * np.sin(angle) - angle * np.cos(angle)
    # Moments about the centre of the arch, of the crown's force and of the weight beyond it.
    weight = arch.centroid_factor * (1 - np.cos(size))
    room = normal * share * arch.eta / 2
    crown = (float((normal - weight - room).max()) + float((normal - weight + room).min())) / 2
    outward = (crown - normal + weight) / (normal * arch.eta)
    ends = np.column_stack([0.5 - outward, 0.5 + outward])
    return ends[:, :, None] * np.column_stack([normal, shear])[:, None, :]


def _bounds(arch: Arch, mu: float, share: float) -> tuple[Bound, Bound]:
    angles = half_joints(arch.half_angle, arch.voussoirs)
    spread = spread_of(arch.eta, arch.weight)
    return thrust_bounds(angles, share * arch.eta, share * mu, spread)
