"""Whether Coulomb's law lets blocks at rest start to move, although they can rest.

For accelerations a and contact forces p of blocks at rest the law is a complementarity problem,

    M a = w + N^T p_n + T^T p_t,    0 <= p_n  _|_  N a >= 0,    |p_t| <= mu p_n,
    p_t = -mu p_n sign(T a) where T a is not 0.

It may have several solutions where blocks slide. Here the one with the largest power of the
loads, w . a, is sought: what each contact does is chosen by branch and bound (a mixed-integer
linear programme; J. Fortuny-Amat and B. McCarl, J. Oper. Res. Soc. 32, 1981, 783-792). The
power of any motion is positive: w . a is a . M a and what friction takes away. So blocks must
rest where the largest is 0. It also bounds the accelerations: as a . M a <= w . a, the norm of
the motion, the root of a . M a, is at most that of the fall without contacts.

Contact forces have no such bound, as blocks may be wedged. But with a motion all its multiples
are solutions, too, under that multiple of the loads: so forces add up to no more than the loads
do, and the loads are a share of what they are, the smaller the larger the forces.

Blocks that touch none of the others, but for supports, are a group that moves by itself. Each
is asked by itself, in its own units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.bodies import parting
from blocksim.blocks.groups import groups_of
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.later import sparse
from blocksim.limit.linear import choose
from blocksim.limit.programme import equilibrium

LEAST_POWER = 1e-7
"""Power of the loads up to which nothing moves, over that of the fall without contacts; times
the largest contact force over the sum of all loads, where that is above 1."""
LIGHTEST = 1e-3
"""Power of the fall of a block, over that of the mean one, below which it is not told that all
must rest."""
SECONDS = 60.0
WRONG = 1e-6
"""Residual of a motion, over its largest rate, above which it is none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """Whether blocks at rest may start to move.

    `moves`: None where the time did not suffice to tell.
    `accelerations`, (blocks, 3): x, y [g] and rotation [g/size] of the motion with the largest
        power; None without one.
    `forces`, (joints, 2, 2): That act in it, as of `Equilibrium`; the friction of a joint is
        given to its ends in the ratio of their pressures.
    `power`: Of the loads in that motion, over that of the fall without contacts.
    """

    moves: bool | None
    accelerations: Array | None = None
    forces: Array | None = None
    power: float = 0.0


def may_start(problem: Problem, *, seconds: float = SECONDS) -> Start:
    """Tell whether blocks at rest may start to move, by Coulomb's law.

    `problem`: In its plane, with bounded friction.
    `seconds`: Time after which it gives up.
    Raises `InputError`: If friction is unbounded: what the law says is a limit then, and no
        choice.
    """
    require(bool(np.isfinite(problem.friction).all()), "mu", math.inf, "finite to ask this")
    accelerations = np.zeros(problem.assembly.masses.shape)
    forces = equilibrium(problem).forces
    if forces is None:
        forces = np.zeros((len(problem.assembly.joints), 2, 2))
    found: list[Start] = []
    for group in groups_of(problem):
        start = _of_group(_Law(group.problem), seconds)
        found.append(start)
        if start.accelerations is not None and start.forces is not None:
            unit = group.problem.unit_force / problem.unit_force
            accelerations[group.blocks] = start.accelerations
            forces[group.joints] = unit * start.forces
    power = max((each.power for each in found), default=0.0)
    if any(each.moves for each in found):
        return Start(moves=True, accelerations=accelerations, forces=forces, power=power)
    return Start(moves=False if all(each.moves is False for each in found) else None)


def _of_group(law: _Law, seconds: float) -> Start:
    """Tell whether blocks of a group may start to move."""
    if not law.fall:
        return Start(moves=False)
    least = LEAST_POWER * max(law.lightest, LIGHTEST)
    found = choose(
        law.cost,
        law.matrix,
        law.rows,
        law.bounds,
        whole=law.whole,
        gap=least / 2 * law.fall,
        seconds=seconds,
    )
    power = float(-law.cost @ found.values) / law.fall if found.values.size else 0.0
    if power > least:
        share, accelerations, forces, residual = law.motion(found.values)
        if residual <= WRONG:
            return Start(
                moves=True,
                accelerations=accelerations,
                forces=forces,
                power=power / share,
            )
        return Start(moves=None)
    surely = found.values.size > 0 and -found.least / law.fall <= least
    # Of blocks so much lighter than others the solver's tolerance would hide a motion.
    surely = surely and law.lightest >= LIGHTEST
    return Start(moves=False if surely else None)


def rates_of(problem: Problem) -> Array:
    """Return what blocks' velocities are at joints, (joints, 3, 3 blocks).

    Opening at both ends, and slip of the block after the joint. The ends of a straight joint
    slip alike.
    """
    assembly, joints = problem.assembly, problem.assembly.joint_arrays
    each = np.eye(assembly.masses.size).reshape(-1, *assembly.masses.shape)
    ways = np.stack([parting(assembly, rates)[0] for rates in each], axis=-1)
    opening = np.einsum("jd,jedk->jek", joints.normal, ways)
    slip = np.einsum("jd,jdk->jk", joints.tangent, ways[:, 0])
    return np.concatenate([opening, slip[:, None]], axis=1)


