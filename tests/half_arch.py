"""Statics of half a symmetric arch, as by hand: it knows nothing of blocksim."""

# pyright: reportUnknownMemberType=false

import itertools
import math
from typing import Any

import numpy as np
from scipy.optimize import linprog
from shapely.geometry import LinearRing, Point, Polygon, box

FAR = 99.0
"""Beyond all scenes [m]."""


def by_half(scene: dict[str, Any]) -> bool:
    """Whether half of a symmetric arch, on piers or not, stands: two unknowns, as by hand.

    They are the thrust across the crown and its moment. Below each block on the way down the
    resultant of both and of the weight above must lie within the joint, and within friction.
    """
    right = box(0, -FAR, FAR, FAR)
    halves = [
        (half, 0.0 if each["fixed"] else each["mass"] / shape.area, shape)
        for each in scene["bodies"]
        for shape in (Polygon(each["polygons"][0]),)
        if isinstance(half := shape.intersection(right), Polygon) and half.area > 1e-9
    ]
    crowns = [each for each in halves if each[1] and each[0].bounds[0] < 1e-9]
    block = max(crowns, key=lambda each: each[0].centroid.y)
    weight, moment, rows = 0.0, 0.0, list[np.ndarray]()
    # A joint in the middle bears the thrust alone; in a keystone there is none.
    corners = np.array(block[2].exterior.coords[:-1])
    joint = corners[np.abs(corners[:, 0]) < 1e-9] if block[0].equals(block[2]) else None
    while True:
        if joint is not None:
            start, end = joint
            if not LinearRing([start, end, block[0].centroid.coords[0]]).is_ccw:
                start, end = end, start
            length = math.dist(start, end)
            along = (end - start) / length
            # Of thrust, its moment, and what is known; the weight pulls down.
            press = np.array([-along[1], 0.0, -weight * along[0]])
            slip = np.array([along[0], 0.0, -weight * along[1]])
            about = np.array([start[1], 1.0, weight * start[0] - moment])
            mu = scene["friction"]
            rows += [-press, slip - mu * press, -slip - mu * press, -about]
            rows.append(about - length * press)
        if not block[1]:
            break
        halves.remove(block)
        weight += block[0].area * block[1]
        moment += block[0].area * block[1] * block[0].centroid.x
        ((joint, block),) = [
            (shared, each) for each in halves if len(shared := ends(block[0], each[0])) == 2
        ]
    known = np.array(rows) / [1.0, 1.0, weight]
    found = linprog([0, 0], A_ub=known[:, :2], b_ub=-known[:, 2], bounds=(None, None))
    return found.status == 0


def ends(one: Polygon, other: Polygon) -> np.ndarray:
    """Ends of what two polygons share of their sides, none where that is a point at most."""
    spots = [
        np.array(corner)
        for shape, opposite in ((one, other), (other, one))
        for corner in shape.exterior.coords[:-1]
        if opposite.distance(Point(corner)) < 1e-7
    ]
    pairs = itertools.combinations(spots, 2)
    farthest = max(pairs, key=lambda pair: math.dist(*pair), default=None)
    if farthest is None or math.dist(*farthest) < 1e-6:
        return np.empty((0, 2))
    return np.array(farthest)
