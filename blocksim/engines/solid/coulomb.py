"""One step of blocks in space: unilateral contact and Coulomb's friction, round cones.

For x, the accelerations of the blocks, scaled by the roots of their masses, and p, the forces,

    x = f + H^T p,    u = H x + w,    0 <= p_n  _|_  u_n >= 0,    |p_t| <= mu p_n, against u_t,

where u are velocities at the points of contact at the end of the step over its length. Slip
opens nothing.

A solution is looked for by Newton's method on springs that follow it: p is the point of the
friction cone that is nearest, across its axis, to p - r u, with stiff springs r. From nothing
forces come from a cone programme in which slip opens by mu times itself: of rest and motion,
where Coulomb's law allows both, that is rest. Else they are the end of a path (`path`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import Array
from blocksim.common.conic import Cone, solved_cones
from blocksim.engines.solid.path import ROUNDED, followed
from blocksim.engines.solid.step import (
    Answer,
    Step,
    on_diagonal,
    projected,
    rows_of,
    solved,
)

STIFF = 1e5
"""Springs over the mean mass."""
ROUNDS, TRIES = 25, 60
"""Most times that springs follow, and most of Newton's steps for each."""
AT_ONCE = 6
"""The same where forces of the last step may do."""
HALVINGS = 6
UNSOLVED = 1e-4
"""Residual of what is no solution."""
SOLVED, ENOUGH = 1e-9, 3e-8
"""Residual of a solution from nothing, and of one in motion."""
FINEST = 1e-10
"""Gap and residuals at which a cone programme may end."""
LESS = 0.9997
"""Share of friction that is taken where that much did not tell."""
NEAR = 1e-2
"""Smoothing with which a path begins at the forces of the last step."""
AT_REST = 1e-9
"""Velocity over the step of blocks at rest, which a path might set in motion."""
EXACT = 1e-13
"""Residual at which nothing is left to do."""


def solve(step: Step, forces: Array | None) -> Answer:
    """Solve a step, from forces close by or from nothing.

    Parameters
    ----------
    step : Step
    forces : (points, 3) float or None
    """
    if not len(step.friction):
        return Answer(step.free, np.zeros((0, 3)), 0.0)
    best: Answer | None = None
    if forces is not None:
        best = _followed(step, forces, AT_ONCE)
        if best.residual <= ENOUGH:
            return best
    for guess in _guesses(step, forces):
        found = _followed(step, guess)
        if best is None or found.residual < best.residual:
            best = found
        if best.residual <= (SOLVED if forces is None else ENOUGH):
            break
    assert best is not None  # noqa: S101
    return best if best.residual <= UNSOLVED else _as_last_resort(step, best)


def _as_last_resort(step: Step, best: Answer) -> Answer:
    """Return the solution of friction that dilates: in balance, and gaining no energy.

    Its residual says how far it is from Coulomb's law.
    """
    forces = dilating(step)
    if forces is None:
        return best
    x = step.pushed_by(forces)
    return Answer(x, forces, max(best.residual, step.residual(x, forces)))


def _guesses(step: Step, forces: Array | None) -> Iterator[Array]:
    """Give forces to begin with, the likeliest and cheapest first."""
    moves = float(np.abs(step.drift).max()) > AT_REST
    if forces is not None and moves:
        near = followed(step, ROUNDED[0], forces, NEAR)
        yield forces if near is None else near
    opening = dilating(step)
    if opening is not None:
        yield opening
        # Of rest near its limit the forces lie on the cones; with less friction within.
        less = dilating(replace(step, friction=LESS * step.friction))
        if less is not None:
            yield less
    for rounded in ROUNDED:
        smoothed = followed(step, rounded)
        if smoothed is not None:
            yield smoothed


def _followed(step: Step, forces: Array, most: int = TRIES) -> Answer:
    """Let springs follow forces until these are the solution, or come no nearer."""
    p = forces
    x = step.pushed_by(p)
    best = Answer(x, p, step.residual(x, p))
    stiff, worse = STIFF, 0
    for _ in range(ROUNDS):
        x, p, left = _balanced(step, x, p, stiff, most)
        if not np.isfinite(p).all():
            return best
        found = Answer(x, p, step.residual(x, p))
        worse = worse + 1 if found.residual > 0.3 * best.residual else 0
        if found.residual < best.residual:
            best = found
        if best.residual <= EXACT or worse > 2 or (most < TRIES and left):
            break
    return best


