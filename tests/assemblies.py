"""Random assemblies, drawn as polygons: walls, stacks, leaning blocks, arches, rubble.

A `Sketch` is what is drawn: polygons, friction, loads.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from scipy.spatial import Voronoi

from blocksim import Assembly, Load, Problem, assembly_of_polygons, collapse, equilibrium

SEED = 2026
RANGE = 1e-3, 1e3
"""Load factors of the assemblies that are drawn."""
Polygons = list[np.ndarray]
"""Of the supports first."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Sketch:
    """Polygons, friction and loads.

    Parameters
    ----------
    kind : str
        Of `KINDS`.
    polygons : tuple of (k, 2) float
        [m]; the density is 1 N/m^3.
    fixed : frozenset of int
        Which of them are supports.
    mu : float
        Friction of all joints but those of the pairs of polygons in `own`.
    own : mapping of frozenset of int to float
    force : (2,) float
        Live: in units of each weight, or [N] on the polygon `on` at `point`.
    on : int or None
    point : (2,) float or None
    """

    kind: str
    polygons: tuple[np.ndarray, ...]
    fixed: frozenset[int]
    mu: float
    own: Mapping[frozenset[int], float]
    force: np.ndarray
    on: int | None = None
    point: np.ndarray | None = None

    def problem(self) -> Problem:
        """Find the joints, and put friction and loads on."""
        assembly = assembly_of_polygons(self.polygons, fixed=self.fixed)
        joints = [
            replace(joint, friction=self.own.get(pair))
            for joint, pair in zip(assembly.joints, pairs(assembly), strict=True)
        ]
        moving = [index for index in range(len(self.polygons)) if index not in self.fixed]
        on = range(len(moving)) if self.on is None else [moving.index(self.on)]
        live = Load(
            force=self.force, blocks=tuple(on), point=self.point, per_weight=self.on is None
        )
        return Problem(
            assembly=replace(assembly, joints=tuple(joints)),
            mu=self.mu,
            live=(live,),
            title=self.kind,
        )


def pairs(assembly: Assembly) -> list[frozenset[int]]:
    """Return which polygons each joint of a sketch's assembly is between."""

    def of(block: int, support: int | None) -> int:
        if block >= 0:
            return int(assembly.blocks[block].name)
        return int(assembly.supports[support or 0].name)

    return [
        frozenset((of(joint.before, joint.support), of(joint.after, joint.support)))
        for joint in assembly.joints
    ]


def sketch(kind: str, random: Generator) -> Sketch:
    """Draw one of a kind, with friction and a live load; it need not be able to rest."""
    polygons, fixed = KINDS[kind](random)
    mu = math.inf if random.random() < 0.1 else random.uniform(0.2, 1.5)
    drawn = Sketch(
        kind=kind,
        polygons=tuple(polygons),
        fixed=frozenset(range(fixed)),
        mu=mu,
        own={},
        force=np.array([random.choice([-1.0, 1.0]), 0.0]),
    )
    if random.random() < 0.3:
        found = sorted(set(pairs(drawn.problem().assembly)), key=sorted)
        drawn = replace(
            drawn,
            own={
                pair: 0.0 if random.random() < 0.4 else random.uniform(0.2, 1.5)
                for pair in found
                if random.random() < 0.25
            },
        )
    if random.random() < 0.6:
        return drawn
    on = int(random.integers(fixed, len(polygons)))
    angle = random.choice([0.0, -0.5, -0.25, -0.75, 1.0, random.uniform(-1, 1)]) * math.pi
    # As heavy as the mean block, at one of its corners.
    heavy = np.mean([_area(polygon) for polygon in polygons[fixed:]])
    return replace(
        drawn,
        on=on,
        point=polygons[on][random.integers(len(polygons[on]))],
        force=heavy * np.array([math.cos(angle), math.sin(angle)]),
    )


def _area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def box(left: float, low: float, right: float, high: float) -> np.ndarray:
    """Return the corners of a rectangle."""
    return np.array([[left, low], [right, low], [right, high], [left, high]])


