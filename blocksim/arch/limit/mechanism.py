"""The collapse mechanism, from the complementary problem of eqs (15) and (16).

At every joint four strength conditions bound the resultant (see `statics`),

    M - (eta/2) N <= 0,   -M - (eta/2) N <= 0,   T - mu N <= 0,   -T - mu N <= 0,

and to each belongs a rate, never negative: opening about the extrados, about the intrados,
sliding either way. In the unknowns x of the statics they read A x + b <= 0. The linear
program

    minimise s  subject to  A x + b <= s

asks for the least extra strength s, the same at every joint, with which the arch would
stand. Its dual holds the rates: they are compatible (A' rates = 0, the pieces fit
together again), add up to one, and vanish wherever a condition is not met exactly. At the
least thickness s = 0 and this is eq. (15); below it s > 0 is the power that weight has
to spare, above it s < 0 and nothing moves.

Sliding here is *associated*: a rate of sliding comes with an opening of mu times as much,
since that is what the dual of the condition |T| <= mu N says. Coulomb sliding does not
open the joint. The two share every state of stress, so the static answer (does an
equilibrium exist) is the same; where an arch slides its velocities differ, and Coulomb
friction may let an arch move that has an equilibrium. Modes without sliding are the same
in both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.arch.circular import Arch, crown_width
from blocksim.arch.modes import ActiveJoint, Mode, name_mode
from blocksim.blocks.assembly import Array
from blocksim.common.checks import ANY_FRICTION
from blocksim.limit.linear import LinearProgramme

ACTIVE = 1e-9
"""Rates, and distances to a condition, below which HiGHS means zero."""
AT_LIMIT = 1e-10
"""Extra strength below which the arch is at its least thickness."""
SPARE = 1.0
"""Strength to spare looked for at most: a flat arch has any amount at a great thrust."""
CLOSER = 1e-6
"""Unit in which the program is solved the second time."""
WIDER = 1e-6
"""Share by which joints are wider and rougher in a motion that rounding cannot close."""
CONDITIONS = ("hinge-extrados", "hinge-intrados", "slides-out", "slides-in")
"""Order of the columns of `Mechanism.strength` and `Mechanism.rates`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Collapse:
    """A symmetric mechanism.

    `angles`, (k,): Joints from the left springing to the right one, all or those that are
        active [rad].
    `rates`, (k, 4): Rates of opening and of sliding, in the order of `CONDITIONS`, which add up
        to one; all 0 where it stands.
    `motions`, (k - 1, 3): Velocity of each piece between them, with associated sliding: of its
        point at the centre of the arch (to the right, upwards) and its rotation
        (counter-clockwise), r = 1.
    """

    angles: Array
    rates: Array
    motions: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Mechanism(Collapse):
    """Statics and kinematics of an arch of n voussoirs at or below its least thickness.

    `extra_strength`: s, in units of gamma t d r^2; 0 at the least thickness, below 0 where it
        stands.
    `strength`, (n + 1, 4): Left sides of the strength conditions less s, in the order of
        `CONDITIONS`.
    `thrust`, `crown_moment`: Scaled resultant at the crown: h, and its moment m about the
        centre.
    `mode`: Collapse mode at this thickness, which far below the least need not be that at the
        least; None where it stands or the joints form none of the seven.
    """

    extra_strength: float
    strength: Array
    thrust: float
    crown_moment: float
    mode: Mode | None

    @property
    def active(self) -> NDArray[np.bool_]:
        """Which conditions move, (n + 1, 4)."""
        return _moving(self.rates)


@dataclass(frozen=True, kw_only=True, eq=False)
class Conditions:
    """Conditions A x + b <= 0 at some joints, four rows a joint."""

    matrix: Array
    offset: Array