def _balanced(
    step: Step, x: Array, forces: Array, stiff: float, most: int
) -> tuple[Array, Array, bool]:
    """Find accelerations that balance springs which begin with forces, by Newton's method.

    And the forces, and whether it had to be left before it got there.
    """
    scale = 1.0 + float(np.abs(step.free).max(initial=0.0))
    left, q, pushed = _imbalance(step, x, forces, stiff)
    size = float(np.abs(left).max())
    for _ in range(most):
        if size <= 1e-15 * scale * (1 + float(np.abs(q).max())):
            return x, q, False
        change = _newton(step, pushed, left, stiff)
        if change is None:
            return x, q, True
        share: float = 1.0
        best: tuple[float, Array, tuple[Array, Array, Array]] | None = None
        for _ in range(HALVINGS):
            tried: Array = x + share * change
            there = _imbalance(step, tried, forces, stiff)
            reached = float(np.abs(there[0]).max())
            if best is None or reached < best[0]:
                best = (reached, tried, there)
            if reached < (1 - 0.25 * share) * size:
                break
            share /= 2
        assert best is not None  # noqa: S101
        if best[0] >= 0.999 * size and size < 1e-11 * scale:
            return x, q, False
        size, x, (left, q, pushed) = best
    return x, q, True


def _imbalance(step: Step, x: Array, forces: Array, stiff: float) -> tuple[Array, Array, Array]:
    """Return what is left over, the forces within friction, and what springs ask for."""
    pushed = forces - stiff * step.velocities(x)
    q = projected(pushed, step.friction)
    return x - step.free - step.matrix.T @ q.ravel(), q, pushed


def _newton(step: Step, pushed: Array, left: Array, stiff: float) -> Array | None:
    """Return Newton's step of the accelerations."""
    closed = np.flatnonzero(pushed[:, 0] > 0)
    size = len(left)
    system = sparse.identity(size, format="csc")
    if len(closed):
        tau, mu = pushed[closed], step.friction[closed]
        across = np.hypot(tau[:, 1], tau[:, 2])
        slides = across > mu * tau[:, 0]
        blocks = np.broadcast_to(np.eye(3), (len(closed), 3, 3)).copy()
        if slides.any():
            way = tau[slides, 1:] / across[slides, None]
            share = mu[slides] * tau[slides, 0] / across[slides]
            turn = np.eye(2) - way[:, :, None] * way[:, None]
            blocks[slides, 1:, 1:] = share[:, None, None] * turn
            blocks[slides, 1:, 0] = mu[slides, None] * way
        rows = step.matrix[rows_of(closed)]
        system = system + stiff * (rows.T @ (on_diagonal(blocks) @ rows))
    return solved(system, -left)


def dilating(step: Step) -> Array | None:
    """Return forces of friction that dilates: a cone programme, and rest if there is any."""
    points, size = len(step.friction), step.matrix.shape[1]
    mu = step.friction
    round_ = np.flatnonzero(mu > 0)
    smooth = np.flatnonzero(mu <= 0)
    # (u_n + mu slip, mu u_t) in the cone of the second order.
    scale = np.ones((points, 3))
    scale[:, 1:] = mu[:, None]
    order = np.concatenate([rows_of(round_), 3 * smooth])
    factor = scale.ravel()[order]
    rows = -(sparse.diags(factor) @ step.matrix[order])
    right = factor * step.drift[order]
    cones: list[Cone] = [("second-order", 3)] * len(round_)
    if len(smooth):
        cones.append(("nonnegative", len(smooth)))
    inertia = sparse.identity(size, format="csc")
    found = solved_cones(inertia, -step.free, rows.tocsc(), right, cones, finest=FINEST)
    z = np.array(found.z)
    if not np.isfinite(z).all():
        return None
    forces = np.zeros(3 * points)
    forces[order] = factor * z
    return projected(forces.reshape(-1, 3), mu)
