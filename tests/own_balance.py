"""Linear programmes of statics, put together apart from the package.

Those of the suite's scenes read what engines read, find contacts by themselves, and ask whether
forces balance; that of an assembly takes its joints.
"""

import itertools
import math
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix
from scipy.spatial import ConvexHull
from shapely.geometry import MultiPoint, Polygon

from blocksim import Assembly

SIDES = 64
"""Sides of the pyramids within a cone of friction, and around it: 0.12 % between them."""


def by_contact_forces(scene: dict[str, Any]) -> bool:
    """Whether forces at corners on faces balance a scene's file: a programme of its own.

    It reads what engines read, finds contacts by distance, and knows nothing of blocksim.
    """
    bodies = [each for each in scene["bodies"] if not each["fixed"]]
    place = {each["name"]: at for at, each in enumerate(bodies)}
    load = np.zeros((len(bodies), 3))
    for at, body in enumerate(bodies):
        load[at, :2] = body["mass"] * np.array(scene["gravity"])
    for push in scene["pushes"]:
        at = place[push["body"]]
        arm, force = np.subtract(push["point"], bodies[at]["centre"]), np.array(push["force"])
        load[at] += [*force, arm[0] * force[1] - arm[1] * force[0]]
    shapes = [(each, np.array(s)) for each in scene["bodies"] for s in each["polygons"]]
    columns: list[np.ndarray] = []
    for one, face in shapes:
        for start, end in zip(face, np.roll(face, -1, axis=0), strict=True):
            length = math.dist(start, end)
            along = (end - start) / length
            normal = np.array([along[1], -along[0]])
            for other, corners in shapes:
                if other is one or (one["fixed"] and other["fixed"]):
                    continue
                over = (corners - start) @ along
                # Corners that meet at a point, beside each other, bear nothing.
                if min(over.max(), length) - max(over.min(), 0) < 1e-7:
                    continue
                for corner in corners:
                    s, away = (corner - start) @ along, (corner - start) @ normal
                    if abs(away) > 1e-7 or not -1e-7 < s < length + 1e-7:
                        continue
                    # The other body lies beyond the face, not merely beside its end.
                    if ((corners - start) @ normal).min() < -1e-7:
                        continue
                    for slope in (-scene["friction"], scene["friction"]):
                        force, column = normal + slope * along, np.zeros((len(bodies), 3))
                        for body, sign in ((other, 1), (one, -1)):
                            if not body["fixed"]:
                                arm = corner - body["centre"]
                                moment = arm[0] * force[1] - arm[1] * force[0]
                                column[place[body["name"]]] += sign * np.array([*force, moment])
                        columns.append(column.ravel())
    return balanced(columns, load)


def faces_of(corners: np.ndarray) -> list[tuple[np.ndarray, float, np.ndarray]]:
    """Outward normal, offset and corners of each face of a hull."""
    hull, found = ConvexHull(corners), list[tuple[np.ndarray, float, np.ndarray]]()
    for *normal, offset in hull.equations:
        if not any(np.dot(normal, other) > 1 - 1e-9 for other, _, _ in found):
            on = np.abs(corners @ normal + offset) < 1e-7
            found.append((np.array(normal), -offset, corners[on]))
    return found


