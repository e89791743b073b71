"""A circular arch as a structure of its kind, which bears fill and loads on the road."""

from __future__ import annotations

import math

from blocksim.arch.circular import Arch, arch_of
from blocksim.blocks.entries import Around
from blocksim.blocks.problem import Problem
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.files import density_of, kind_behind, problem_of

LEAST_DENSITY = 100.0
"""Weight per volume below which weights are taken for ratios, not for newtons [N/m^3]."""


def structure_of_arch(arch: Arch, mu: float, lean: float = 0.0) -> Problem:
    """Ask about an arch as the kind `circular-arch`: the same voussoirs, weights and joints.

    Parameters
    ----------
    arch : Arch
    mu : float
        Friction coefficient of every joint, above 0, inf allowed.
    lean : float
        Angle by which gravity leans out of the plane [rad].
    """
    angle = math.degrees(arch.half_angle)
    kind = CircularArch(
        radius=arch.radius,
        thickness=arch.thickness,
        voussoirs=int(arch.voussoirs),
        depth=arch.depth,
        left_deg=angle,
        right_deg=angle,
        weight="centreline" if arch.weight == "centreline" else "curved",
    )
    around = Around(friction=0.0, density=arch.specific_weight)
    built = problem_of(kind, around).with_friction(mu)
    return built.leaning(lean) if lean else built


def arch_behind(problem: Problem) -> Arch | None:
    """Return the symmetric circular arch a problem was made from, either way; else None.

    One of the kind whose density was not given is none: its weights are ratios.
    """
    made = arch_of(problem)
    kind = None if made is not None else kind_behind(problem)
    if not isinstance(kind, CircularArch) or density_of(problem) < LEAST_DENSITY:
        return made
    equal = kind.left_deg == kind.right_deg and kind.weight != "chord" and kind.voussoirs > 2
    if not equal or kind.joints == "vertical":
        return None
    return Arch(
        half_angle=math.radians(kind.left_deg),
        eta=kind.thickness / kind.radius,
        voussoirs=kind.voussoirs,
        weight="centreline" if kind.weight == "centreline" else "sector",
        radius=kind.radius,
        depth=kind.depth,
        specific_weight=density_of(problem),
    )
