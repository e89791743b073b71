"""One step of blocks in space: unilateral contact and Coulomb's friction, round cones.

For x, the accelerations of the blocks, scaled by the roots of their masses, and p, the forces,

    x = f + H^T p,    u = H x + w,    0 <= p_n  _|_  u_n >= 0,    |p_t| <= mu p_n, against u_t,

where u are velocities at the points of contact at the end of the step over its length. Slip
opens nothing.

A solution is looked for by Newton's method on springs that follow it: p is the point of the
friction cone that is nearest, across its axis, to p - r u, with stiff springs r. They begin
with what contacts did in the last step, or with forces of a cone programme, in which slip opens
by mu times itself, less a guess of that. From nothing no slip is guessed: of rest and motion,
where Coulomb's law allows both, that finds rest. Where neither tells they begin
where a path leads (`path`): beyond the limit of rest, and where wedges jam.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.dilation import IN_MOTION, dilating
from blocksim.engines.solid.path import STEPS, followed
from blocksim.engines.solid.step import Answer, Step, projected, slip_of

STIFF = 1e5
"""Springs over the mean mass."""
STIFFER = 1e2, 1e3, 1e4, STIFF
"""The same in turn from a guess: soft ones are not lost near the limit, or where blocks jam."""
ROUNDS, TRIES = 25, 60
"""Most times that springs follow, and most of Newton's steps for each."""
BRIEFLY = 25
"""Most of Newton's steps in motion, where another guess costs as much."""
HALVINGS = 6
LAWFUL = 3e-6
"""Residual in motion that will do where contacts did not go on as they did."""
UNSOLVED = 1e-2
"""Residual of what is no solution."""
NEAR = 1e-3
"""Residual of forces of the last step from which blocks at rest go on; else from nothing."""
SOLVED, ENOUGH = 1e-9, 3e-8
"""Residual of a solution from nothing, and of one in motion."""
LESS = 0.9997
"""Share of friction that is taken where that much did not tell."""
RESTS = 1e-5
"""Acceleration by a cone programme below which blocks may rest."""
AT_REST = 1e-6
"""Velocity over the step of blocks at rest."""
EXACT = 1e-13
"""Residual at which nothing is left to do."""
FINELY, ROUGHLY = 1e-15, 1e-10
"""Imbalance over the forces at which Newton's method may end, from nothing and in motion."""


def solve(step: Step, last: Array | None, most: int = STEPS) -> Answer:
    """Solve a step, from what was found in the last one or from nothing.

    `last`, (points, 3): Forces.
    `most`: Most steps along the path, where nothing else leads to a solution.
    """
    if not len(step.friction):
        return Answer(step.free, np.zeros((0, 3)), 0.0)
    with step.bands.one_thread():
        return _solved(step, last, most)


def _solved(step: Step, last: Array | None, most: int) -> Answer:
    """Do the same, where there are points of contact."""
    moves = last is not None
    # At rest what is left over would add up.
    briefly = moves and float(np.abs(step.drift).max()) > AT_REST
    best, enough = Answer(step.free, np.zeros_like(step.drift), np.inf), SOLVED
    near = last is None
    if last is not None:
        enough = ENOUGH
        x = step.pushed_by(last)
        best = Answer(x, last, step.residual(x, last))
        near = briefly or best.residual <= NEAR
        if near:
            found = _gone_on(step, last, briefly=briefly)
            best = found if found.residual < best.residual else best
    guesses = _guesses(step, most, briefly=briefly) if best.residual > enough else ()
    enough = LAWFUL if briefly else enough
    for guess, springs in guesses:
        forces = guess
        for stiff in springs:
            found = _followed(step, forces, stiff=stiff, briefly=briefly)
            forces = found.forces
            if found.residual < best.residual:
                best = found
            if best.residual <= enough:
                return best
    if last is not None and not near and best.residual > enough:
        found = _followed(step, last)
        best = found if found.residual < best.residual else best
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


