"""An arch bridge put together apart from the package: its own geometry and linear programme.

A circular arch between fixed abutments under its own weight, fill up to a level road, and loads
given for each voussoir. Forces at both ends of each joint; every row a voussoir's balance.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import linprog

RATIO = 1.05
TANGENTS: Any = RATIO ** -np.arange(200.0)
"""Shares of the strength at which tangents touch."""
SPARED = 4 * RATIO / (1 + RATIO) ** 2
"""Tangents lie above the law of this share of the strength."""


@dataclass
class Bridge:
    """Clear span, rise, thickness and fill over the crown [m], kN/m3; one metre deep."""

    span: float
    rise: float
    thick: float
    count: int
    fill: float
    mu: float = 0.6
    heavy: float = 20.0
    heavy_fill: float = 20.0
    corners: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        half = self.span / 2
        self.inner = (half**2 + self.rise**2) / (2 * self.rise)
        self.outer = self.inner + self.thick
        self.angle = math.atan2(half, self.inner - self.rise)
        cuts = np.linspace(-self.angle, self.angle, self.count + 1)
        ends = np.stack([np.sin(cuts), np.cos(cuts)], axis=1)
        self.cuts = cuts
        self.low, self.high = self.inner * ends, self.outer * ends
        self.road = self.outer + self.fill
        # Sector of a ring: area, and distance of its centroid from the centre.
        step = cuts[1] - cuts[0]
        area = step * (self.outer**2 - self.inner**2) / 2
        reach = (self.outer**3 - self.inner**3) / 3 * 2 * math.sin(step / 2) / area
        middle = (cuts[1:] + cuts[:-1]) / 2
        self.centre = reach * np.stack([np.sin(middle), np.cos(middle)], axis=1)
        self.weight = np.full(self.count, self.heavy * area)

    def dead(self) -> np.ndarray:
        """Down force and moment about the origin of each voussoir, (n, 3) [kN, kN m]."""
        found = np.zeros((self.count, 3))
        found[:, 1] = -self.weight
        found[:, 2] = -self.weight * self.centre[:, 0]
        for k in range(self.count):
            left, right = self.high[k, 0], self.high[k + 1, 0]

            def depth(x: float) -> float:
                return self.road - math.sqrt(self.outer**2 - x * x)

            own = self.heavy_fill * quad(depth, left, right)[0]
            turn = self.heavy_fill * quad(lambda x: x * depth(x), left, right)[0]
            found[k] += 0.0, -own, -turn
        return found

    def wheel(self, x: float) -> np.ndarray:
        """A load of 1 kN straight down at a place that is over no joint."""
        found = np.zeros((self.count, 3))
        k = int(np.searchsorted(self.high[:, 0], x)) - 1
        if 0 <= k < self.count:
            found[k] = 0.0, -1.0, -x
        return found

    def spread(self, x: float, density: Any, most: float) -> np.ndarray:
        """A load of 1 kN spread by fill: `density` of the slope of its rays, up to `most`."""
        found = np.zeros((self.count, 3))
        for k in range(self.count):
            (x0, y0), (x1, y1) = self.high[k : k + 2]
            ends = np.clip(
                [(x0 - x) / (self.road - y0), (x1 - x) / (self.road - y1)], -most, most
            )

            def place(t: float) -> float:
                m = (y1 - y0) / (x1 - x0)  # noqa: B023
                return (x + t * (self.road - y0 + m * x0)) / (1 + m * t)  # noqa: B023

            if ends[1] > ends[0]:
                share = quad(density, *ends, epsabs=1e-13)[0]
                turn = quad(lambda t: density(t) * place(t), *ends, epsabs=1e-13)[0]
                found[k] = 0.0, -share, -turn
        return found

    def columns(self) -> np.ndarray:
        """What each force does: normal and both ways of friction at both ends of each joint."""
        parts = []
        for k in range(self.count + 1):
            along = self.high[k] - self.low[k]
            along = along / np.hypot(*along)
            # From the left voussoir to the right one; it presses on both.
            normal = np.array([along[1], -along[0]])
            for point in (self.low[k], self.high[k]):
                for force in (normal + self.mu * along, normal - self.mu * along):
                    column = np.zeros((self.count, 3))
                    turn = point[0] * force[1] - point[1] * force[0]
                    for voussoir, sign in ((k, 1.0), (k - 1, -1.0)):
                        if 0 <= voussoir < self.count:
                            column[voussoir] += sign * np.array([*force, turn])
                    parts.append(column.ravel())
        return np.array(parts).T

    def factor(
        self,
        live: np.ndarray,
        dead: np.ndarray | None = None,
        *,
        soil: np.ndarray | None = None,
        strength: float | None = None,
    ) -> float:
        """The largest factor on live loads, by scipy.

        `soil`, (voussoirs, 3): What soil bears at each, of which any share may act.
        `strength`: [kPa]
        """
        if not hasattr(self, "_balance"):
            self._balance, self._dead = self.columns(), self.dead()
        dead = self._dead if dead is None else dead
        count = 3 * self.count
        more = np.zeros((0, count))
        if soil is not None:
            more = (np.eye(self.count)[..., None] * soil).reshape(-1, count)
        columns = [self._balance, more.T, live.reshape(-1, 1)]
        matrix = np.hstack(columns)
        cost = np.zeros(matrix.shape[1])
        cost[-1] = -1.0
        bounds = [(0, None)] * self._balance.shape[1] + [(0, 1)] * len(more) + [(0, None)]
        law = {} if strength is None else self._tangents(strength, matrix.shape[1])
        found = linprog(cost, A_eq=matrix, b_eq=-dead.ravel(), bounds=bounds, **law)
        assert found.status in {0, 3}
        return -found.fun if found.status == 0 else math.inf

    def _tangents(self, strength: float, count: int) -> dict[str, Any]:
        """Rows that a strength adds: tangents of n^2 / (2 P) at both ends, which lie below."""
        full = strength * self.thick
        rows: list[Any] = []
        for joint in range(self.count + 1):
            for end in (0, 1):
                row = np.zeros((TANGENTS.size, count))
                row[:, 4 * joint : 4 * joint + 4] = TANGENTS[:, None]
                row[:, 4 * joint + 2 * end : 4 * joint + 2 * end + 2] -= 1
                rows.append(row / TANGENTS[:, None])
        right = np.tile(TANGENTS * full / 2, len(rows))
        return {"A_ub": np.concatenate(rows), "b_ub": right}

    def options(self) -> list[str]:
        """The same bridge on the command line."""
        return [
            *("--span", repr(self.span), "--rise", repr(self.rise)),
            *("--thickness", repr(self.thick), "--voussoirs", str(self.count)),
            *("--mu", repr(self.mu), "--fill", repr(self.fill)),
            *("--unit-weight", repr(self.heavy), "--fill-unit-weight", repr(self.heavy_fill)),
        ]


def thrusts_of_half(
    joints: list[tuple[Any, Any]], parts: list[tuple[float, float]], mu: float
) -> tuple[float, float]:
    """Least and greatest level force at x = 0 of what is its own mirror image, by scipy.

    `joints`: Inner and outer end of each joint of the left half, from the crown to the foot.
    `parts`: Weight and x of what lies between each joint and the one before it, or the middle.
    """
    rows: list[list[float]] = []
    right: list[float] = []
    weight = turn = 0.0
    # Unknown are the force H, to the left on this half, and its moment H y.
    for ends, (more, x) in zip(joints, parts, strict=True):
        inner, outer = np.asarray(ends)
        weight, turn = weight + more, turn + more * x
        for point, sign in ((inner, -1.0), (outer, 1.0)):
            rows.append([-sign * point[1], sign])
            right.append(sign * (turn - weight * point[0]))
        along = (outer - inner) / np.hypot(*(outer - inner))
        normal = np.array([along[1], -along[0]])
        for friction in (along, -along):
            # What is below pushes back by (H, weight).
            across = friction - mu * normal
            rows.append([across[0], 0.0])
            right.append(-weight * across[1])
    ends = [
        linprog([sign, 0.0], A_ub=rows, b_ub=right, bounds=[(0, None), (None, None)])
        for sign in (1.0, -1.0)
    ]
    assert [each.status for each in ends] == [0, 0]
    return float(ends[0].x[0]), float(ends[1].x[0])