def mechanism(arch: Arch, mu: float) -> Mechanism:
    """Find statics and collapse mechanism of an arch (15), (16), symmetric as in the paper."""
    ANY_FRICTION.require("mu", mu)
    half = arch.joint_angles[arch.joint_angles >= 0]
    program = conditions(half, arch.eta, mu, arch.centroid_factor)
    state, extra, rates = solve(program)
    if extra < -AT_LIMIT:
        rates = np.zeros_like(rates)
    strength = (program.matrix @ state + program.offset - extra).reshape(-1, 4)
    found = of_half(half, rates.reshape(-1, 4), arch.eta, mu)
    return Mechanism(
        **vars(found),
        extra_strength=extra,
        strength=both_halves(half, strength)[1],
        thrust=float(state[0]),
        crown_moment=float(state[1]),
        mode=mode_of(
            found.angles, _moving(found.rates), crown_width(arch.half_angle, arch.voussoirs)
        ),
    )


def opening(arch: Arch, mu: float, found: Mechanism) -> tuple[Array, list[int]]:
    """Return a motion near a mechanism, in which joints open by more than round-off.

    It is that of joints a little wider and rougher.

    `found`: Of the same arch and friction.
    Returns `rates`, (n, 3): Velocity of the centre of each voussoir, and rotation, r = 1;
        `owner`: Of each the piece it moves with, -1 where it stays at rest.
    """
    half, kept = found.angles[found.angles >= 0], found.rates[found.angles >= 0]
    rates = (kept * np.where(half == 0, 1.0, 2.0)[:, None]).ravel()
    eta, rough, moving = arch.eta * (1 + WIDER), mu * (1 + WIDER), rates > 0
    matrix = conditions(half, eta, rough, arch.centroid_factor).matrix[moving]
    rates[moving] -= np.linalg.lstsq(matrix.T, matrix.T @ rates[moving], rcond=None)[0]
    motions = of_half(half, rates.reshape(-1, 4), eta, rough).motions
    moves = found.rates.max(axis=1) > 0
    parted = np.cumsum(moves[:-1])
    owner = np.where((parted == parted[-1]) & ~moves[-1], 0, parted) - 1
    arms = arch.voussoir_centres
    across = np.column_stack([-arms[:, 1], arms[:, 0]]) * motions[:, 2:]
    return np.column_stack([motions[:, :2] + across, motions[:, 2]]), owner.tolist()


def conditions(angles: Array, eta: float, mu: float, factor: float) -> Conditions:
    """Write the conditions in h and m, at joints of one half."""
    sine, cosine, zero = np.sin(angles), np.cos(angles), np.zeros(angles.size)
    force, force_offset = np.column_stack([cosine, zero]), angles * sine
    shear, shear_offset = np.column_stack([sine, zero]), -angles * cosine
    moment = np.column_stack([zero, zero + 1.0]) - force
    moment_offset = factor * (1.0 - cosine) - force_offset
    depth = eta / 2
    # At infinite friction the conditions on T become -1 <= 0.
    grip, push, idle = (mu, 1.0, 0.0) if np.isfinite(mu) else (0.0, 0.0, 1.0)
    rows = [
        moment - depth * force,
        -moment - depth * force,
        push * shear - grip * force,
        -push * shear - grip * force,
    ]
    offsets = [
        moment_offset - depth * force_offset,
        -moment_offset - depth * force_offset,
        push * shear_offset - grip * force_offset - idle,
        -push * shear_offset - grip * force_offset - idle,
    ]
    matrix = np.stack(rows, axis=1).reshape(-1, 2)
    return Conditions(matrix=matrix, offset=np.stack(offsets, axis=1).reshape(-1))