def _guesses(
    step: Step, most: int, *, briefly: bool
) -> Iterator[tuple[Array, tuple[float, ...]]]:
    """Give forces to begin with, the likeliest and cheapest first, and springs for each."""
    if briefly:
        opening = dilating(step, slip_of(step.drift), IN_MOTION)
        every, rests = STIFFER, False
    else:
        opening = dilating(step)
        every = STIFF, *STIFFER
        rests = opening is None or float(np.abs(step.pushed_by(opening)).max()) < RESTS
    if opening is not None:
        yield opening, every if rests or briefly else (STIFF,)
    if rests:
        # Near the limit of rest the forces lie on the cones; with less friction within.
        less = dilating(replace(step, friction=LESS * step.friction))
        if less is not None:
            yield less, every
    for forces in followed(step, most):
        yield forces, every


def _gone_on(step: Step, p: Array, *, briefly: bool) -> Answer:
    """Let springs follow from forces of the last step and, in motion, from its velocities.

    What closes, sticks and slides there is taken to do so still, which stiff springs would not
    see where forces and accelerations do not quite match.
    """
    u = step.drift.copy()
    u[p[:, 0] > 0, 0] = 0.0
    given = _given_way(p - STIFF * u, step.friction)
    held = p + STIFF * np.einsum("pij,pj->pi", given, u - step.drift)
    x = step.with_springs(STIFF * given, step.pushed_by(held))
    return _followed(step, p, x, briefly=briefly)


def _followed(
    step: Step,
    forces: Array,
    x: Array | None = None,
    *,
    stiff: float = STIFF,
    briefly: bool = False,
) -> Answer:
    """Let springs follow forces until these are the solution, or come no nearer."""
    p = forces
    if x is None:
        x = step.pushed_by(p)
    best = Answer(x, p, step.residual(x, p))
    worse, exact = 0, ENOUGH if briefly else EXACT
    for _ in range(ROUNDS):
        x, p, left = _balanced(step, x, p, stiff, briefly=briefly)
        if not np.isfinite(p).all():
            return best
        found = Answer(x, p, step.residual(x, p))
        worse = worse + 1 if found.residual > 0.3 * best.residual else 0
        if found.residual < best.residual:
            best = found
        if best.residual <= exact or worse > 2 or (briefly and left):
            break
    return best


def _balanced(
    step: Step, x: Array, forces: Array, stiff: float, *, briefly: bool
) -> tuple[Array, Array, bool]:
    """Find accelerations that balance springs which begin with forces, by Newton's method.

    And the forces, and whether it had to be left before it got there.
    """
    scale = 1.0 + float(np.abs(step.free).max(initial=0.0))
    left, q, pushed = _imbalance(step, x, forces, stiff)
    size = float(np.abs(left).max())
    for _ in range(BRIEFLY if briefly else TRIES):
        if size <= (ROUGHLY if briefly else FINELY) * scale * (1 + float(np.abs(q).max())):
            return x, q, False
        change = step.with_springs(stiff * _given_way(pushed, step.friction), -left)
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
    return x - step.pushed_by(q), q, pushed


def _given_way(pushed: Array, friction: Array) -> Array:
    """Return how forces change with what springs ask for, (points, 3, 3); 0 where open."""
    across = np.hypot(pushed[:, 1], pushed[:, 2])
    found = (pushed[:, 0] > 0)[:, None, None] * np.eye(3)
    slides = (across > friction * pushed[:, 0]) & (pushed[:, 0] > 0)
    if slides.any():
        way = pushed[slides, 1:] / across[slides, None]
        share = friction[slides] * pushed[slides, 0] / across[slides]
        turn = np.eye(2) - way[:, :, None] * way[:, None]
        found[slides, 1:, 1:] = share[:, None, None] * turn
        found[slides, 1:, 0] = friction[slides, None] * way
    return found
