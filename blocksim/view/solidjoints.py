"""What joints in space are seen to do, and how it is painted: faces in colour, forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.assembly import SpatialAssembly
from blocksim.blocks.space.parting import parted
from blocksim.blocks.space.polyhedron import frame
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.limit.space.statics import state_of
from blocksim.view.drawing import words_of
from blocksim.view.solidscene import Marks

SEEN = 4e-3
"""Opening or slip from which on a joint is coloured [size], as in the plane."""
GONE = 0.1
"""Opening of all points from which on it is no joint any more [size]."""
LONGEST = 0.25
"""Length of the largest force [size]."""
FAINT = 1e-6
"""Share of the largest force below which there is none."""


def states_at(assembly: SpatialAssembly, poses: Array) -> tuple[JointState, ...]:
    """Tell what each joint is seen to do where blocks have gone.

    Parameters
    ----------
    assembly : SpatialAssembly
    poses : (blocks, 6) float
        Centres in units of the size, and rotation vectors since they were built.
    """
    gap, slip = parted(assembly, poses)
    ends = np.cumsum([len(each.points) for each in assembly.joints])[:-1]
    found: list[JointState] = []
    for opens, slides in zip(np.split(gap, ends), np.split(slip, ends), strict=True):
        away = float(opens.min()) > GONE or float(slides.min()) > GONE
        together = opens <= SEEN
        state = state_of(together, together & (slides > SEEN))
        found.append(JointState.CLOSED if away else state)
    return tuple(found)


def marks_of(assembly: SpatialAssembly, states: Sequence[JointState]) -> Marks:
    """Return joints that take part by block, each with its normal out of it and a colour."""
    told: dict[int, list[tuple[Array, Array, str]]] = {}
    for joint, state in zip(assembly.joints, states, strict=True):
        if state is JointState.CLOSED or len(joint.points) < 3:
            continue
        tone = words_of(state, is_arch=False)[1]
        for side, sign in ((joint.before, 1.0), (joint.after, -1.0)):
            told.setdefault(side, []).append((joint.points, sign * joint.normal, tone))
    return told


def force_lines(problem: SpatialProblem, forces: Array) -> tuple[Array, Array]:
    """Return where the resultants of joints act, and how large they are.

    Parameters
    ----------
    problem : SpatialProblem
    forces : (points, 3) float
        At the points of all joints, along their normals and across, as of `SpatialStatics`.

    Returns
    -------
    lines : (joints, 2, 3) float
        From end to end through the centre of pressure, in proportion to the force [m].
    shares : (joints,) float
        Of the largest force.
    """
    joints = problem.assembly.joints
    ends = np.cumsum([len(each.points) for each in joints])[:-1]
    parts = np.split(forces, ends)
    axes = [np.vstack([each.normal, frame(each.normal)]) for each in joints]
    sums = np.array([part.sum(axis=0) @ axis for part, axis in zip(parts, axes, strict=True)])
    sizes = np.linalg.norm(sums, axis=1)
    largest = float(sizes.max(initial=0.0)) or 1.0
    lines = np.zeros((len(joints), 2, 3))
    for at, (joint, part) in enumerate(zip(joints, parts, strict=True)):
        press = np.maximum(part[:, 0], 0.0)
        weights = press if press.sum() > 0 else np.ones(len(press))
        place = np.average(joint.points, axis=0, weights=weights)
        way = LONGEST * problem.assembly.size * sums[at] / largest / 2
        lines[at] = place - way, place + way
    return lines, np.where(sizes > FAINT * largest, sizes / largest, 0.0)
