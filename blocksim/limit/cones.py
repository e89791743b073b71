"""Forces that joints can carry: the cones of friction at their ends, and what those balance."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem
from blocksim.blocks.rows import column
from blocksim.common.later import sparse, sparse_linalg
from blocksim.limit.linear import LinearProgramme, Optimum

ROUND_OFF = 1e-9
"""Lack of force that is round-off, over what the joint or the block carries."""
UNTURNED = 1e9
"""Inertia over that of the mass at the farthest corner, from which on nothing turns a block."""


class Cones:
    """Edges of the cones of friction at all ends of joints, and what their forces do.

    A cone of finite friction has two edges, one without friction has one; unbounded
    friction leaves a normal part that presses and a tangential one that is free.

    Equations and parts have scales of their own, so a pebble is seen as exactly as a pier. The
    forces on a block are divided by the weight that it carries, its moments by that times its
    reach (`ease`). The parts at a joint are in units of the lesser weight that the two blocks
    at it carry (`unit`).

    `problem`: In its plane.
    `friction`, (joints,): Instead of the problem's own.
    `width`: Share of each joint's width that may be used, about its middle.
    `weights`, (blocks,): What each block carries, instead of an estimate [mean weights].
    """

    def __init__(
        self,
        problem: Problem,
        *,
        friction: Array | None = None,
        width: float = 1.0,
        weights: Array | None = None,
    ) -> None:
        assembly, joints = problem.assembly, problem.assembly.joint_arrays
        self._joints = len(assembly.joints)
        self.shape = (len(assembly.blocks), PLANAR)
        weights = carried_weights(problem) if weights is None else weights
        self.weights = weights
        reach = assembly.reach / assembly.size
        self.ease = 1 / np.column_stack([weights, weights, weights * reach])
        # What nothing can turn (half a keystone on its plane) bears any moment.
        turned = assembly.masses[:, 2] < UNTURNED * assembly.masses[:, 0] * reach**2
        self.ease[:, 2] *= np.where(turned, 1.0, UNTURNED**-2)
        self.unit = joint_weights(problem, weights)
        self._friction = problem.friction if friction is None else friction
        self._sides = assembly.sides
        self._edges()
        self._direction = (
            self._normal[:, None] * joints.normal[self._joint]
            + self._tangent[:, None] * joints.tangent[self._joint]
        )
        middle = joints.ends.mean(axis=1, keepdims=True)
        ends_used = joints.ends if width == 1 else middle + width * (joints.ends - middle)
        self._point = ends_used.reshape(-1, 2)[self._end]
        # Where each part meets a support: which, and in which sense it acts on it.
        on = column(assembly.joints, "support")
        which = [-1 if each is None else each for each in on]
        self._support = np.array(which, dtype=np.int64)[self._joint]
        on_after = (joints.after == SUPPORT)[self._joint]
        on_before = (joints.before == SUPPORT)[self._joint]
        self._sense = on_after.astype(np.float64) - on_before
        self.balance = self._balance(assembly.built[:, :2])

    def _edges(self) -> None:
        """Lay the parts along the edges of the cones at all ends."""
        mu = np.repeat(self._friction, 2)
        ends = np.arange(2 * self._joints)
        finite, rough = ends[np.isfinite(mu)], ends[(mu > 0) & np.isfinite(mu)]
        boundless = ends[np.isinf(mu)]
        # Steep edges are scaled, or their normal parts would fade.
        upright = 1 / np.maximum(1.0, np.where(np.isfinite(mu), mu, 0.0))
        along = np.where(np.isfinite(mu), mu, 0.0) * upright
        self._end = np.concatenate([finite, rough, boundless, boundless])
        self._joint = self._end // 2
        ones, unit = np.ones(len(boundless)), self.unit[self._joint]
        self._normal = unit * np.concatenate([upright[finite], upright[rough], ones, 0 * ones])
        self._tangent = unit * np.concatenate([along[finite], -along[rough], 0 * ones, ones])
        self.count = len(self._end)
        free = self.count - len(boundless)
        self.bounded = np.where(np.arange(self.count) < free, 1.0, 0.0)

    def _balance(self, centres: Array) -> sparse.csc_array:
        """Return what the parts do to the blocks: the support, index -1, is left out."""
        rows: list[NDArray[np.int64]] = []
        values: list[Array] = []
        before, after = self._sides
        for sign, block in ((1.0, after), (-1.0, before)):
            mine = block[self._joint]
            arm, way = self._point - centres[mine], self._direction
            turn = arm[:, 0] * way[:, 1] - arm[:, 1] * way[:, 0]
            part = sign * np.column_stack([way, turn])
            part *= np.vstack([self.ease, np.zeros(PLANAR)])[mine]
            rows.append(PLANAR * np.maximum(mine, 0)[:, None] + np.arange(PLANAR))
            values.append(part)
        columns = np.tile(np.repeat(np.arange(self.count), PLANAR), 2)
        at = np.concatenate([each.ravel() for each in rows]), columns
        entries = np.concatenate([each.ravel() for each in values])
        return sparse.csc_array((entries, at), shape=(PLANAR * self.shape[0], self.count))

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Least and greatest parts: they press; what is tangential only may have any sign."""
        low = np.where(self.bounded > 0, 0.0, -math.inf)
        return low, np.full(self.count, math.inf)

    @cached_property
    def pressing(self) -> Any:
        """Sparse (2 joints, parts): what the parts press at each end of each joint."""
        at = (self._end, np.arange(self.count))
        return sparse.csr_array((self._normal, at), shape=(2 * self._joints, self.count))

    def loads(self, pull: Array) -> Array:
        """Return loads on the blocks as the balance has them, in one row."""
        return (pull * self.ease).ravel()

    def at_supports(self, velocities: Array) -> Array:
        """Return at which rate each part works on supports that move, (parts,)."""
        still = np.vstack([velocities, np.zeros(PLANAR)])[self._support]
        x, y = self._point.T
        way = np.column_stack([still[:, 0] - still[:, 2] * y, still[:, 1] + still[:, 2] * x])
        return self._sense * (way * self._direction).sum(axis=1)

    def rates(self, prices: Array) -> Array:
        """Return the rates of the blocks that the prices of the balance are, (blocks, 3)."""
        return -prices.reshape(self.shape) * self.ease

    def polished(self, parts: Array, pull: Array, fine: float = ROUND_OFF) -> Array:
        """Take away the imbalance the solver leaves, by the least change in ratio."""
        left = -self.loads(pull) - self.balance @ parts
        if np.abs(left).max() < fine:
            return parts
        # In proportion to what presses, so that it stays within the cones.
        room = np.where(self.bounded > 0, np.maximum(parts, 0.0), 1.0)
        solve: Any = sparse_linalg.lsmr
        scaled = self.balance @ sparse.diags_array(room)
        change = room * solve(scaled, left, atol=1e-15, btol=1e-15)[0]
        better = parts + change
        worst = np.abs(-self.loads(pull) - self.balance @ better).max()
        return better if worst < np.abs(left).max() else parts

    def left(self, parts: Array, pull: Array) -> float:
        """Return the largest force or moment that parts leave, over what its block carries."""
        return float(np.abs(self.loads(pull) + self.balance @ parts).max())

    def seen_weights(self, parts: Array) -> Array:
        """Return what blocks carry, by forces that were found, (blocks,) float."""
        found = np.append(self.weights, 0.0)
        force = np.abs(parts) * self.unit[self._joint]
        for sides in self._sides:
            np.maximum.at(found, sides[self._joint], force)
        return found[:-1]

    def work(self, ways: Array) -> Array:
        """Return what each part does along given ways of the ends, (joints, 2, 2)."""
        normal, tangent = ways.reshape(-1, 2)[self._end].T
        return self._normal * normal + self._tangent * tangent

    def forces(self, parts: Array) -> Array:
        """Sum parts to forces at the ends of joints, shape (joints, 2, 2)."""
        found = np.zeros((2 * self._joints, 2))
        np.add.at(
            found, self._end, np.column_stack([self._normal, self._tangent]) * parts[:, None]
        )
        return found.reshape(-1, 2, 2)


