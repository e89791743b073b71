"""One linear programme for any assembly: contact forces, load factor, and the mechanism.

Each end of a joint carries a force within its cone of friction, and all forces balance the
loads. By the static theorem of limit analysis an assembly can rest where such forces exist
(Drucker 1954; Livesley 1978). The dual of the programme is the mechanism: the rates at which
blocks begin to move where none exist, in which joints that slide dilate (associated flow).
Coulomb's law, which does not dilate, may allow blocks to move that could rest.

Lengths are scaled by the assembly's size and forces by the mean weight before they are
solved: with a drawing in millimetres the solver would call wrong answers optimal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack
from scipy.sparse.linalg import lsmr

from blocksim.blocks.assembly import PLANAR, SUPPORT, Array
from blocksim.blocks.problem import Problem

SPARE = 1.0
"""Most that is asked for along every edge of a cone [mean weights]."""
TENSION = 1e3
"""Most that every edge may lack [mean weights]."""
FINEST = 1e-10
"""HiGHS's own least tolerance."""
ROUND_OFF = 1e-9
"""Lack of force that is round-off [mean weights]."""
MANY = 1000
"""Edges of cones from which the interior point is faster than the simplex."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Equilibrium:
    """Whether forces of equilibrium exist, and how well they fit into the joints.

    Parameters
    ----------
    margin : float
        The least part along any edge of a cone of friction, made as large as it can be
        (at most `SPARE`) [mean weights]. Below 0 by more than round-off there is no
        equilibrium: contacts would have to pull by that much. -inf where not even that
        would hold the blocks.
    forces : (joints, 2, 2) float or None
        At the inner and the outer end of each joint, along its normal and its tangent, as
        they act on the block after it [mean weights]. None where there is no equilibrium.
    mechanism : (blocks, 3) float or None
        Rates x, y and rotation of a mechanism that the loads drive; None where they are
        balanced.
    """

    margin: float
    forces: Array | None
    mechanism: Array | None

    @property
    def exists(self) -> bool:
        """Whether the blocks can rest."""
        return self.forces is not None


@dataclass(frozen=True, kw_only=True, eq=False)
class Collapse:
    """The largest factor on the live loads at which forces of equilibrium exist.

    Parameters
    ----------
    load_factor : float or None
        None where there is no equilibrium at any factor; inf where no live load is too much.
    forces : (joints, 2, 2) float or None
        At collapse; as of `Equilibrium`.
    mechanism : (blocks, 3) float or None
        Rates x, y and rotation as the blocks begin to move, the largest of them 1.
    """

    load_factor: float | None
    forces: Array | None
    mechanism: Array | None


def equilibrium(problem: Problem) -> Equilibrium:
    """Find forces of equilibrium, as far inside their cones of friction as they can all be.

    Each force is a sum of parts along the two edges of its cone, and the least of all these
    parts is made as large as it can be.

    Parameters
    ----------
    problem : Problem
        In its plane.

    Returns
    -------
    Equilibrium
    """
    cones = _Cones(problem)
    # What all parts have in common comes last.
    common = csc_array(cones.balance @ cones.bounded[:, None])
    found = _most(cones, common, -cones.loads(problem.pull()), (-TENSION, SPARE))
    if found.x is None or not found.success:
        return Equilibrium(margin=-math.inf, forces=None, mechanism=None)
    margin = float(found.x[-1])
    if margin < -ROUND_OFF:
        mechanism = _scaled(cones.rates(found))
        return Equilibrium(margin=margin, forces=None, mechanism=mechanism)
    parts = cones.polished(found.x[:-1] + margin * cones.bounded, problem.pull())
    return Equilibrium(margin=margin, forces=cones.forces(parts), mechanism=None)


def collapse(problem: Problem) -> Collapse:
    """Find the largest factor on the live loads at which forces of equilibrium exist.

    The problem's own load factor does not matter.

    Parameters
    ----------
    problem : Problem
        In its plane, with live loads.

    Returns
    -------
    Collapse
    """
    cones = _Cones(problem)
    live = sum((problem.of_load(load) for load in problem.live), np.zeros(cones.shape))
    dead = problem.with_load(0.0).pull()
    column = csc_array(cones.loads(live)[:, None])
    found = _most(cones, column, -cones.loads(dead), (None, None))
    if found.status == UNBOUNDED:
        return Collapse(load_factor=math.inf, forces=None, mechanism=None)
    if found.x is None or not found.success:
        return Collapse(load_factor=None, forces=None, mechanism=None)
    return Collapse(
        load_factor=float(found.x[-1]),
        forces=cones.forces(found.x[:-1]),
        mechanism=_scaled(cones.rates(found)),
    )


def settling(problem: Problem, supports: Array) -> Array | None:
    """Find how blocks at rest follow supports that begin to move.

    Of the motions that no joint forbids it is the one that loses most potential energy; its
    dual are the forces of equilibrium that do least work on the supports, as the least thrust
    of an arch on spreading supports (Heyman 1966).

    Parameters
    ----------
    problem : Problem
        In its plane, at rest.
    supports : (supports, 3) float
        Velocities x, y of each support where it meets the origin of coordinates, and its
        rate of rotation; lengths in units of the size.

    Returns
    -------
    (blocks, 3) float or None
        Velocities x, y and rotation of the blocks; None where there is no equilibrium.
    """
    cones = _Cones(problem)
    solve: Any = linprog
    found = solve(
        cones.at_supports(supports),
        A_eq=cones.balance,
        b_eq=-cones.loads(problem.pull()),
        bounds=cones.bounds,
        method="highs",
        options={"primal_feasibility_tolerance": FINEST, "dual_feasibility_tolerance": FINEST},
    )
    return cones.rates(found) if found.x is not None and found.success else None


def falling(problem: Problem) -> Array | None:
    """Find the motion that no joint forbids in which the loads do most work.

    Parameters
    ----------
    problem : Problem
        In its plane, at rest.

    Returns
    -------
    (blocks, 3) float or None
        Velocities x, y (in units of the size) and rotation, each at most 1; None where the
        loads do no work in any.
    """
    cones = _Cones(problem)
    pull = cones.loads(problem.pull())
    # Rates at contacts: what presses may part, what only rubs stays.
    parts, rows = cones.bounded > 0, cones.balance.T.tocsr()
    solve: Any = linprog
    found = solve(
        -pull,
        A_ub=-rows[parts],
        b_ub=np.zeros(int(parts.sum())),
        A_eq=rows[~parts] if (~parts).any() else None,
        b_eq=np.zeros(int((~parts).sum())) if (~parts).any() else None,
        bounds=(-1.0, 1.0),
        method="highs",
        options={"primal_feasibility_tolerance": FINEST, "dual_feasibility_tolerance": FINEST},
    )
    if not found.success or -found.fun < ROUND_OFF:
        return None
    return np.asarray(found.x).reshape(cones.shape) * cones.ease


def _most(cones: _Cones, column: Any, right: Array, bounds: tuple[float | None, ...]) -> Any:
    """Make the factor on a column as large as the balance of forces allows."""
    # Of many joints the interior point is three to ten times faster, and as exact: its
    # answer is brought to a vertex. It does not tell whether nothing limits the factor.
    if cones.count > MANY:
        found = _solve("highs-ipm", cones, column, right, bounds)
        if found.success:
            return found
    return _solve("highs", cones, column, right, bounds)


def _solve(
    method: str, cones: _Cones, column: Any, right: Array, bounds: tuple[float | None, ...]
) -> Any:
    solve: Any = linprog
    return solve(
        np.append(np.zeros(cones.count), -1.0),
        A_eq=hstack([cones.balance, column]),
        b_eq=right,
        bounds=[*cones.bounds, bounds],
        method=method,
        options={"primal_feasibility_tolerance": FINEST, "dual_feasibility_tolerance": FINEST},
    )


UNBOUNDED = 3
"""Status by which `linprog` says that nothing limits the factor."""


def _scaled(rates: Array) -> Array:
    """Rates of the blocks whose largest is 1."""
    largest = float(np.abs(rates).max())
    return rates / largest if largest > 0 else rates


class _Cones:
    """Edges of the cones of friction at all ends of joints, and what their forces do.

    A cone of finite friction has two edges, one without friction has one; unbounded
    friction leaves a normal part that presses and a tangential one that is free.
    """

    def __init__(self, problem: Problem) -> None:
        assembly, joints = problem.assembly, problem.assembly.joint_arrays
        self._joints = len(assembly.joints)
        self.shape = (len(assembly.blocks), PLANAR)
        # What nothing can turn (half a keystone on its plane) bears any moment.
        self.ease = np.ones(self.shape)
        self.ease[:, 2] = 1 / np.maximum(1.0, assembly.masses[:, 2])
        mu = np.repeat(problem.friction, 2)
        ends = np.arange(2 * self._joints)
        finite, rough = ends[np.isfinite(mu)], ends[(mu > 0) & np.isfinite(mu)]
        boundless = ends[np.isinf(mu)]
        # Steep edges are scaled, or their normal parts would fade.
        upright = 1 / np.maximum(1.0, np.where(np.isfinite(mu), mu, 0.0))
        along = np.where(np.isfinite(mu), mu, 0.0) * upright
        self._end = np.concatenate([finite, rough, boundless, boundless])
        ones = np.ones(len(boundless))
        self._normal = np.concatenate([upright[finite], upright[rough], ones, 0 * ones])
        self._tangent = np.concatenate([along[finite], -along[rough], 0 * ones, ones])
        self.count = len(self._end)
        free = self.count - len(boundless)
        self.bounded = np.where(np.arange(self.count) < free, 1.0, 0.0)
        self._joint = self._end // 2
        direction = (
            self._normal[:, None] * joints.normal[self._joint]
            + self._tangent[:, None] * joints.tangent[self._joint]
        )
        self._direction = direction
        self._point = point = joints.ends.reshape(-1, 2)[self._end]
        # Where each part meets a support: which, and in which sense it acts on it.
        which = [-1 if each.support is None else each.support for each in assembly.joints]
        self._support = np.array(which, dtype=np.int64)[self._joint]
        on_after = (joints.after == SUPPORT)[self._joint]
        on_before = (joints.before == SUPPORT)[self._joint]
        self._sense = on_after.astype(np.float64) - on_before
        # The support comes last, as index -1 says, and is left out in the end.
        centres = np.vstack([assembly.centres / assembly.size, np.zeros(2)])
        rows: list[NDArray[np.int64]] = []
        values: list[Array] = []
        for sign, block in ((1.0, joints.after), (-1.0, joints.before)):
            mine = block[self._joint]
            arm = point - centres[mine]
            turn = arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]
            part = sign * np.column_stack([direction, turn])
            part *= np.vstack([self.ease, np.zeros(PLANAR)])[mine]
            rows.append(PLANAR * np.maximum(mine, 0)[:, None] + np.arange(PLANAR))
            values.append(part)
        columns = np.repeat(np.arange(self.count), PLANAR)
        self.balance = csc_array(
            (
                np.concatenate([each.ravel() for each in values]),
                (
                    np.concatenate([each.ravel() for each in rows]),
                    np.concatenate([columns, columns]),
                ),
            ),
            shape=(PLANAR * self.shape[0], self.count),
        )

    @cached_property
    def bounds(self) -> list[tuple[float | None, float | None]]:
        """Parts press; what is tangential only may have any sign."""
        return [(0.0, None) if each else (None, None) for each in self.bounded]

    def loads(self, pull: Array) -> Array:
        """Return loads on the blocks as the balance has them, in one row."""
        return (pull * self.ease).ravel()

    def at_supports(self, velocities: Array) -> Array:
        """Return at which rate each part works on supports that move, (parts,)."""
        still = np.vstack([velocities, np.zeros(PLANAR)])[self._support]
        x, y = self._point.T
        way = np.column_stack([still[:, 0] - still[:, 2] * y, still[:, 1] + still[:, 2] * x])
        return self._sense * (way * self._direction).sum(axis=1)

    def rates(self, found: Any) -> Array:
        """Return the rates of the blocks that an answer has as its dual, (blocks, 3)."""
        return -np.asarray(found.eqlin.marginals).reshape(self.shape) * self.ease

    def polished(self, parts: Array, pull: Array) -> Array:
        """Take away the imbalance the solver leaves, by the least change of what presses."""
        left = -self.loads(pull) - self.balance @ parts
        held = np.flatnonzero((parts > 1.0) | (self.bounded == 0))
        if np.abs(left).max() < ROUND_OFF or not len(held):
            return parts
        solve: Any = lsmr
        change = solve(self.balance[:, held], left, atol=1e-14, btol=1e-14)[0]
        better = parts.copy()
        better[held] += change
        worst = np.abs(-self.loads(pull) - self.balance @ better).max()
        return better if worst < np.abs(left).max() else parts

    def forces(self, parts: Array) -> Array:
        """Sum parts to forces at the ends of joints, shape (joints, 2, 2)."""
        found = np.zeros((2 * self._joints, 2))
        np.add.at(
            found, self._end, np.column_stack([self._normal, self._tangent]) * parts[:, None]
        )
        return found.reshape(-1, 2, 2)