def _breaks(width: float, length: float, shift: float) -> list[float]:
    inner = np.arange(shift, width, length)
    return [0.0, *(float(x) for x in inner if 1e-9 < x < width - 1e-9), width]


def _courses(rows: Sequence[Sequence[float]], hole: tuple[float, ...] = ()) -> Polygons:
    """Lay courses of height 1; a hole is left, right, and its courses from and below."""
    return [
        box(left, row, right, row + 1)
        for row, breaks in enumerate(rows)
        for left, right in pairwise(breaks)
        if not (hole and left == hole[0] and right == hole[1] and hole[2] <= row < hole[3])
    ]


def wall(random: Generator) -> tuple[Polygons, int]:
    """Draw a wall in running bond, most with an opening under a lintel."""
    length, bricks = random.uniform(1.5, 3.0), int(random.integers(3, 6))
    courses, lap = int(random.integers(3, 9)), random.uniform(0.3, 0.7)
    width, hole = bricks * length, ()
    rows = [_breaks(width, length, lap * length * (row % 2)) for row in range(courses)]
    if courses > 3 and random.random() < 0.7:
        left = random.uniform(0.2, 0.5) * width
        right = left + random.uniform(0.15, 0.3) * width
        first = int(random.integers(0, 2))
        last = int(random.integers(first + 1, courses - 1))
        hole, rest = (left, right, first, last), random.uniform(0.3, 0.8) * length / 2
        for row in range(first, last):
            rows[row] = _cut(rows[row], left, right, 0.2)
        rows[last] = _cut(rows[last], left - rest, right + rest, 0.2)
    return [box(-1, -1, width + 1, 0), *_courses(rows, hole)], 1


def _cut(breaks: Sequence[float], left: float, right: float, least: float) -> list[float]:
    """Make one piece of what lies from left to right, and leave no sliver beside it."""
    kept = [x for x in breaks[1:-1] if x < left - least or x > right + least]
    return sorted([breaks[0], *kept, left, right, breaks[-1]])


def stack(random: Generator) -> tuple[Polygons, int]:
    """Draw blocks of all widths upon each other, shifted."""
    polygons, middle, low = [box(-5, -1, 5, 0)], 0.0, 0.0
    for _ in range(random.integers(3, 13)):
        half, high = random.uniform(0.5, 1.5), low + random.uniform(0.4, 1.2)
        middle += random.uniform(-0.3, 0.3) * half
        polygons.append(box(middle - half, low, middle + half, high))
        low = high
    return polygons, 1


def leaning(random: Generator) -> tuple[Polygons, int]:
    """Draw blocks that lean on a wall, on each other or on a free block, by corners."""
    tilt, thick = math.radians(random.uniform(8, 40)), random.uniform(0.3, 0.8)
    up, across = _axes(tilt)
    floor, high = box(-9, -1, 9, 0), 4.0

    def block(foot: float, height: float) -> np.ndarray:
        sides = [0 * up, height * up, height * up - thick * across, -thick * across]
        return np.array([foot, 0.0]) + np.array(sides)

    # Books of one tilt touch by their faces, and the floor by a corner.
    count = int(random.integers(1, 6))
    feet = -np.arange(count) * thick / math.cos(tilt)
    heights = random.uniform(2.5, 4.0) * random.uniform(0.7, 1.0, count)
    books = [
        block(float(foot), float(height)) for foot, height in zip(feet, heights, strict=True)
    ]
    wall_at = float(books[0][1, 0])
    if random.random() < 0.5:
        return [floor, box(wall_at, 0, wall_at + 1, high), *books], 2
    # A free pier of several blocks in place of the wall.
    levels = np.linspace(0, high, int(random.integers(2, 5)))
    wide = random.uniform(1.0, 2.5)
    pier = [box(wall_at, float(a), wall_at + wide, float(b)) for a, b in pairwise(levels)]
    return [floor, *pier, *books], 1


def _axes(tilt: float) -> tuple[np.ndarray, np.ndarray]:
    return (
        np.array([math.sin(tilt), math.cos(tilt)]),
        np.array([math.cos(tilt), -math.sin(tilt)]),
    )


