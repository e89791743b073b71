"""The same problem in another form: elsewhere, mirrored, or in another order."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from blocksim import Assembly, Joint, Load, Problem

FLIP = np.array([-1.0, 1.0])


def turning(angle: float) -> np.ndarray:
    """Matrix that turns a vector counter-clockwise."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def moved(assembly: Assembly, by: Sequence[float]) -> Assembly:
    """Return the same blocks built elsewhere [m]."""
    return replace(
        assembly,
        blocks=tuple(
            replace(each, vertices=each.vertices + by, centre=each.centre + by)
            for each in assembly.blocks
        ),
        joints=tuple(
            replace(each, inner=each.inner + by, outer=each.outer + by)
            for each in assembly.joints
        ),
    )


def mirrored(problem: Problem) -> Problem:
    """Return the mirror image, its gravity and loads mirrored too."""
    assembly = problem.assembly
    blocks = tuple(
        replace(
            block,
            vertices=(block.vertices * FLIP)[::-1],
            centre=block.centre * FLIP,
            parts=tuple((part * FLIP)[::-1] for part in block.parts),
        )
        for block in assembly.blocks
    )
    supports = tuple(
        type(each)(tuple((part * FLIP)[::-1] for part in each.polygons), each.name)
        for each in assembly.supports
    )
    joints = tuple(_image(joint) for joint in assembly.joints)
    return replace(
        problem,
        assembly=replace(assembly, blocks=blocks, joints=joints, supports=supports),
        gravity=problem.gravity * [-1, 1, 1],
        dead=tuple(_pulled(load) for load in problem.dead),
        live=tuple(_pulled(load) for load in problem.live),
        maker=None,
    )


def _image(joint: Joint) -> Joint:
    # What was to the right, seen from the block before it, is to the left.
    return replace(
        joint,
        inner=joint.outer * FLIP,
        outer=joint.inner * FLIP,
        across=None if joint.across is None else joint.across * FLIP,
        faces=None if joint.faces is None else joint.faces[:, ::-1] * FLIP,
    )


def _pulled(load: Load) -> Load:
    point: np.ndarray | None = None if load.point is None else load.point * FLIP
    return replace(load, force=load.force * FLIP, point=point)


def renumbered(problem: Problem, seed: int) -> Problem:
    """Return the same with blocks, joints and their sides in another order."""
    assembly, random = problem.assembly, np.random.default_rng(seed)
    order = random.permutation(len(assembly.blocks)).tolist()
    place = {-1: -1, **{old: new for new, old in enumerate(order)}}
    joints: list[Joint] = []
    for index in random.permutation(len(assembly.joints)):
        joint = assembly.joints[index]
        sides = place[joint.before], place[joint.after]
        joint = replace(joint, before=sides[0], after=sides[1])
        joints.append(_reversed(joint) if random.random() < 0.5 else joint)

    def on(load: Load) -> Load:
        return replace(load, blocks=tuple(place[block] for block in load.blocks))

    return replace(
        problem,
        assembly=replace(
            assembly,
            blocks=tuple(assembly.blocks[old] for old in order),
            joints=tuple(joints),
        ),
        dead=tuple(on(load) for load in problem.dead),
        live=tuple(on(load) for load in problem.live),
        maker=None,
    )


def _reversed(joint: Joint) -> Joint:
    """Exchange the blocks before and after a joint: its normal turns round."""
    other = joint.turned
    faces = None if other.faces is None else other.faces[::-1]
    return replace(other, before=joint.after, after=joint.before, faces=faces)
