"""Convex polyhedra: their faces, volume, and centroid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from blocksim.blocks.assembly import Array, frozen
from blocksim.common.errors import InputError

Vector = tuple[float, float, float]
FEWEST = 4
FLAT = 1e-7
"""Share of its length below which a polyhedron has no thickness."""
ROUNDING = 1e-15
"""Share of its length by which a corner is off, as floating-point numbers have it."""
COPLANAR = 1e-7
"""Share of its thickness by which corners of one face may lie off its plane."""
SAME = 1 - 1e-14
"""Cosine of the angle below which two planes are one."""


@dataclass(frozen=True, eq=False)
class Face:
    """A face of a convex polyhedron.

    `normal`, (3,): Unit normal, outwards.
    `offset`: Of its plane, ``normal @ x`` [m].
    `corners`, (k, 3): Counter-clockwise, seen from outside [m].
    """

    normal: Array
    offset: float
    corners: Array


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """The hull of points in space.

    `corners`, (k, 3): Points of which it is the hull [m], in any order.
    `slack`: How far the corners of one face may lie off its plane [m], where they were rounded.

    Examples
    --------
    >>> import itertools
    >>> cube = Polyhedron(list(itertools.product((0, 1), repeat=3)))
    >>> len(cube.faces), round(cube.volume, 12)
    (6, 1.0)
    """

    corners: Array
    slack: float = 0.0

    def __init__(self, corners: ArrayLike, slack: float = 0.0) -> None:
        """Find the hull."""
        from scipy.spatial import ConvexHull, QhullError

        points = frozen(corners, (-1, 3))
        allowed = f"{FEWEST} corners or more that do not lie in a plane"
        if len(points) < FEWEST:
            raise InputError("vertices", f"{len(points)} corners", allowed)
        # Far from the origin digits would be lost.
        about = points - points.mean(axis=0)
        long = float(np.ptp(points, axis=0).max())
        spread = np.linalg.svd(about, compute_uv=False)
        if not spread[2] > FLAT * max(long, 1e-300):
            raise InputError("vertices", "a flat hull", allowed)
        try:
            hull = ConvexHull(about)
        except QhullError:
            raise InputError("vertices", "a flat hull", allowed) from None
        place = np.empty(len(points), np.int64)
        place[hull.vertices] = np.arange(len(hull.vertices))
        sides = place[hull.simplices]
        own = frozen(points[hull.vertices], (-1, 3))
        # Triangles of the hull, turned counter-clockwise seen from outside.
        cross = _crosses(own[sides])
        inwards = (cross * hull.equations[:, :3]).sum(axis=1) < 0
        sides[inwards] = sides[inwards][:, ::-1]
        cross[inwards] *= -1.0
        areas = np.sqrt((cross**2).sum(axis=1))
        units = cross / np.where(areas > 0, areas, 1.0)[:, None]
        vars(self).update(corners=own, slack=slack, _sides=sides, _areas=areas, _units=units)

    @cached_property
    def triangles(self) -> Array:
        """Its surface, (k, 3, 3), each counter-clockwise seen from outside."""
        return self.corners[vars(self)["_sides"]]

    @cached_property
    def box(self) -> Array:
        """Least and largest coordinates, (2, 3)."""
        return np.stack([self.corners.min(axis=0), self.corners.max(axis=0)])

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """Its faces: triangles in one plane are one."""
        corners, sides = self.corners, vars(self)["_sides"]
        areas, units = vars(self)["_areas"], vars(self)["_units"]
        long, thick = float(np.ptp(self.box, axis=0).max()), self.thickness
        # The plane of a triangle so narrow turns by what its corners are off over its width.
        slack = max(self.slack, COPLANAR * thick, ROUNDING * long * long / thick)
        middle = corners.mean(axis=0)
        heights = units @ (corners - middle).T
        # Which corners lie in the plane of each triangle.
        on = np.abs(heights - heights[range(len(sides)), sides[:, 0]][:, None]) <= slack
        found: list[Face] = []
        free = areas > 0
        for index in np.argsort(-areas).tolist():
            if not free[index]:
                continue
            face = _face_of(corners[on[index]], units[index])
            # A sliver of a face found before is no face.
            off = np.abs(corners @ face.normal - face.offset) > 2 * slack
            free &= off[sides].any(axis=1)
            free[index] = False
            if not any(face.normal @ other.normal > SAME for other in found):
                found.append(face)
        return tuple(face for face in found if face.normal @ middle < face.offset)

    @property
    def around(self) -> list[list[int]]:
        """Places of the corners of each face among `corners`, in the order of the face."""
        places = {tuple(each): at for at, each in enumerate(self.corners.tolist())}
        return [[places[tuple(each)] for each in face.corners.tolist()] for face in self.faces]

    @cached_property
    def planes(self) -> tuple[Array, Array]:
        """Normals, (faces, 3), and offsets, (faces,), of its faces."""
        normals = np.array([face.normal for face in self.faces])
        return normals, np.array([face.offset for face in self.faces])

    def with_slack(self, slack: float) -> Polyhedron:
        """Return the same, whose corners may lie as far off the planes of its faces [m]."""
        other = object.__new__(Polyhedron)
        vars(other).update(vars(self), thickness=self.thickness, slack=slack)
        vars(other).pop("faces", None)
        vars(other).pop("planes", None)
        return other

    @cached_property
    def thickness(self) -> float:
        """The least distance between two planes around it, one of which is a face's [m]."""
        areas, units = vars(self)["_areas"], vars(self)["_units"]
        heights = units[areas > 1e-6 * areas.max()] @ self.corners.T
        return float((heights.max(axis=1) - heights.min(axis=1)).min())

    @cached_property
    def edges(self) -> Array:
        """Ends of its edges, (k, 2, 3)."""
        ends: dict[tuple[tuple[float, ...], ...], None] = {}
        for face in self.faces:
            around = [tuple(each) for each in face.corners.tolist()]
            for start, end in zip(around, around[1:] + around[:1], strict=True):
                ends[min(start, end), max(start, end)] = None
        return np.array(list(ends))

    @cached_property
    def _mass(self) -> tuple[float, Array]:
        """Volume [m3] and centroid [m]: of tetrahedra from one point within."""
        about = self.corners.mean(axis=0)
        legs = self.triangles - about
        volumes = np.linalg.det(legs) / 6
        volume = float(volumes.sum())
        centre = (volumes[:, None] * legs.sum(axis=1)).sum(axis=0) / (4 * volume)
        return volume, about + centre

    @property
    def volume(self) -> float:
        """Its volume [m3]."""
        return self._mass[0]

    @property
    def centroid(self) -> Array:
        """Its centroid [m], (3,)."""
        return self._mass[1]

    def second_moment(self, about: Array) -> Array:
        """Return the integral of ``x x^T`` over it, x from a point [m5], (3, 3).

        `about`, (3,).
        """
        legs = self.triangles - about
        sums = legs.sum(axis=1)
        # Of a tetrahedron with its tip at the point.
        each = np.einsum("tki,tkj->tij", legs, legs) + sums[:, :, None] * sums[:, None]
        return np.einsum("t,tij->ij", np.linalg.det(legs), each) / 120


