"""Coulomb's law at the end of a path that goes around its folds: where blocks that move jam.

Forces along the edges of cones and the velocities of these multiply to tau in each. To the
velocities de Saxce's bipotential adds the slip that dilatation would turn into lift, smoothed
by tau. How such a path is followed is in `folds.py`. In heaps it takes 100 to 300 banded
systems; Lemke's, on the law that is not smoothed, has more than 20,000 pieces there.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.engines.contact.cones import Cones
from blocksim.engines.contact.folds import FIRST, Path, Point
from blocksim.engines.contact.interior import YIELD
from blocksim.engines.contact.step import Answer, Step

CLOSE, CLOSEST, SHORT = 1e-14, 1e-16, 1e-3
"""Product from which it ends where steps shorten to the last, as round-off is all that is left;
and product at which it ends: the residual is about the root of that."""
ROUND_OFF = 1e-15
"""Velocities that are none, over what they are sums of."""
MOST_STEPS = 1000
"""Most steps, each a banded system."""


def around_folds(step: Step) -> Answer:
    """Return where the path ends, of a step with friction that is not steep."""
    # Coulomb's law has no scale: that of a short step's velocities is taken away.
    approach = step.rates[:, :2] + step.bands.along(step.rows[:, :2], step.free)
    scale = max(1.0, -float(approach.min(initial=0.0)))
    path = _Jammed(replace(step, rates=step.rates / scale, free=step.free / scale))
    systems = 0
    while not path.has_ended and systems < MOST_STEPS and path.go():
        systems += 1
    x, pressed = path.found
    return Cones.of(step).answer(step, scale * x, scale * pressed, systems)


class _Look(NamedTuple):
    """What is seen at a point.

    `tau`: Product to which it belongs.
    `turned`, (joints, 4, 6): Edges with how slips that are added change.
    `smoother`, (joints, 4): What velocities change by with the logarithm of tau.
    `left`, (joints, 4): By how much v is not what velocities make of it.
    `stiff`, (joints, 4): y over v.
    `off`: How far it is from the path.
    """

    tau: float
    turned: Array
    smoother: Array
    left: Array
    stiff: Array
    off: float


class _Jammed(Path[_Look]):
    """The path of a step."""

    wide = 0.5

    def __init__(self, step: Step) -> None:
        self._step, self._cones = step, Cones.of(step)
        self._sizes = np.abs(self._cones.edges)
        # What is far open stays so.
        even = math.sqrt(FIRST)
        v = np.maximum(
            step.bands.along(self._cones.edges, step.free) + self._cones.offset, even
        )
        super().__init__(Point(step.free, FIRST / v, v, math.log(FIRST)))

    @property
    def has_ended(self) -> bool:
        """Whether nothing is left to follow but round-off."""
        return self.tau < CLOSEST or (self.tau < CLOSE and self._length < SHORT)

    @property
    def found(self) -> tuple[Array, Array]:
        """Accelerations, and forces along the edges, by now."""
        return self._at.x, self._at.y

    def _looked(self, at: Point) -> _Look | None:
        if not (at.y > 0).all() or not (at.v > 0).all():
            return None
        step, cones, tau = self._step, self._cones, math.exp(at.log)
        slip = step.rates[:, 2:] + step.bands.along(step.rows[:, 2:], at.x)
        size = np.hypot(slip, tau)
        turning = (cones.lean * slip / size)[..., None] * step.rows[:, 2:]
        seen = step.bands.along(cones.edges, at.x) + cones.offset
        left = seen + np.tile(cones.lean * size, 2) + YIELD * at.y - at.v
        parts = step.bands.along(self._sizes, np.abs(at.x)) + np.abs(cones.offset)
        left[np.abs(left) < ROUND_OFF * parts] = 0.0
        product, stiff = at.y * at.v, at.y / at.v
        return _Look(
            tau=tau,
            turned=cones.edges + np.tile(turning, (1, 2, 1)),
            smoother=np.tile(cones.lean * tau**2 / size, 2),
            left=left,
            stiff=stiff,
            off=max(
                float(product.max()) / tau - 1,
                tau / float(product.min()) - 1,
                math.sqrt(float((left * stiff * left).max()) / tau),
            ),
        )

    def _newton(self, look: _Look) -> tuple[Point, Point, float] | None:
        bands, edges, at = self._step.bands, self._cones.edges, self._at
        # What yields takes its share of how v changes.
        share = 1 / (1 + YIELD * look.stiff)
        weight: Array = share * look.stiff
        aim = look.tau / at.v
        asked = [
            (look.left + YIELD * (aim - at.y), aim - at.y),
            (look.smoother + YIELD * aim, aim),
        ]
        pulls = [bands.pull(edges, change - weight * known) for known, change in asked]
        pulls[0] += self._step.free + bands.pull(edges, at.y) - at.x
        band = bands.band(edges, weight, look.turned)
        found, sign = bands.solve_signed(band, np.stack(pulls, axis=1))
        if not np.isfinite(found).all():
            return None
        ways: list[Point] = []
        for (known, change), x, log in zip(asked, found.T, (0.0, 1.0), strict=True):
            v = share * (known + bands.along(look.turned, x))
            ways.append(Point(x, change - look.stiff * v, v, log))
        return ways[0], ways[1], sign

    def _product(self, look: _Look, one: Point, other: Point) -> float:
        pressing = float((one.v * look.stiff * other.v).sum())
        parting = float((one.y / look.stiff * other.y).sum())
        return (pressing + parting) / (look.tau * one.y.size) + one.log * other.log

    def _room(self, way: Point) -> float:
        at = self._at
        least = min(float((way.y / at.y).min()), float((way.v / at.v).min()))
        return math.inf if least >= 0 else -1.0 / least