def solve(program: Conditions) -> tuple[Array, float, Array]:
    """Solve the program: unknowns x, value s (zero at the least thickness), rates."""
    # HiGHS works to 1e-7, which is a thin arch's whole strength: once more, from near.
    state, rates = _optimum(program, np.append(0.0 * program.matrix[0], 0.0), 1.0)
    if state[-1] > -SPARE / 2:
        state, rates = _optimum(program, state, CLOSER)
    if state[-1] <= -SPARE / 2:
        return state[:-1], float(state[-1]), np.zeros_like(rates)
    matrix = np.column_stack([program.matrix, np.full(rates.size, -1.0)])
    # The active set is right, and fulfilled here to the last bits.
    moving = rates > 0
    for _ in range(2):
        left = matrix[moving] @ state + program.offset[moving]
        state = state - np.linalg.lstsq(matrix[moving], left, rcond=None)[0]
        unbalanced = matrix[moving].T @ rates[moving]
        unbalanced[-1] += 1.0
        rates[moving] -= np.linalg.lstsq(matrix[moving].T, unbalanced, rcond=None)[0]
    return state[:-1], float(state[-1]), rates


def _optimum(program: Conditions, about: Array, unit: float) -> tuple[Array, Array]:
    """Let HiGHS solve the program in unknowns counted from `about` in a unit: (x, s), rates."""
    rows, unknowns = program.matrix.shape
    matrix = np.column_stack([program.matrix, np.full(rows, -1.0)])
    right = -(matrix @ about + program.offset) / unit
    high = np.full(unknowns + 1, math.inf)
    low = -high
    low[-1] = (-SPARE - about[-1]) / unit
    cost = np.append(np.zeros(unknowns), 1.0)
    found = LinearProgramme().solve(
        cost,
        matrix,
        (np.full(len(right), -math.inf), right),
        (low, high),
    )
    if not found.exists:
        raise RuntimeError("HiGHS found no optimum")
    rates: Array = np.maximum(-found.prices, 0.0)
    rates[rates < ACTIVE] = 0.0
    return about + unit * found.values, rates


def motions_of(angles: Array, rates: Array, eta: float, mu: float) -> Array:
    """Velocities of the voussoirs: relative motions at the joints, added up."""
    sine, cosine = np.sin(angles), np.cos(angles)
    along = np.column_stack([cosine, -sine])
    outward = np.column_stack([sine, cosine])
    turn = rates[:, 0] - rates[:, 1]
    slide = (rates[:, 2] - rates[:, 3]) * np.where(angles < 0, -1.0, 1.0)
    grip = mu if np.isfinite(mu) else 0.0
    opening = eta / 2 * (rates[:, 0] + rates[:, 1]) + grip * (rates[:, 2] + rates[:, 3])
    # The voussoir after a joint against the one before, at the centreline; then moved to
    # the centre of the arch, which a rotation carries along the joint.
    centre = (opening + turn)[:, None] * along - slide[:, None] * outward
    return np.cumsum(np.column_stack([centre, turn]), axis=0)[:-1]


def _moving(rates: Array) -> NDArray[np.bool_]:
    return rates > ACTIVE * max(float(rates.max()), ACTIVE)


def mode_of(angles: Array, moving: NDArray[np.bool_], crown: float) -> Mode | None:
    """Name the mode of the conditions that move at some joints, (joints, 4)."""
    active = [
        ActiveJoint(abs(float(angles[joint])), slides=kind >= 2, intrados=kind == 1)
        for joint, kind in np.argwhere(moving).tolist()
    ]
    return name_mode(active, crown) if active else None


def both_halves(angles: Array, values: Array) -> tuple[Array, Array]:
    """Return the joints of the whole arch, and what is said of each of them, from one half.

    The half begins at the crown, whether a joint is there or not.
    """
    kept = slice(None, 0, -1) if angles[0] == 0 else slice(None, None, -1)
    return np.concatenate([-angles[kept], angles]), np.concatenate([values[kept], values])


def of_half(angles: Array, rates: Array, eta: float, mu: float) -> Collapse:
    """Return the mechanism of a whole arch from the rates of one half of it."""
    # Each joint of it stood for two, but for one at the crown.
    every, both = both_halves(angles, rates * np.where(angles == 0, 1.0, 0.5)[:, None])
    return Collapse(angles=every, rates=both, motions=motions_of(every, both, eta, mu))