def _crosses(triangles: Array) -> Array:
    """Return normals of triangles, (k, 3), twice as long as their areas."""
    (a, b, c), (x, y, z) = (triangles[:, 1:] - triangles[:, :1]).transpose(1, 2, 0)
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)


def _face_of(plane: Array, near: Array) -> Face:
    """Return the face of points that lie nearly in a plane, about a normal near to its own.

    Its normal is that of the polygon's area (Newell's): corners that were rounded count alike.
    """
    (x, y, z), count = plane.sum(axis=0).tolist(), len(plane)
    x, y, z = x / count, y / count, z / count
    (a, b, c), (d, e, f) = across(near.tolist())
    arms = [(u - x, v - y, w - z) for u, v, w in plane.tolist()]
    angles = [math.atan2(d * u + e * v + f * w, a * u + b * v + c * w) for u, v, w in arms]
    order = sorted(range(count), key=angles.__getitem__)
    around = [arms[at] for at in order]
    i = j = k = 0.0
    for (u, v, w), (p, q, r) in zip(around, around[1:] + around[:1], strict=True):
        i, j, k = i + v * r - w * q, j + w * p - u * r, k + u * q - v * p
    long = math.sqrt(i * i + j * j + k * k)
    i, j, k = i / long, j / long, k / long
    return Face(np.array([i, j, k]), i * x + j * y + k * z, plane[order])


def frame(normal: Array) -> Array:
    """Return two unit vectors across a normal, (2, 3): right-handed with it.

    Examples
    --------
    >>> import numpy as np
    >>> frame(np.array([0.0, 0.0, 1.0])) + 0.0
    array([[1., 0., 0.],
           [0., 1., 0.]])
    """
    return np.array(across(normal.tolist()))


def across(normal: Sequence[float]) -> tuple[Vector, Vector]:
    """Return the same of plain numbers."""
    a, b, c = normal
    # Away from the axis that is nearest to being across already.
    sizes = [abs(a), abs(b), abs(c)]
    least = sizes.index(min(sizes))
    first = [-normal[least] * each for each in normal]
    first[least] += 1.0
    x, y, z = first
    long = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / long, y / long, z / long
    return (x, y, z), (b * z - c * y, c * x - a * z, a * y - b * x)
