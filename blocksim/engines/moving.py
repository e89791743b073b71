"""Supports that move slowly, in `direct`: heavy blocks whose velocity is given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Block, Joint, Support
from blocksim.blocks.problem import Problem
from blocksim.blocks.regions import hull
from blocksim.engines.base import Settings
from blocksim.engines.direct import EXACT, Blocks

NEAR = 1e-6
"""Gap of a contact that counts as closed where supports have stopped [size]."""
HEAVY = 1e8
"""Mass and inertia of a support that moves [mean blocks]: what presses on it is nothing."""
DEEP = 3.0
"""How far below the structure ground lies where supports move [size]."""


class OnMovingSupports(Blocks):
    """Blocks on supports that move as a problem's `moves` say.

    `problem`: With `moves`.
    `speed`: Of the parameter of the supports' motion [size/sqrt(size/g)].
    `deep`: How far below the structure the ground lies [size].
    """

    def __init__(
        self, problem: Problem, settings: Settings, speed: float, deep: float = DEEP
    ) -> None:
        self._count = len(problem.assembly.blocks)
        self._size = problem.assembly.size
        self.problem = _with_supports_as_blocks(problem, deep)
        super().__init__(self.problem, settings)
        masses = self._mass.copy()
        masses[self._count :] = HEAVY
        self._mass = masses
        self._problem = self._new_problem()
        self._moves = problem.moves
        self.value = 0.0
        self._speed = speed
        self._pull()

    def _pull(self) -> None:
        super()._pull()
        # Their weight is borne by what moves them.
        self._free = self._free.copy()
        self._free[self._count :] = 0.0

    def _drive(self, step: float) -> None:
        # A step may be taken back: nothing is changed in place.
        self._velocities = self._velocities.copy()
        self._velocities[self._count :] = self._speed * self._ways()
        self.value += step * self._speed * self._size

    def _ways(self) -> Array:
        """Velocities of the centres of the supports, over that of the parameter."""
        found = np.zeros((len(self._moves), PLANAR))
        for at, move in enumerate(self._moves):
            turn = move.turn * self._size
            pivot = (move.about + move.direction * self.value) / self._size
            x, y = self._poses[self._count + at, :2] - pivot
            found[at] = move.direction[0] - turn * y, move.direction[1] + turn * x, turn
        return found

    def place(self, value: float, poses: Array) -> None:
        """Put blocks and supports where they were in another world, at rest."""
        self.value, self._poses = value, poses.copy()
        self._velocities = np.zeros_like(poses)

    def advance_once(self) -> None:
        """Move by one step."""
        self._move(self._step)

    @property
    def fastest(self) -> float:
        """Largest velocity of a block [size/sqrt(size/g)], or its rotation."""
        return float(np.abs(self._velocities[: self._count]).max())

    def stop(self) -> None:
        """Let the supports stay where they are from here on."""
        self._speed = 0.0

    def starts(self) -> float:
        """Stop the supports, and say with what acceleration the blocks start from rest [g]."""
        self.stop()
        self._velocities = np.zeros_like(self._velocities)
        self._pull()
        touch = self._touch(self._poses, self._step)
        rates = np.zeros((len(touch.gap), 4))
        # What is as good as closed would only close, faster than anything starts to fall.
        rates[:, :2] = np.where(touch.gap > NEAR, touch.gap / self._step**2, 0.0)
        found = self._solve(touch, rates, EXACT).acceleration
        return float(np.abs(found[: self._count]).max())


def _with_supports_as_blocks(problem: Problem, deep: float) -> Problem:
    """Return the problem with supports that move as its last blocks, ground far below."""
    assembly = problem.assembly
    mass = float(np.mean([block.mass for block in assembly.blocks]))
    count = len(assembly.blocks)
    place = {move.support: count + at for at, move in enumerate(problem.moves)}
    made = tuple(
        Block(
            vertices=hull(support.polygons),
            centre=np.concatenate(support.polygons).mean(axis=0),
            mass=mass,
            inertia=mass * assembly.size**2,
            depth=assembly.blocks[0].depth,
            name=support.name,
            parts=support.polygons if len(support.polygons) > 1 else (),
        )
        for support in (assembly.supports[each] for each in place)
    )
    stay = [at for at in range(len(assembly.supports)) if at not in place]
    left = {at: index for index, at in enumerate(stay)}

    def carried(joint: Joint) -> Joint:
        on = joint.support
        if on is None or on in left:
            return replace(joint, support=on if on is None else left[on])
        before = place[on] if joint.before == SUPPORT else joint.before
        after = place[on] if joint.after == SUPPORT else joint.after
        return replace(joint, before=before, after=after, support=None)

    # Level ground is below all that moves, or a support that settles would rest on it.
    corners = np.concatenate([block.vertices for block in (*assembly.blocks, *made)])
    (west, low), (east, _) = corners.min(axis=0), corners.max(axis=0)
    top, wide = low - deep * assembly.size, 2 * assembly.size
    west, east, foot = west - wide, east + wide, top - wide / 10
    ground = Support((np.array([(west, top), (west, foot), (east, foot), (east, top)]),))
    return replace(
        problem,
        assembly=replace(
            assembly,
            blocks=(*assembly.blocks, *made),
            joints=tuple(carried(joint) for joint in assembly.joints),
            supports=(*(assembly.supports[at] for at in stay), ground),
        ),
        moves=(),
    )