def most(
    cones: Cones,
    columns: Any,
    right: Array,
    bounds: tuple[ArrayLike, ArrayLike],
    solver: LinearProgramme | None = None,
) -> Optimum:
    """Make the factor on the last of some columns as large as the balance of forces allows.

    `bounds`: Least and greatest factor on each of them.
    """
    low, high = (np.append(each, end) for each, end in zip(cones.bounds, bounds, strict=True))
    cost = np.zeros(low.size)
    cost[-1] = -1.0
    matrix = sparse.hstack([cones.balance, columns], format="csc")
    return (solver or LinearProgramme()).solve(cost, matrix, (right, right), (low, high))


def joint_weights(problem: Problem, weights: Array) -> Array:
    """Return the lesser weight that the two blocks at each joint carry, (joints,) float."""
    return np.append(weights, math.inf)[problem.assembly.sides].min(axis=0)


def joint_areas(problem: Problem) -> Array:
    """Return width times depth of each joint, (joints,) float [m^2]; 0 of a corner."""
    assembly = problem.assembly
    depths = np.append(assembly.depths * assembly.size, np.inf)
    depth = depths[assembly.sides].min(axis=0)
    return assembly.joint_arrays.length * assembly.size * depth


def carried_weights(problem: Problem) -> Array:
    """Estimate the weight that each block carries: its own, loads, and what comes from above.

    Each block hands on what it carries to those of its neighbours that are nearer to the
    supports, by the number of joints between, in equal shares.

    Returns (blocks,): In mean weights.
    """
    assembly = problem.assembly
    pull = problem.applied_forces()
    found = assembly.masses[:, 0] + np.hypot(pull[:, 0], pull[:, 1])
    found += np.abs(pull[:, 2]) * assembly.size / assembly.reach
    neighbours: list[set[int]] = [set[int]() for _ in range(len(found))]
    first = set[int]()
    pairs: list[list[int]] = assembly.sides.T.tolist()
    for one, other in pairs:
        if SUPPORT in (one, other):
            first.add(max(one, other))
        else:
            neighbours[one].add(other)
            neighbours[other].add(one)
    rank, layers = dict.fromkeys(first, 0), [sorted(first)]
    while layers[-1]:
        near_by = (near for block in layers[-1] for near in neighbours[block])
        beyond = {near for near in near_by if near not in rank}
        rank |= dict.fromkeys(beyond, len(layers))
        layers.append(sorted(beyond))
    for layer in layers[:0:-1]:
        for block in layer:
            below = [near for near in neighbours[block] if rank[near] < rank[block]]
            for near in below:
                found[near] += found[block] / len(below)
    return found
