"""Blocks as they are written down, and joints given with them, not found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from blocksim.blocks.assembly import Array
from blocksim.blocks.outlines import distances, following, moments
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.touching import Touch
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError

OFF = 0.1
"""How far a joint may lie off both of its faces, in units of half the larger side of the
smaller block: drawn in mortar."""

SQUARE = 0.999
"""Least cosine between a given normal and the one across the ends, to be the same."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """A block as it is written down.

    Parameters
    ----------
    polygons : tuple of (k, 2) array-like
        Corners [m] in either direction; several polygons move as one. None has to be convex.
    name : str
    fixed : bool
        Whether it stays where it is.
    weight : float or None
        [N]; None for `density` times area and depth.
    centre : (2,) array-like or None
        Where the weight acts [m]; None for the centroid.
    inertia : float or None
        Moment of inertia [kg m^2]; None for that of the polygons about their centroid, of
        uniform density: where the weight acts says nothing of how a block turns.
    depth : float
        Out of the plane [m].
    free : bool
        Whether nothing has to hold it.
    """

    polygons: tuple[ArrayLike, ...]
    name: str = ""
    fixed: bool = False
    weight: float | None = None
    centre: ArrayLike | None = None
    inertia: float | None = None
    depth: float = 1.0
    free: bool = False

    def measured(self, parts: tuple[Array, ...], index: int, density: float) -> dict[str, Any]:
        """Return what makes a block of it, besides its corners."""
        measured = moments(parts)
        weight = density * measured.area * self.depth if self.weight is None else self.weight
        field = f"blocks[{index}]"
        require(0 < weight < np.inf, f"{field}.weight", weight, "above 0")
        require(0 < self.depth < np.inf, f"{field}.depth", self.depth, "above 0")
        mass = weight / STANDARD_GRAVITY
        inertia = (
            mass * measured.polar / measured.area if self.inertia is None else self.inertia
        )
        require(0 < inertia < np.inf, f"{field}.inertia", inertia, "above 0")
        centre = measured.centroid
        if self.centre is not None:
            centre = np.array(self.centre, dtype=float)
            finite = centre.shape == (2,) and bool(np.isfinite(centre).all())
            require(finite, f"{field}.centre", self.centre, "two finite numbers")
        return {
            "centre": centre,
            "mass": mass,
            "inertia": inertia,
            "depth": self.depth,
            "name": self.name,
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class GivenJoint:
    """A joint as it is written down.

    Parameters
    ----------
    a, b : int
        Bodies on its two sides.
    ends : (1 or 2, 2) float
        Its ends in either order [m]; one for a corner on a face.
    normal : (2,) float or None
        From `a` into `b`; needed for a corner.
    friction : float or None
        Its own, where it is not that of all others.
    faces : (2, 2, 2) float or None
        Those of `a` and `b` that meet in it, where they are known [m].
    """

    a: int
    b: int
    ends: Array
    normal: Array | None = None
    friction: float | None = None
    faces: Array | None = None


def as_given(
    joints: Sequence[GivenJoint],
    outlines: Sequence[Sequence[Array]],
    names: Sequence[str],
    sizes: Array,
    share: float,
    notes: list[str],
) -> list[tuple[Touch, float | None]]:
    """Lay given joints on the faces of their bodies.

    `outlines`, sequence of sequences of (k, 2): Of each body, counter-clockwise [m].
    `sizes`, (bodies,): Half the larger side of each [m].
    `share`: Tolerance at a joint, in units of the smaller one's size.
    `notes`: To which it adds what was mended.
    Returns list of (Touch, float or None): With its own friction.
    """
    found: list[tuple[Touch, float | None]] = []
    off, farthest = list[str](), 0.0
    for index, joint in enumerate(joints):
        between = f"blocks {names[joint.a]} and {names[joint.b]}"
        faces = _face(outlines[joint.a], joint.ends), _face(outlines[joint.b], joint.ends)
        nearest, size = min(far for far, _ in faces), float(min(sizes[joint.a], sizes[joint.b]))
        laid = _Laid(joint, f"joints[{index}]", between, faces, share * size)
        allowed = f"on a face of {between}: it is {nearest:.3g} m off both"
        require(nearest <= OFF * size, f"{laid.field}.ends", joint.ends.tolist(), allowed)
        if nearest > laid.tolerance:
            farthest = max(farthest, nearest)
            off.append(between)
        found += [(touch, joint.friction) for touch in _touches(laid, outlines, notes)]
    if off:
        notes.append(
            f"{len(off)} joints given lie off their faces, by up to {farthest:.3g} m, "
            f"the first between {off[0]}"
        )
    return found


_Near = tuple[float, Array]
"""How far a joint lies off a face [m], and the face."""


class _Laid(NamedTuple):
    """A joint, its name in the file and in words, and the faces it is nearest to."""

    joint: GivenJoint
    field: str
    between: str
    faces: tuple[_Near, _Near]
    tolerance: float

    @property
    def normal(self) -> Array | None:
        """The normal that is given, of length 1."""
        given = self.joint.normal
        if given is None:
            return None
        way = float(np.hypot(*given))
        require(way > 0, f"{self.field}.normal", given.tolist(), "a direction, not 0, 0")
        return given / way


def _touches(
    laid: _Laid, outlines: Sequence[Sequence[Array]], notes: list[str]
) -> Iterator[Touch]:
    """Return where blocks touch at a joint: along a face, or at one or two corners."""
    joint, (one, other), tolerance = laid.joint, laid.faces, laid.tolerance
    ends, normal = joint.ends, laid.normal
    if len(ends) == 1:
        if normal is None:
            raise InputError(f"{laid.field}.normal", MISSING, "given for a corner on a face")
        yield _corner(joint, ends[0], one, other, normal, tolerance)
        return
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    require(length > tolerance, f"{laid.field}.ends", ends.tolist(), "two points that differ")
    across = np.array([along[1], -along[0]]) / length
    # From a to b: as the faces say on which it lies, or else as the normal says.
    out = _outward(one[1]) if one[0] <= other[0] else -_outward(other[1])
    if normal is not None and abs(float(across @ normal)) < SQUARE:
        words = f"joint of {laid.between}: its normal is not square, so each end is a corner"
        notes.append(words)
        for end in ends:
            on, beside = (_face(outlines[body], end[None]) for body in (joint.a, joint.b))
            yield _corner(joint, end, on, beside, normal, tolerance)
        return
    if normal is not None and float(normal @ out) < 0:
        if min(one[0], other[0]) <= tolerance:
            notes.append(f"joint of {laid.between}: normal turned, it pointed from b to a")
        else:
            out = normal
    if float(across @ out) < 0:
        ends = ends[::-1]
    faces = [ends if far > tolerance else _in_sense(face, ends) for far, face in (one, other)]
    known = np.stack(faces) if joint.faces is None else joint.faces
    yield Touch(joint.a, joint.b, ends, known)


def _face(outlines: Sequence[Array], ends: Array) -> _Near:
    """Return the face nearest to a joint, and how far the joint's farther end is off it."""
    each = [np.stack([outline, following(outline)], axis=1) for outline in outlines]
    sides = np.concatenate(each)
    off = distances(ends[:, None], sides).max(axis=0)
    best = int(off.argmin())
    return float(off[best]), sides[best]


def _outward(face: Array) -> Array:
    way = face[1] - face[0]
    return np.array([way[1], -way[0]]) / np.hypot(*way)


def _in_sense(face: Array, ends: Array) -> Array:
    """Return a face's ends in the order of the joint's."""
    return face if float((face[1] - face[0]) @ (ends[1] - ends[0])) > 0 else face[::-1]


def _corner(
    joint: GivenJoint,
    at: Array,
    one: _Near,
    other: _Near,
    normal: Array,
    tolerance: float,
) -> Touch:
    """Lay a corner on the face that the normal stands on."""
    ends = np.stack([at, at])
    along = np.stack([np.zeros(2), np.array([-normal[1], normal[0]])])
    faces = [
        _in_sense(face, along)
        if off <= tolerance and abs(float(_outward(face) @ normal)) > 0.999
        else ends
        for off, face in (one, other)
    ]
    known = np.stack(faces) if joint.faces is None else joint.faces
    return Touch(joint.a, joint.b, ends, known, normal)
