"""Coulomb's law of a step, smoothed, and followed as the smoothing goes to nothing.

With friction as in De Saxce and Feng 1998 the force (p_n, p_t / mu) and the velocity
(u_n + mu |u_t|, mu u_t) lie in one cone of the second order and are orthogonal. Both are found
where their product in the sense of that cone is e^2 in place of 0, e falling to nothing (Chen
and Tseng 2003): Newton's method, from any beginning.
"""

from __future__ import annotations

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.solid.step import Step

FIRST, LAST = 1.0, 1e-8
"""Smoothing, at first and where the path ends [mean weights]."""
FALLS = 0.2
"""What it is multiplied by."""
ROUNDED = 0.01, 0.1, 0.001, 1.0
"""Smoothing of the slip over that of the product, of paths that are tried in turn. Those with
less of it are rarely lost at folds."""
SLOWEST = 0.95
"""The same where the path is lost with less, at most."""
CLOSE = 0.05
"""Share of the smoothing by which a point is off the path."""
STEPS, HALVINGS = 40, 12
"""Most of Newton's steps for one smoothing, and most halvings of one."""


def followed(step: Step, rounded: float) -> Array | None:
    """Return forces at the end of a path, or where it breaks off; None where it never begins.

    `rounded`: Smoothing of the slip over that of the product.
    """
    mu = step.friction
    scale = np.stack([np.ones_like(mu), mu, mu], axis=1)
    p = np.zeros_like(scale)
    p[:, 0] = 1.0
    x = step.pushed_by(scale * p)
    smooth, falls, reached = FIRST, FALLS, None
    while smooth > LAST:
        found = _settled(step, scale, x, p, smooth, rounded)
        if found is not None:
            reached, (x, p) = smooth, found
            smooth, falls = smooth * falls, max(FALLS, falls**2)
            continue
        # Nearer to where it was the path is not lost.
        falls **= 0.5
        if reached is None or falls > SLOWEST:
            return None if reached is None else scale * p
        smooth = reached * falls
    return scale * p


def _settled(
    step: Step, scale: Array, x: Array, p: Array, smooth: float, rounded: float
) -> tuple[Array, Array] | None:
    """Return the point of the path with this smoothing, from one close by."""
    for _ in range(STEPS):
        left = _left(step, scale, x, p, smooth, rounded)
        size = _size(left)
        if size < CLOSE * smooth:
            return x, p
        found = _newton(step, scale, x, p, smooth, rounded, left)
        if found is None:
            return None
        share, reached, tried = 1.0, np.inf, (x, p)
        for _ in range(HALVINGS):
            tried = x + share * found[0], p + share * found[1]
            reached = _size(_left(step, scale, *tried, smooth, rounded))
            if reached < (1 - 1e-3 * share) * size:
                break
            share /= 2
        if not reached < size:
            return None
        x, p = tried
    return None


def _size(left: tuple[Array, Array]) -> float:
    return float(np.sqrt(sum(float((each**2).sum()) for each in left)))


def _velocity(
    step: Step, scale: Array, x: Array, smooth: float, rounded: float
) -> tuple[Array, Array]:
    """Return the velocity in the cone, and how it changes with that of the points."""
    u = step.velocities(x)
    slip = np.sqrt(u[:, 1] ** 2 + u[:, 2] ** 2 + (rounded * smooth) ** 2)
    y = scale * u
    y[:, 0] += scale[:, 1] * slip
    turn = np.zeros((len(u), 3, 3))
    turn[:, [0, 1, 2], [0, 1, 2]] = scale
    turn[:, 0, 1:] = scale[:, 1:] * u[:, 1:] / slip[:, None]
    return y, turn


def _left(
    step: Step, scale: Array, x: Array, p: Array, smooth: float, rounded: float
) -> tuple[Array, Array]:
    """Return what is left of balance, and of the product."""
    y, _ = _velocity(step, scale, x, smooth, rounded)
    return x - step.pushed_by(scale * p), p - Plus(p - y, smooth).value


class Plus:
    """The smoothed part of points within the cone, and how it changes with them.

    `z`, (points, 3).
    """

    def __init__(self, z: Array, smooth: float) -> None:
        long = np.hypot(z[:, 1], z[:, 2])
        self._way = way = z[:, 1:] / np.maximum(long, 1e-300)[:, None]
        ends = np.stack([z[:, 0] + long, z[:, 0] - long], axis=1)
        root = np.sqrt(ends**2 + 4 * smooth**2)
        # Without cancelling where an end is far from 0; the difference of both is the end.
        large = (np.abs(ends) + root) / 2
        small = smooth**2 / large
        f: Array = np.where(ends > 0, large, small)
        h: Array = np.where(ends > 0, small, large)
        self.value = np.empty_like(z)
        self.value[:, 0] = f.sum(axis=1) / 2
        self.value[:, 1:] = (f[:, 0] - f[:, 1])[:, None] / 2 * way
        near = long < 1e-9 * root.max(axis=1)
        twice: Array = np.maximum(2 * long, 1e-300)
        across: Array = np.where(near, f[:, 0] / root[:, 0], (f[:, 0] - f[:, 1]) / twice)
        left: Array = np.where(near, h[:, 0] / root[:, 0], (h[:, 1] - h[:, 0]) / twice)
        self._changes = np.column_stack([f / root, across])
        self._rest = np.column_stack([h / root, left])

    def inverse(self) -> Array:
        """Return the inverse of one less the change, (points, 3, 3)."""
        return self._of(1 / self._rest)

    def springs(self) -> Array:
        """Return that times the change."""
        return self._of(self._changes / self._rest)

    def _of(self, values: Array) -> Array:
        """Return matrices with these values along (1, way), (1, -way) and across both."""
        way = self._way
        found = np.empty((len(way), 3, 3))
        both, apart = (values[:, 0] + values[:, 1]) / 2, (values[:, 0] - values[:, 1]) / 2
        found[:, 0, 0] = both
        found[:, 0, 1:] = found[:, 1:, 0] = apart[:, None] * way
        outer = way[:, :, None] * way[:, None]
        found[:, 1:, 1:] = both[:, None, None] * outer
        found[:, 1:, 1:] += values[:, 2, None, None] * (np.eye(2) - outer)
        return found


def _newton(
    step: Step,
    scale: Array,
    x: Array,
    p: Array,
    smooth: float,
    rounded: float,
    left: tuple[Array, Array],
) -> tuple[Array, Array] | None:
    """Return Newton's step of accelerations and forces."""
    y, turn = _velocity(step, scale, x, smooth, rounded)
    plus = Plus(p - y, smooth)
    spring = np.matmul(plus.springs(), turn)
    given = np.einsum("pij,pj->pi", plus.inverse(), left[1])
    right = -left[0] - step.bands.pull(step.rows, scale * given)
    dx = step.with_springs(scale[:, :, None] * spring, right)
    if dx is None:
        return None
    dp = -given - np.einsum("pij,pj->pi", spring, step.bands.along(step.rows, dx))
    if not (np.isfinite(dx).all() and np.isfinite(dp).all()):
        return None
    return dx, dp
