"""What an arch carries: the engineer's numbers, by its own statics."""

from __future__ import annotations

import math

import numpy as np

from blocksim.arch.circular import Arch
from blocksim.arch.limit.statics import bounds_of, least_friction, least_thickness, slack
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.limit import Thrust
from blocksim.limit.carried import Carried, inverse


def carried_by_arch(arch: Arch, problem: Problem, joint: int | None = None) -> Carried:
    """Find what an arch carries under its own weight; any joint has the same thrust.

    `problem`: Of this arch, under its own weight.
    `joint`: Where thrust is told; by default the crown, or the joint to its left.
    """
    mu = problem.mu
    least = least_thickness(arch.half_angle, mu, arch.voussoirs, arch.weight).eta
    needed = least_friction(arch)
    used = 1 - slack(arch, mu)
    unit = _unit(arch, problem)
    lower, upper = bounds_of(arch, mu)
    least_thrust = greatest = None
    if lower.short >= upper.short:
        least_thrust, greatest = (_thrust(arch, end.thrust, unit) for end in (lower, upper))
    safest = None
    if math.isfinite(used):
        most = bounds_of(arch, mu, used)
        safest = unit * joint_forces(arch, (most[0].thrust + most[1].thrust) / 2, used)
    return Carried(
        problem=problem,
        geometrical_factor=inverse(None if least is None else least / arch.eta),
        friction_factor=inverse(None if needed is None else needed / mu),
        least_friction=needed,
        strength_used=used if math.isfinite(used) else None,
        joint=arch.voussoirs // 2 if joint is None else joint,
        least=least_thrust,
        greatest=greatest,
        forces=safest,
    )


def standing_forces(arch: Arch, problem: Problem) -> Array | None:
    """Return forces well within an arch, as of `Equilibrium`; None where it falls.

    Their thrust is midway between the least and the greatest, which takes less time than the
    safest state.
    """
    lower, upper = bounds_of(arch, problem.mu)
    if lower.short < upper.short:
        return None
    low, high = lower.thrust, upper.thrust
    middle = low + 1.0 if math.isinf(high) else (low + high) / 2
    return joint_forces(arch, middle) * _unit(arch, problem)


def _unit(arch: Arch, problem: Problem) -> float:
    """Return the unit of thrusts h in mean weights."""
    unit = arch.specific_weight * arch.thickness * arch.depth * arch.radius
    return unit / problem.unit_force


def _thrust(arch: Arch, thrust: float, unit: float) -> Thrust:
    """Return a thrust h in a unit of force, with its forces; a flat arch bears any."""
    if math.isinf(thrust):
        return Thrust(thrust=thrust, forces=None)
    return Thrust(thrust=thrust * unit, forces=unit * joint_forces(arch, thrust))


def joint_forces(arch: Arch, thrust: float, share: float = 1.0) -> Array:
    """Return forces at the ends of joints under a thrust h.

    Of all lines of thrust with that thrust it is the middle one of those that a share of the
    width contains.

    Returns (n + 1, 2, 2): Along normal and tangent, in units of gamma t d r.
    """
    angle, size = arch.joint_angles, np.abs(arch.joint_angles)
    normal = thrust * np.cos(size) + size * np.sin(size)
    shear = thrust * np.sin(angle) - angle * np.cos(angle)
    # Moments about the centre of the arch, of the crown's force and of the weight beyond it.
    weight = arch.centroid_factor * (1 - np.cos(size))
    room = normal * share * arch.eta / 2
    crown = (float((normal - weight - room).max()) + float((normal - weight + room).min())) / 2
    # A crown that nothing presses has its force nowhere.
    turn, width = crown - normal + weight, normal * arch.eta
    outward = np.divide(turn, width, out=np.zeros_like(turn), where=width != 0)
    ends = np.column_stack([0.5 - outward, 0.5 + outward])
    return ends[:, :, None] * np.column_stack([normal, shear])[:, None, :]
