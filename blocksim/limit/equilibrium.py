"""Forces in the joints of any assembly that keep its blocks at rest, where there are any.

A linear program with nothing of arches in it: each end of a joint carries a force within its
cone of friction, and all of them balance the weights. By the static theorem of limit analysis
this is what standing means; Coulomb's law alone may allow blocks to move that could rest.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Assembly

SPARE = 1.0
"""Most that is asked for along every edge of a cone [mean weights]."""
FINEST = 1e-10
"""HiGHS's own least tolerance."""
SIGNS = np.array([1.0, -1.0])


def equilibrium(assembly: Assembly, mu: float) -> Array | None:
    """Find forces of equilibrium, as far inside their cones of friction as they can all be.

    Each force is a sum of parts along the two edges of its cone, and the least of all these
    parts is made as large as it can be.

    Parameters
    ----------
    assembly : Assembly
    mu : float
        Friction coefficient, finite.

    Returns
    -------
    (joints, 2, 2) float or None
        At the inner and the outer end of each joint, along its normal and its tangent, as
        they act on the block after it [mean weights]. None where blocks cannot rest.
    """
    joints = assembly.joint_arrays
    # Steep edges are scaled, or their normal parts would fade.
    upright = 1 / max(1.0, mu)
    along = np.where(joints.friction == 0, 0.0, mu * upright)
    normal, tangent = joints.normal[:, None, :], joints.tangent[:, None, :]
    edges = upright * normal + SIGNS[:, None] * along[:, None, None] * tangent
    balance = _accelerations(assembly, edges)
    parts = balance.shape[1]
    found = linprog(
        # What all parts have in common comes last.
        np.append(np.zeros(parts), -1.0),
        A_eq=np.column_stack([balance, balance.sum(axis=1)]),
        b_eq=np.tile([0.0, 1.0, 0.0], len(assembly.blocks)),
        bounds=[(0.0, None)] * parts + [(0.0, SPARE)],
        method="highs",
        options={"primal_feasibility_tolerance": FINEST},
    )
    if found.x is None or not found.success:
        return None
    shares = (found.x[:-1] + found.x[-1]).reshape(-1, 2, 2)
    pressure = upright * shares.sum(axis=2)
    friction = along[:, None] * (shares @ SIGNS)
    return np.stack([pressure, friction], axis=2)


def _accelerations(assembly: Assembly, edges: Array) -> Array:
    """Accelerations of the blocks by a unit of force along each edge.

    Shape (3 blocks, 4 joints): motions x, y and rotation of each block; at both ends of each
    joint both edges, shape (joints, 2, 2).
    """
    joints = assembly.joint_arrays
    # The support comes last, as index -1 says, and is left out in the end.
    centres = np.vstack([assembly.centres / assembly.size, np.zeros(2)])
    count = len(edges)
    found = np.zeros((len(centres), PLANAR, count, 2, 2))
    x, y = np.moveaxis(np.stack([edges, edges], axis=1), -1, 0)
    for sign, block in ((1.0, joints.after), (-1.0, joints.before)):
        arm = (joints.ends - centres[block][:, None])[:, :, None]
        turn = arm[..., 0] * y - arm[..., 1] * x
        found[block, :, np.arange(count)] = sign * np.stack([x, y, turn], axis=1)
    found = found[:SUPPORT] / assembly.masses[:, :, None, None, None]
    return found.reshape(PLANAR * len(assembly.blocks), -1)
