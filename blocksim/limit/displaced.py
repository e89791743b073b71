"""Blocks and supports that have moved: where they lie, and what their contacts allow.

Contacts that are closed stay so while blocks are carried to another position of the supports;
which of them open, and whether forces of equilibrium fit into them, the linear programme of the
displaced blocks tells. Contacts neither slip nor part here, and no new ones are followed: where
they would, and where blocks meet that did not touch, it says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array, Block, Joint, Support
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.regions import depths
from blocksim.limit.programme import equilibrium

Closed = NDArray[np.bool_]
Lost = Literal["slides", "parts", "jams", "meets"]
OPENS = 1e-7
"""Rate of a contact, over the largest of any block, from which on it opens or slips."""
SHUT = 1e-11
"""Overlap of a contact that is round-off [size]."""
OFF = 1e-9
"""How far closed contacts may be apart; the blocks cannot follow where it is more [size]."""
MEETS = 1e-6
"""How deep blocks are in each other, but at joints, where they have met [size]."""
ENOUGH = 1e-9
"""Lack of force at which blocks still rest [mean weights]."""
RANK = 1e-9
"""Stiffness below which nothing holds a motion, as a share of the greatest."""
ROUNDS = 50
"""Most corrections of places; a few are the rule."""
HALVINGS = 10
"""How often one is halved until it leads nearer."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """Blocks at rest on supports that have moved.

    `value`: The parameter of the supports' motion [m].
    `poses`, (blocks, 3): Centres of mass x, y in units of the size, and rotations.
    `closed`, (joints, 2): Which ends of the joints are closed, inner and outer.
    """

    value: float
    poses: Array
    closed: Closed

    @property
    def states(self) -> tuple[JointState, ...]:
        """What each joint does."""
        return tuple(
            JointState.of(inner=not inner, outer=not outer)
            for inner, outer in self.closed.tolist()
        )


class Displaced:
    """A problem whose blocks and supports have moved, and what its contacts allow."""

    def __init__(self, problem: Problem) -> None:
        assembly = problem.assembly
        self._problem, self.size = problem, assembly.size
        self._count = len(assembly.blocks)
        joints = assembly.joint_arrays
        on = [0 if each.support is None else each.support for each in assembly.joints]
        supports = self._count + np.array(on, dtype=np.int64)
        self._sides = np.stack(
            [
                np.where(side == SUPPORT, supports, side)
                for side in (joints.before, joints.after)
            ],
            axis=1,
        )
        self._supports = max(len(assembly.supports), 1 + max(on, default=0))
        self._arms = np.swapaxes(assembly.joint_arms, 0, 1)
        self._axes, self._corner = joints.normal, joints.is_corner
        self._reach = assembly.reach / self.size
        closed = np.ones((len(assembly.joints), 2), dtype=np.bool_)
        closed[self._corner, 1] = False
        self.start = Frame(value=0.0, poses=assembly.built[:-1], closed=closed)
        self._drawn = self._depths(self.start)
        for joint, pair in zip(assembly.joints, np.sort(self._sides).tolist(), strict=True):
            # A joint lies midway in the gap that it closes.
            deep = self._drawn.get(tuple(pair), 0.0)
            self._drawn[tuple(pair)] = max(deep, abs(joint.gap))

    def _placed(self, value: float) -> Array:
        """Poses of the supports, as turned about the origin and then shifted."""
        found = np.zeros((self._supports, PLANAR))
        for move in self._problem.moves:
            turn, about = move.turn * value, move.about / self.size
            shift = about - _turned(about, turn) + move.direction * value / self.size
            found[move.support] = *shift, turn
        return found

    def speeds(self, value: float) -> Array:
        """Velocities of the supports over the parameter [size], as `settling` takes them."""
        found = np.zeros((self._supports, PLANAR))
        for move in self._problem.moves:
            turn = move.turn * self.size
            x, y = (move.about + move.direction * value) / self.size
            found[move.support] = (
                move.direction[0] + turn * y,
                move.direction[1] - turn * x,
                turn,
            )
        return found

    def _arms_at(self, frame: Frame) -> tuple[Array, Array]:
        """Poses of the bodies on both sides of joints, and arms from them to their ends."""
        poses = np.vstack([frame.poses, self._placed(frame.value)])[self._sides]
        return poses, np.moveaxis(
            _turned(np.moveaxis(self._arms, -1, 0), poses[:, :, 2][:, :, None]), 0, -1
        )

    def _points(self, frame: Frame) -> Array:
        """Return the ends of the joints on both bodies, (joints, 2 bodies, 2 ends, 2)."""
        poses, arms = self._arms_at(frame)
        return poses[:, :, None, :2] + arms

    def closing(self, frame: Frame) -> float:
        """How far the nearest open contact is from closing [size]; below 0 beyond that."""
        return float(np.where(frame.closed, np.inf, self._gaps(frame)).min()) + SHUT

    def room(self, frame: Frame) -> float:
        """How much deeper blocks that meet can be in each other [size]; below 0 beyond that."""
        found = self._depths(frame)
        deeper = (deep - self._drawn.get(pair, 0.0) for pair, deep in found.items())
        return MEETS - max(deeper, default=0.0) / self.size

    def _depths(self, frame: Frame) -> dict[tuple[int, int], float]:
        """Find how deep blocks and supports are in each other [m], each pair that touches."""
        blocks = self._blocks_at(frame)
        bodies = [each.polygons for each in (*blocks, *self._supports_at(frame.value))]
        return depths(bodies, np.arange(len(bodies)) >= self._count)

    def shut(self, frame: Frame) -> Frame:
        """Close the contacts that touch."""
        touching = self._gaps(frame) <= 10 * SHUT
        return replace(frame, closed=frame.closed | touching)

    def fastest(self, rates: Array) -> float:
        """Largest velocity of a corner [size], or a little more."""
        return float((np.hypot(*rates[:, :2].T) + np.abs(rates[:, 2]) * self._reach).max())

    def _gaps(self, frame: Frame) -> Array:
        """How far apart the ends of joints are, (joints, 2); inf of those that cannot close."""
        points = self._points(frame)
        normal = _turned(self._axes.T, self._arms_at(frame)[0][:, 0, 2]).T
        gap = ((points[:, 1] - points[:, 0]) * normal[:, None]).sum(axis=-1)
        gap[self._corner, 1] = np.inf
        gap[~frame.closed.any(axis=1)] = np.inf
        return gap

    def problem(self, frame: Frame) -> Problem:
        """Return the problem as it lies, with the contacts that are closed."""
        asked = self._problem
        points = self._points(frame) * self.size
        joints: list[Joint] = []
        for index, joint in enumerate(asked.assembly.joints):
            ends = np.flatnonzero(frame.closed[index])
            on_before, on_after = points[index]
            middle = points[index].mean(axis=0)
            if len(ends) == 0:
                continue
            if len(ends) > 1:
                joints.append(replace(joint, inner=middle[0], outer=middle[1], faces=None))
                continue
            # A hinge bears across the line that halves the angle between both faces.
            faces = [side[1] - side[0] for side in (on_before, on_after)]
            if joint.is_corner:
                faces = [np.array([-joint.normal[1], joint.normal[0]])]
            along = np.sum([each / np.hypot(*each) for each in faces], axis=0)
            along = along / np.hypot(*along)
            at = middle[ends[0]]
            joints.append(
                replace(
                    joint,
                    inner=at,
                    outer=at,
                    across=np.array([along[1], -along[0]]),
                    faces=np.array([[at, at + along], [at, at]]),
                )
            )
        return replace(
            asked,
            assembly=replace(
                asked.assembly,
                blocks=self._blocks_at(frame),
                joints=tuple(joints),
                supports=self._supports_at(frame.value),
            ),
            dead=self._carried_loads(asked.dead, frame),
            live=self._carried_loads(asked.live, frame),
        )

    def _blocks_at(self, frame: Frame) -> tuple[Block, ...]:
        """Return the blocks where they lie."""
        places = frame.poses.copy()
        places[:, :2] *= self.size
        blocks = self._problem.assembly.blocks
        return tuple(moved(block, pose) for block, pose in zip(blocks, places, strict=True))

    def _supports_at(self, value: float) -> tuple[Support, ...]:
        """Return the supports where they have moved to."""
        moved = self._placed(value)
        return tuple(
            replace(
                support,
                polygons=tuple(
                    _turned(part.T, float(turn)).T + np.array([x, y]) * self.size
                    for part in support.polygons
                ),
            )
            for support, (x, y, turn) in zip(
                self._problem.assembly.supports, moved, strict=False
            )
        )

    def _carried_loads(self, loads: tuple[Load, ...], frame: Frame) -> tuple[Load, ...]:
        """Return loads whose points have moved with their blocks."""
        found: list[Load] = []
        for load in loads:
            if load.point is None:
                found.append(load)
                continue
            for index in load.blocks:
                x, y, turn = frame.poses[index]
                arm = load.point - self._problem.assembly.centres[index]
                point = np.array([x, y]) * self.size + _turned(arm, turn)
                found.append(replace(load, blocks=(index,), point=point))
        return tuple(found)

    def margin(self, frame: Frame) -> float:
        """Say how well forces of equilibrium fit into the closed contacts."""
        return max(equilibrium(self.problem(frame)).margin, -1.0) if self.fit(frame) else -1.0

    def fit(self, frame: Frame) -> bool:
        """Tell whether contacts that are closed are so in fact: the blocks could follow."""
        return bool(np.abs(self._apart(frame)[0]).max(initial=0.0) <= OFF)

    def held(self, frame: Frame) -> Frame:
        """Return a frame without the contacts that have come apart."""
        points = self._points(frame)
        near = np.linalg.norm(points[:, 1] - points[:, 0], axis=-1) <= OFF
        return replace(frame, closed=frame.closed & near)

    def opened(
        self, frame: Frame, rates: Array, value_rate: float
    ) -> tuple[Frame, Lost | None]:
        """Return a frame without the contacts that a motion opens, and what else it does."""
        poses, arms = self._arms_at(frame)
        bodies = np.vstack([rates, value_rate * self.speeds(frame.value)])[self._sides]
        # Velocities of supports are told at the origin, so their arms are points.
        points = self._points(frame)
        arms = np.where((self._sides < self._count)[:, :, None, None], arms, points)
        around = bodies[:, :, None, 2:] * arms[..., ::-1] * [-1, 1]
        way = bodies[:, :, None, :2] + around
        apart = way[:, 1] - way[:, 0]
        scale = np.abs(rates).max() or 1.0
        normal = _turned(self._axes.T, poses[:, :, 2].mean(axis=1)).T
        opens = frame.closed & ((apart * normal[:, None]).sum(axis=-1) > OPENS * scale)
        stays = frame.closed & ~opens
        slips = np.hypot(apart[..., 0], apart[..., 1]) > 10 * OPENS * scale
        lost: Lost | None = None
        if (stays & slips).any():
            lost = "slides"
        elif (frame.closed.any(axis=1) & ~stays.any(axis=1)).any():
            lost = "parts"
        return replace(frame, closed=stays), lost

    def energy(self, frame: Frame) -> float:
        """Return the potential energy [mean weight times size], 0 where they were built."""
        return -float((self._problem.applied_forces() * (frame.poses - self.start.poses)).sum())

    def free(self, frame: Frame) -> Array:
        """Return motions on supports at rest in which all closed contacts stay closed."""
        _, sizes, ways = np.linalg.svd(self._apart(frame)[1])
        held = int((sizes > RANK * sizes.max(initial=0.0)).sum())
        return ways[held:].reshape(-1, self._count, PLANAR)

    def carried(self, frame: Frame, value: float, poses: Array | None = None) -> Frame:
        """Carry the blocks to another position of the supports, contacts closed as they are.

        As near to that as they come: where hinges get into line the blocks cannot follow.
        """
        now = replace(frame, value=value, poses=frame.poses if poses is None else poses)
        left, rows = self._apart(now)
        for _ in range(ROUNDS):
            change = np.linalg.lstsq(rows, -left, rcond=1e-12)[0].reshape(-1, PLANAR)
            # A whole step from near such a line may lead anywhere.
            for part in 0.5 ** np.arange(HALVINGS):
                ahead = replace(now, poses=now.poses + part * change)
                still, there = self._apart(ahead)
                if still @ still < left @ left:
                    break
            else:
                break
            now, left, rows = ahead, still, there
            if np.abs(change).max(initial=0.0) < 1e-14:
                break
        return now

    def _apart(self, frame: Frame) -> tuple[Array, Array]:
        """How far closed contacts are apart, and the rates of that."""
        poses, arms = self._arms_at(frame)
        every = np.arange(len(poses))
        # Of each joint the place of one end that is closed, and its rotation.
        arms = arms[every, :, np.where(frame.closed[:, 0], 0, 1)]
        places = np.concatenate([poses[..., :2] + arms, poses[..., 2:]], axis=-1)
        rates = np.broadcast_to(np.eye(PLANAR), (*arms.shape[:2], PLANAR, PLANAR)).copy()
        rates[..., :2, 2] = arms[..., ::-1] * [-1, 1]
        rows = np.zeros((len(poses), PLANAR, self._count + self._supports, PLANAR))
        rows[every, :, self._sides[:, 1]] = rates[:, 1]
        rows[every, :, self._sides[:, 0]] = -rates[:, 0]
        one, both = frame.closed.any(axis=1), frame.closed.all(axis=1)
        held = np.stack([one, one, both], axis=1)
        whole = rows[held][:, : self._count].reshape(held.sum(), -1)
        return (places[:, 1] - places[:, 0])[held], whole


def _turned(arm: Array, turn: Array | float) -> Array:
    """Vectors (2, ...) turned by angles."""
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]])


def moved(block: Block, pose: Array) -> Block:
    """Return a block where it lies: its centre x, y [m], and its turn."""
    x, y, turn = pose.tolist()

    def carried(points: Array) -> Array:
        return _turned((points - block.centre).T, turn).T + np.array([x, y])

    return replace(
        block,
        vertices=carried(block.vertices),
        centre=np.array([x, y]),
        parts=tuple(carried(part) for part in block.parts),
    )