def by_pyramids(scene: dict[str, Any], grown: float) -> bool:
    """Whether forces in pyramids at shared corners of faces balance a scene's file in space.

    It reads what engines read, finds faces that lie on each other, and knows nothing of
    blocksim. `grown` is 1 of pyramids within the cones.
    """
    moving = [each for each in scene["bodies"] if not each["fixed"]]
    place = {each["name"]: at for at, each in enumerate(moving)}
    load = np.zeros((len(moving), 6))
    for at, body in enumerate(moving):
        load[at, :3] = body["mass"] * np.array(scene["gravity"])
    shapes = [
        (body, faces_of(np.array(shape)))
        for body in scene["bodies"]
        for shape in body["polyhedra"]
    ]
    columns: list[np.ndarray] = []
    for (one, ours), (other, theirs) in itertools.combinations(shapes, 2):
        if one is other or (one["fixed"] and other["fixed"]):
            continue
        for (normal, offset, face), (opposite, back, facing) in itertools.product(ours, theirs):
            if normal @ opposite > -1 + 1e-9 or abs(offset + back) > 1e-7:
                continue
            across = np.linalg.svd(normal[None])[2][1:]
            shared = MultiPoint(face @ across.T).convex_hull.intersection(
                MultiPoint(facing @ across.T).convex_hull
            )
            if not isinstance(shared, Polygon) or shared.area < 1e-9:
                continue
            for spot in np.array(shared.exterior.coords)[:-1]:
                point = spot @ across + offset * normal
                for angle in 2 * math.pi * np.arange(SIDES) / SIDES:
                    way = math.cos(angle) * across[0] + math.sin(angle) * across[1]
                    force = normal + grown * scene["friction"] * way
                    column = np.zeros((len(moving), 6))
                    for body, sign in ((other, 1), (one, -1)):
                        if not body["fixed"]:
                            moment = np.cross(point - body["centre"], force)
                            column[place[body["name"]]] += sign * np.append(force, moment)
                    columns.append(column.ravel())
    return balanced(columns, load)


def balanced(columns: list[np.ndarray], load: np.ndarray) -> bool:
    """Whether forces that push, a column each, balance loads of bodies.

    What they leave at least is sought, which is always found: whether none is left is not
    asked of a solver that may not know.
    """
    matrix, free = np.array(columns).T, np.eye(load.size)
    cost = np.append(np.zeros(len(columns)), np.ones(2 * load.size))
    found = linprog(
        cost, A_eq=np.hstack([matrix, free, -free]), b_eq=-load.ravel() / np.abs(load).max(),
        bounds=(0, None), method="highs",
    )  # fmt: skip
    assert found.status == 0, found.message
    return bool(found.fun < 1e-7)


def violation(
    assembly: Assembly, mu: float, thickness_used: float = 1.0, friction_used: float = 1.0
) -> float:
    """Least excess over strength at any joint, at most 0.01 below it, in units of weight.

    Unknowns are the normal force, the shear and the moment about the middle of every
    joint, as its `before` acts on its `after`, and the excess v:
    |M| <= share L/2 N + v and |T| <= share mu N + v.
    """
    joints, blocks = assembly.joints, assembly.blocks
    unit = sum(block.mass for block in blocks) / len(blocks)
    entries: list[tuple[int, int, float]] = []
    for index, joint in enumerate(joints):
        middle = (joint.inner + joint.outer) / 2
        for body, sign in ((joint.after, 1.0), (joint.before, -1.0)):
            if body < 0:
                continue
            arm = (middle - blocks[body].centre) / assembly.size
            for column, axis in ((0, joint.normal), (1, joint.tangent)):
                turning = arm[0] * axis[1] - arm[1] * axis[0]
                for row, value in enumerate((axis[0], axis[1], turning)):
                    entries.append((3 * body + row, 3 * index + column, sign * value))
            entries.append((3 * body + 2, 3 * index + 2, sign))
    size = 3 * len(joints) + 1
    rows, columns, values = zip(*entries, strict=True)
    balance = coo_matrix((values, (rows, columns)), shape=(3 * len(blocks), size))
    load = np.zeros((len(blocks), 3))
    load[:, 1] = [block.mass / unit for block in blocks]
    limits: list[np.ndarray] = []
    for index, joint in enumerate(joints):
        half = thickness_used * joint.length / assembly.size / 2
        for offset, strength in ((2, half), (1, friction_used * mu)):
            for sign in (1.0, -1.0):
                if math.isinf(strength):
                    continue
                row = np.zeros(size)
                row[3 * index + offset], row[3 * index], row[-1] = sign, -strength, -1.0
                limits.append(row)
    cost = np.zeros(size)
    cost[-1] = 1.0
    kinds = [(0, None), (None, None), (None, None)] * len(joints)
    found = linprog(
        cost,
        A_ub=np.array(limits),
        b_ub=np.zeros(len(limits)),
        A_eq=balance.tocsr(),
        b_eq=load.ravel(),
        bounds=[*kinds, (-0.01, None)],
        method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert found.status == 0, found.message
    return float(found.fun)
