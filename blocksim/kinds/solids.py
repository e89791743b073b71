"""Shapes that kinds in space are made of."""

from __future__ import annotations

import math

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.assembly import Solid

Ends = tuple[float, float]


def box(name: str, x: Ends, y: Ends, z: Ends, *, fixed: bool = False) -> Solid:
    """Make a box between two places along each axis [m]."""
    corners = [[a, b, c] for a in x for b in y for c in z]
    return Solid(parts=(corners,), name=name, fixed=fixed)


def ground(half: float, deep: float) -> Solid:
    """Make a fixed box below z = 0, square in plan about the origin [m]."""
    return box("ground", (-half, half), (-half, half), (-deep, 0.0), fixed=True)


def wedge(inner: Array, outer: Array, start: float, end: float) -> Array:
    """Turn a piece of a meridian about the z axis, from one azimuth to another.

    `inner`, `outer`, (2, 2): Distance from the axis and height of its corners, lower and upper
        [m].
    `start`, `end`: Azimuths [rad].
    Returns (8, 3).
    """
    meridian = np.concatenate([inner, outer])
    return np.array(
        [[d * math.cos(at), d * math.sin(at), z] for at in (start, end) for d, z in meridian]
    )


def voussoir(
    radii: Ends, angles: Ends, along: Ends, skew: float, half_angle: float = math.pi / 2
) -> Array:
    """Make a voussoir of a barrel along y, sheared along y by the tangent of the skew times x.

    `radii`, (float, float): Of intrados and extrados [m].
    `angles`, (float, float): Of its two joints from the crown, towards x [rad].
    `along`, (float, float): Its ends at x = 0 [m].
    `skew`: [rad]
    `half_angle`: From the crown to a springing, which lies at z = 0 at the intrados [rad].
    Returns (8, 3).
    """
    low = radii[0] * math.cos(half_angle)
    found: list[list[float]] = []
    for at in angles:
        for radius in radii:
            x, z = radius * math.sin(at), radius * math.cos(at) - low
            found += [[x, y + x * math.tan(skew), z] for y in along]
    return np.array(found)


def abutment(
    name: str, radii: Ends, angle: float, along: Ends, skew: float, half_angle: float
) -> Solid:
    """Make the fixed block behind a springing: its face, drawn out by the thickness."""
    out = math.copysign((radii[1] - radii[0]) / radii[0], angle)
    corners = voussoir(radii, (angle, angle + out / 2), along, skew, half_angle)
    return Solid(parts=(corners,), name=name, fixed=True)