def _ring(
    cuts: np.ndarray, inner: np.ndarray, outer: np.ndarray, flat: float
) -> tuple[Polygons, np.ndarray]:
    """Voussoirs between cuts (angles from the crown), and the outer points."""
    out = np.stack([np.sin(cuts), flat * np.cos(cuts)], axis=1)
    low, high = inner[:, None] * out, outer[:, None] * out
    return [
        np.array([low[k], low[k + 1], high[k + 1], high[k]])[::-1] for k in range(len(cuts) - 1)
    ], high


def _uneven(random: Generator, first: float, last: float, count: int) -> np.ndarray:
    parts = np.concatenate([[0.0], np.cumsum(random.uniform(0.5, 1.5, count))])
    return first + (last - first) * parts / parts[-1]


def arch(random: Generator) -> tuple[Polygons, int]:
    """Draw an unsymmetric arch of unequal voussoirs, chipped, with fill that is not whole."""
    count, flat = int(random.integers(5, 26)), random.uniform(0.6, 1.2)
    left, right = np.radians(random.uniform(40, 85, 2))
    cuts = _uneven(random, -left, right, count)
    thick = np.interp(cuts, [-left, right], random.uniform(0.12, 0.35, 2))
    beyond = np.concatenate([[cuts[0] - 0.1], cuts, [cuts[-1] + 0.1]])
    wide = np.concatenate([thick[:1], thick, thick[-1:]])
    ring, high = _ring(beyond, 1 - wide / 2, 1 + wide / 2, flat)
    supports, voussoirs = [ring[0], ring[-1]], ring[1:-1]
    if random.random() < 0.4:
        chipped = int(random.integers(count))
        # Reversed corners: outer left, outer right, inner right, inner left.
        corners = voussoirs[chipped]
        a, b, c, d = corners
        down, along = (d - a) * random.uniform(0.5, 0.8), (c - d) * random.uniform(0.1, 0.4)
        voussoirs[chipped] = np.array([a, b, c, d + along, a + down])
    fill: Polygons = []
    if random.random() < 0.5:
        top = high[:, 1].max() + random.uniform(0.05, 0.3)
        for a, b in pairwise(high[1:-1]):
            steep = abs(b[1] - a[1]) > 1.2 * (b[0] - a[0])
            if not steep and random.random() < 0.75:
                fill.append(np.array([a, b, [b[0], top], [a[0], top]]))
    return [*supports, *voussoirs, *fill], 2


def rubble(random: Generator) -> tuple[Polygons, int]:
    """Draw Voronoi cells cut by a box, on a floor, some between walls."""
    width, height = random.uniform(2, 5), random.uniform(1.5, 3)
    points = random.uniform(0, 1, (int(random.integers(4, 41)), 2)) * [width, height]
    cells = _cells(points, width, height)
    for _ in range(2):
        points = np.array([cell.mean(axis=0) for cell in cells])
        cells = _cells(points, width, height)
    supports = [box(-1, -1, width + 1, 0)]
    if random.random() < 0.5:
        part = random.uniform(0.3, 1.0) * height
        supports += [box(-1, 0, 0, part), box(width, 0, width + 1, part)]
    return [*supports, *cells], len(supports)


def _cells(points: np.ndarray, width: float, height: float) -> Polygons:
    """Cells of points in a box: their images behind its sides make these the borders."""
    images = [points * [-1, 1], points * [1, -1]]
    images += [[2 * width, 0] + images[0], [0, 2 * height] + images[1]]
    whole = Voronoi(np.concatenate([points, *images]))
    found: Polygons = []
    for index in range(len(points)):
        corners = whole.vertices[whole.regions[whole.point_region[index]]]
        corners = np.clip(corners, 0, [width, height])
        way = corners - corners.mean(axis=0)
        found.append(corners[np.argsort(np.arctan2(way[:, 1], way[:, 0]))])
    return found


