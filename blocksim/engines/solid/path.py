"""A path from contacts that all press and part at once down to Coulomb's law.

With y = (p_n, p_t / mu) and v = (u_n + mu s, mu u_t), where s is how fast a contact slips, a
solution has y and v in round cones, and y v = 0 (De Saxce and Feng 1998). On the path that
product is tau in each contact, and s is smoothed by tau. It is followed around its folds, by
`contact/folds.py`: beyond the limit of rest, and where blocks jam, paths of falling tau end at
residuals of 1e-2 to 1e-4. Steps are scaled as those of interior points are (Nesterov and Todd
1997).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.folds import FIRST, Path, Point
from blocksim.engines.solid.step import ALIKE, Step, slip_of

STOPS = 1e-9, 1e-11
"""Products at which springs are tried; those nearer are lost in round-off."""
STEPS = 2000
"""Most steps: none of a hundred vaults and domes beyond their limit took more than 1,300."""
FLIP = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Look:
    """What is seen at a point.

    `tau`: Product to which it belongs.
    `slips`, (points,): Smoothed.
    `velocities`, (points, 3).
    `squeeze`, `widen`, (points, 3, 3): What takes v to y, and its inverse.
    `left`, (points, 3): By how much v is not what velocities make of it.
    `off`: How far it is from the path; 1 where products are between a half and twice tau.
    """

    tau: float
    slips: Array
    velocities: Array
    squeeze: Array
    widen: Array
    left: Array
    off: float


def followed(step: Step, most: int) -> Iterator[Array]:
    """Give forces, (points, 3), where the path passes the `STOPS`, and where it ends.

    `most`: Most steps along it, each a banded system.
    """
    path, stops = _Path(step), list(STOPS)
    for _ in range(most):
        if not path.go():
            break
        if path.tau <= stops[0]:
            yield path.forces
            stops.pop(0)
            if not stops:
                return
    yield path.forces


class _Path(Path[Look]):
    """The path of a step."""

    def __init__(self, step: Step) -> None:
        self._step, count = step, len(step.friction)
        self._scale = np.ones((count, 3))
        self._scale[:, 1:] = step.friction[:, None]
        even = np.zeros((count, 3))
        even[:, 0] = math.sqrt(FIRST)
        super().__init__(Point(step.free, even, even, math.log(FIRST)))

    @property
    def forces(self) -> Array:
        """Forces, (points, 3)."""
        return self._scale * self._at.y

    def _looked(self, at: Point) -> Look | None:
        step, tau = self._step, math.exp(at.log)
        velocities = step.velocities(at.x)
        slips = np.hypot(slip_of(velocities), tau)
        left = self._scale * velocities - at.v
        left[:, 0] += step.friction * slips
        both = _squares(at.y), _squares(at.v)
        if not all((each > 0).all() for each in both):
            return None
        y, v = (
            each / np.sqrt(size)[:, None] for each, size in zip((at.y, at.v), both, strict=True)
        )
        middle = (y + FLIP * v) / np.sqrt(2 + 2 * (y * v).sum(axis=1))[:, None]
        stiff = np.sqrt(both[0] / both[1])[:, None, None]
        squeeze = stiff * _turned(middle)
        work, product = (at.y * at.v).sum(axis=1), both[0] * both[1]
        most = work + np.sqrt(np.maximum(work**2 - product, 0.0))
        off = max(
            float(most.max()) / tau - 1,
            tau / float((product / most).min()) - 1,
            math.sqrt(float((left * _times(squeeze, left)).sum(axis=1).max()) / tau),
        )
        widen = _turned(FLIP * middle) / stiff
        return Look(tau, slips, velocities, squeeze, widen, left, off)

    def _newton(self, look: Look) -> tuple[Point, Point, float] | None:
        step, at, tau = self._step, self._at, look.tau
        mu, rows, bands = step.friction, step.rows, step.bands
        # What v changes by with velocities, and with the logarithm of tau.
        slope = self._scale[:, :, None] * np.eye(3)
        slope[:, 0, 1:] = (mu / look.slips)[:, None] * look.velocities[:, 1:]
        smoother = np.zeros_like(at.v)
        smoother[:, 0] = mu * tau**2 / look.slips
        aim = tau * FLIP * at.v / _squares(at.v)[:, None]
        springs = self._scale[:, :, None] * np.matmul(look.squeeze, slope)
        pulls = [
            bands.pull(rows, self._scale * (change - _times(look.squeeze, known)))
            for change, known in ((aim - at.y, look.left), (aim, smoother))
        ]
        pulls[0] += step.pushed_by(self.forces) - at.x
        band = bands.band(rows, ALIKE, np.matmul(springs, rows))
        found, sign = bands.solve_signed(band, np.stack(pulls, axis=1))
        if not np.isfinite(found).all():
            return None
        back, along = (
            self._way(look, slope, x, known, change, log)
            for x, known, change, log in (
                (found[:, 0], look.left, aim - at.y, 0.0),
                (found[:, 1], smoother, aim, 1.0),
            )
        )
        return back, along, sign

    def _way(
        self, look: Look, slope: Array, x: Array, known: Array, change: Array, log: float
    ) -> Point:
        """Return a way of which the blocks' part is known."""
        step = self._step
        v = known + _times(slope, step.bands.along(step.rows, x))
        return Point(x, change - _times(look.squeeze, v), v, log)

    def _product(self, look: Look, one: Point, other: Point) -> float:
        pressing = (one.v * _times(look.squeeze, other.v)).sum()
        parting = (one.y * _times(look.widen, other.y)).sum()
        return float(pressing + parting) / (look.tau * len(one.y)) + one.log * other.log

    def _room(self, way: Point) -> float:
        return min(_room(self._at.y, way.y), _room(self._at.v, way.v))


def _times(matrices: Array, vectors: Array) -> Array:
    return np.matmul(matrices, vectors[:, :, None])[:, :, 0]


def _turned(axis: Array) -> Array:
    """Return 2 a a^T - diag(1, -1, -1) of vectors of determinant 1, (points, 3, 3)."""
    return 2 * axis[:, :, None] * axis[:, None] - np.diag(FLIP)


def _squares(vectors: Array) -> Array:
    """Return determinants, (points,): above 0 within the cones."""
    across = slip_of(vectors)
    return (vectors[:, 0] - across) * (vectors[:, 0] + across)


def _room(at: Array, way: Array) -> float:
    """Return how many times a way may be gone within the cones."""
    a, c = _squares(way), _squares(at)
    b = (FLIP * at * way).sum(axis=1)
    inside = b * b - a * c
    # Of a t^2 + 2 b t + c the first root above 0.
    below = np.sqrt(np.maximum(inside, 0.0)) - b
    leaves = (inside >= 0) & (below > 0)
    return float((c[leaves] / below[leaves]).min(initial=np.inf))
