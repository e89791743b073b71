"""What joints in space carry, from the forces at their points."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.points import JointPoints
from blocksim.limit.resultants import Resultants


def resultants_in_space(problem: Problem[SpatialAssembly], forces: Array) -> Resultants:
    """Sum forces at the points of joints, (points, 3) [N], as of `SpatialEquilibrium`."""
    points, joints = JointPoints(problem), problem.assembly.joints
    first = np.flatnonzero(np.diff(points.joint, prepend=-1))

    def total(values: Array) -> Array:
        return np.add.reduceat(values, first, axis=0)

    sums, press = total(forces), np.maximum(forces[:, 0], 0.0)
    press = np.where(total(press)[points.joint] > 0, press, 1.0)
    places = problem.assembly.points
    most, unknown = problem.friction * sums[:, 0], np.full(len(joints), math.nan)
    rubs = total(np.hypot(forces[:, 1], forces[:, 2]))
    return Resultants(
        normal=sums[:, 0],
        friction=np.hypot(sums[:, 1], sums[:, 2]),
        force=np.einsum("ji,jid->jd", sums, points.axes),
        point=total(press[:, None] * places) / total(press)[:, None],
        width_used=unknown,
        stress=unknown,
        friction_used=np.divide(rubs, most, out=np.zeros_like(rubs), where=most > 0),
    )