def column(random: Generator) -> tuple[Polygons, int]:
    """Draw drums that taper, with joints not quite level, and an abacus."""
    count, lean = int(random.integers(3, 11)), random.uniform(-0.04, 0.04)
    low = np.cumsum(np.concatenate([[0.0], random.uniform(0.5, 1.2, count)]))
    half = np.linspace(0.6, random.uniform(0.4, 0.6), count + 1)
    slope = np.concatenate([[0.0], random.uniform(-0.06, 0.06, count)])
    left = np.stack([lean * low - half, low - slope * half], axis=1)
    right = np.stack([lean * low + half, low + slope * half], axis=1)
    drums = [np.array([left[k], right[k], right[k + 1], left[k + 1]]) for k in range(count)]
    out, across = random.uniform(0.0, 0.3), right[-1] - left[-1]
    a, b = left[-1] - out * across, right[-1] + out * across
    abacus = np.array([a, b, b, a]) + 0.3 * np.array([[0, 0], [0, 0], [0, 1], [0, 1]])
    return [box(-3, -1, 3, 0), *drums, abacus], 1


def trilithon(random: Generator) -> tuple[Polygons, int]:
    """Draw posts of one or more blocks under lintels, one to three bays, one or two storeys."""
    bays, low = int(random.integers(1, 4)), 0.0
    span, polygons = random.uniform(1.5, 3.0), [box(-2, -1, 12, 0)]
    for _ in range(random.integers(1, 3)):
        high = low + random.uniform(1.5, 4.0)
        for post in range(bays + 1):
            half = random.uniform(0.3, 0.6)
            levels = np.linspace(low, high, int(random.integers(2, 5)))
            polygons += [
                box(post * span - half, float(a), post * span + half, float(b))
                for a, b in pairwise(levels)
            ]
        ends = span * np.arange(bays + 1)
        ends[[0, -1]] += [-random.uniform(0.0, 0.6), random.uniform(0.0, 0.6)]
        thick = random.uniform(0.3, 0.8)
        polygons += [box(float(a), high, float(b), high + thick) for a, b in pairwise(ends)]
        low = high + thick
    return polygons, 1


def portal(random: Generator) -> tuple[Polygons, int]:
    """Draw an arch on piers of blocks, one wider than the other."""
    count, half_angle = int(random.integers(4, 16)), math.radians(random.uniform(45, 85))
    thick = random.uniform(0.15, 0.35)
    cuts = _uneven(random, -half_angle, half_angle, count)
    ones = np.ones(count + 1)
    ring, _ = _ring(cuts, ones - thick / 2, ones + thick / 2, 1.0)
    base, polygons = -random.uniform(0.3, 1.5), list[np.ndarray]()
    for side in (-1, 1):
        end = np.array([side * math.sin(half_angle), math.cos(half_angle)])
        low, high = (1 - thick / 2) * end, (1 + thick / 2) * end
        back = high[0] + side * random.uniform(0.1, 0.6)
        head = low[1] - 0.1
        polygons.append(
            np.array([[back, head], [low[0], head], low, high, [back, high[1]]])[::-side]
        )
        levels = np.linspace(base, head, int(random.integers(2, 5)))
        left, right = sorted((float(low[0]), float(back)))
        polygons += [box(left, float(a), right, float(b)) for a, b in pairwise(levels)]
    return [box(-4, base - 1, 4, base), *polygons, *ring], 1


KINDS: dict[str, Callable[[Generator], tuple[Polygons, int]]] = {
    "wall": wall,
    "stack": stack,
    "leaning": leaning,
    "arch": arch,
    "rubble": rubble,
    "column": column,
    "trilithon": trilithon,
    "portal": portal,
}


def drawn(index: int) -> Sketch:
    """Draw the `index`-th assembly: one that rests, and falls at some load factor."""
    kind = list(KINDS)[index % len(KINDS)]
    for attempt in itertools.count():
        found = sketch(kind, np.random.default_rng((SEED, index, attempt)))
        problem = found.problem()
        if not equilibrium(problem).exists:
            continue
        factor = collapse(problem).load_factor
        if factor is not None and RANGE[0] < factor < RANGE[1]:
            return found
    raise AssertionError