class _Law:
    """Coulomb's law for blocks at rest as a mixed-integer linear programme.

    Its unknowns are accelerations times the root of mass, pressures at both ends and friction
    of each joint, choices: which ends may press, and which joints may slip up or down; and the
    share of the loads that acts.
    """

    def __init__(self, problem: Problem) -> None:
        # Forces are in units of the sum of all loads.
        unit = float(np.abs(problem.applied_forces()[:, :2]).sum()) or 1.0
        self._unit, self._shape = unit, problem.assembly.masses.shape
        self._root = np.sqrt(problem.assembly.masses.ravel() / unit)
        free = problem.applied_forces().ravel() / unit / self._root
        self.fall = float(free @ free)
        of_blocks = (free**2).reshape(self._shape).sum(axis=1)
        mean = self.fall / len(of_blocks) or 1.0
        self.lightest = float(of_blocks[of_blocks > 0].min(initial=mean)) / mean
        self._rates = rates_of(problem)
        self._mu, joints = problem.friction, len(problem.assembly.joints)
        self._joints, largest = joints, 1.0
        kinds = [0, len(free), 2 * joints, joints, 2 * joints, joints, joints, 1]
        self._first = np.cumsum(kinds)
        rates = self._rates / self._root
        fastest = np.sqrt((rates**2).sum(axis=2) * self.fall)
        self._parts: list[tuple[sparse.csr_array, Array, Array]] = []
        self._newton(rates, free)
        self._ends(rates[:, :2].reshape(2 * joints, -1), fastest[:, :2].ravel(), largest)
        self._slips(rates[:, 2], fastest[:, 2], largest)
        self.matrix = sparse.vstack([each for each, _, _ in self._parts]).tocsc()
        self.rows = (
            np.concatenate([low for _, low, _ in self._parts]),
            np.concatenate([high for _, _, high in self._parts]),
        )
        size = math.sqrt(self.fall)
        rubs = 2 * self._mu * largest
        ones, choices = np.ones(len(free)), np.ones(4 * joints)
        pressed = np.full(2 * joints, largest)
        self.bounds = (
            np.concatenate([-size * ones, 0 * pressed, -rubs, 0 * choices, [0.0]]),
            np.concatenate([size * ones, pressed, rubs, choices, [1.0]]),
        )
        unknown: NDArray[np.int64] = np.arange(int(self._first[-1]))
        self.whole: NDArray[np.bool_] = (unknown >= self._first[3]) & (unknown < self._first[6])
        self.cost = np.zeros(self._first[-1])
        self.cost[: len(free)] = -free

    def motion(self, values: Array) -> tuple[float, Array, Array, float]:
        """Return the share of the loads, and under all of them accelerations and forces.

        At last by how much these are no solution.
        """
        share = float(values[-1])
        x, pressure, friction, _ = np.split(values / share, self._first[1:4])
        pressure = np.maximum(pressure.reshape(-1, 2), 0.0)
        rates = self._rates @ (x / self._root)
        opening, slip = rates[:, :2], rates[:, 2]
        bound = self._mu * pressure.sum(axis=1)
        against = np.where(np.abs(slip) > WRONG, bound + np.sign(slip) * friction, 0.0)
        wrong = [
            np.minimum(pressure, np.abs(opening)),
            -opening,
            np.minimum(np.abs(against), np.abs(slip)),
            np.abs(friction) - bound,
        ]
        residual = max(float(each.max(initial=0.0)) for each in wrong)
        total = pressure.sum(axis=1, keepdims=True)
        parts = np.divide(pressure, total, out=np.full_like(pressure, 0.5), where=total > 0)
        forces = self._unit * np.stack([pressure, parts * friction[:, None]], axis=2)
        moving = (x / self._root).reshape(self._shape)
        return share, moving, forces, residual / np.abs(rates).max()

    def _add(
        self, parts: list[tuple[int, Array | sparse.csr_array]], low: Array, high: Array
    ) -> None:
        """Add rows: what stands before the unknowns of some kinds, and their bounds."""
        row = [sparse.csr_array((len(low), width)) for width in np.diff(self._first)]
        for kind, what in parts:
            given = sparse.diags_array(what) if isinstance(what, np.ndarray) else what
            row[kind] = sparse.csr_array(given)
        self._parts.append((sparse.hstack(row).tocsr(), low, high))

    def _newton(self, rates: Array, free: Array) -> None:
        normal = rates[:, :2].reshape(2 * self._joints, -1)
        every = np.ones(len(free))
        forces = [sparse.csr_array(-each.T) for each in (normal, rates[:, 2])]
        loads = sparse.csr_array(-free[:, None])
        none = np.zeros(len(free))
        self._add([(0, every), (1, forces[0]), (2, forces[1]), (6, loads)], none, none)

    def _ends(self, rates: Array, fastest: Array, largest: float) -> None:
        """Each end presses or opens."""
        ones, none = np.ones(len(rates)), np.full(len(rates), -np.inf)
        along = sparse.csr_array(rates)
        self._add([(0, along)], 0 * ones, -none)
        self._add([(0, along), (3, fastest)], none, fastest)
        self._add([(1, ones), (3, -largest * ones)], none, 0 * ones)

    def _slips(self, rates: Array, fastest: Array, largest: float) -> None:
        """Each joint slips up or down, with friction against it, or not."""
        ones, none = np.ones(self._joints), np.full(self._joints, -np.inf)
        along = sparse.csr_array(rates)
        self._add([(0, along), (4, -fastest)], none, 0 * ones)
        self._add([(0, along), (5, fastest)], 0 * ones, -none)
        self._add([(4, ones), (5, ones)], none, ones)
        # Steep cones are scaled, or pressures would fade beside friction.
        scale = 1 / np.maximum(1.0, self._mu)
        bound = sparse.csr_array(np.kron(np.diag(self._mu * scale), np.ones((1, 2))))
        most = 4 * self._mu * largest * scale
        self._add([(1, -bound), (2, scale)], none, 0 * ones)
        self._add([(1, bound), (2, scale)], 0 * ones, -none)
        self._add([(1, bound), (2, scale), (4, most)], none, most)
        self._add([(1, -bound), (2, scale), (5, -most)], -most, -none)
