"""Groups of blocks that touch each other: what happens to one is nothing to the others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import SUPPORT
from blocksim.blocks.bodies import connected
from blocksim.blocks.problem import Load, Problem


@dataclass(frozen=True, kw_only=True, eq=False)
class Group:
    """Blocks that touch each other, as a problem of their own on the same supports.

    `blocks`, `joints`: Which of the whole problem's they are.
    """

    problem: Problem
    blocks: NDArray[np.int64]
    joints: NDArray[np.int64]


def groups_of(problem: Problem) -> Iterator[Group]:
    """Return the groups of a problem's blocks; supports join none."""
    arrays, count = problem.assembly.joint_arrays, len(problem.assembly.blocks)
    both = (arrays.before != SUPPORT) & (arrays.after != SUPPORT)
    group = connected(count, arrays.before[both], arrays.after[both])
    many = int(group.max()) + 1
    one = np.where(arrays.before == SUPPORT, arrays.after, arrays.before)
    for each in range(many):
        blocks, joints = np.flatnonzero(group == each), np.flatnonzero(group[one] == each)
        part = problem if many == 1 else _part(problem, blocks.tolist(), joints.tolist())
        yield Group(problem=part, blocks=blocks, joints=joints)


def _part(problem: Problem, blocks: list[int], joints: list[int]) -> Problem:
    """Return a problem with some of its blocks, all their joints, and what acts on them."""
    assembly = problem.assembly
    place = {block: at for at, block in enumerate(blocks)} | {SUPPORT: SUPPORT}

    def own(loads: tuple[Load, ...]) -> tuple[Load, ...]:
        kept = ((each, [at for at in each.blocks if at in place]) for each in loads)
        return tuple(
            replace(each, blocks=tuple(place[at] for at in acts)) for each, acts in kept if acts
        )

    mine = [assembly.joints[at] for at in joints]
    return replace(
        problem,
        assembly=replace(
            assembly,
            blocks=tuple(assembly.blocks[at] for at in blocks),
            joints=tuple(
                replace(each, before=place[each.before], after=place[each.after])
                for each in mine
            ),
        ),
        dead=own(problem.dead),
        live=own(problem.live),
    )
