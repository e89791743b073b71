"""Assemblies from polygons alone: joints are found where blocks touch."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Block, Joint, Support
from blocksim.blocks.bodies import connected
from blocksim.blocks.given import Body as Body
from blocksim.blocks.given import GivenJoint, as_given
from blocksim.blocks.outlines import Extents, extents, step_of
from blocksim.blocks.regions import hull, near_faces, overlaps
from blocksim.blocks.rows import Rows
from blocksim.blocks.shapes import Shape, finite, name_of, shapes_of
from blocksim.blocks.touching import Slack, Touch, faces_of_polygons, merged, touches
from blocksim.common.checks import COORDINATE, INERTIA, LENGTH, MASS, require
from blocksim.common.errors import InputError
from blocksim.common.words import counted

TOLERANCE = 1e-6
"""Distance within which blocks touch, in units of half the larger side of the smaller one."""
ROUNDED = 1.5
"""Steps of rounding by which faces may part: three points are off by 0.71 steps at most."""
NARROW, NARROW_ASKED = 1 / 40, 1 / 4
"""Share of a block's width up to which gaps are closed: due to rounding, and asked for."""
SHOWN = 5
"""Pairs of blocks that a line names."""
MOST_BLOCKS = 100_000
_ROUNDING = 64 * np.finfo(float).eps


def assembly_of_polygons(polygons: Sequence[ArrayLike], *, fixed: Collection[int]) -> Assembly:
    """Build an assembly of polygons; its joints are where they touch.

    Parameters
    ----------
    polygons : sequence of (k, 2) array-like
        Corners of each body [m].
    fixed : collection of int
        Which of them stay where they are.

    Raises
    ------
    InputError
        As `assembly_of_bodies`.

    Examples
    --------
    >>> floor, box = [[-1, -1], [2, -1], [2, 0], [-1, 0]], [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> built = assembly_of_polygons([floor, box], fixed={0})
    >>> len(built.blocks), len(built.joints)
    (1, 1)
    """
    bodies = [
        Body(polygons=(corners,), name=str(index), fixed=index in fixed)
        for index, corners in enumerate(polygons)
    ]
    return assembly_of_bodies(bodies)[0]


def assembly_of_bodies(
    bodies: Sequence[Body],
    *,
    joints: Sequence[GivenJoint] | None = None,
    density: float = 1.0,
    size: float | None = None,
    tolerance: float | None = None,
    rounding: float | None = None,
) -> tuple[Assembly, tuple[str, ...]]:
    """Build an assembly, and say what was mended.

    `joints`: Taken as they are; by default found (see `touching.touches`).
    `density`: Weight per volume [N/m^3] of bodies without a weight.
    `size`: Characteristic length [m]; by default half the larger extent of what can move.
    `tolerance`: Gaps and overlaps up to this are closed [m]; by default what rounding explains.
    `rounding`: Step to which coordinates were rounded [m]; by default as their decimals say.
    Returns: Blocks that move in the order of the bodies. Found joints are ordered by `before`
        and `after`, those with supports first, `before` them.
    Returns: What was mended, taken or nearly found.
    """
    (raw, size), notes = _sound(bodies, size), list[str]()
    if rounding is None:
        rounding = step_of(np.concatenate([each.ravel() for of in raw for each in of]))
    measured = extents(raw)
    exact = np.maximum(TOLERANCE * measured.wide / 2, _ROUNDING * measured.far)
    fixed_ones = np.array([body.fixed for body in bodies])
    slack = _slack(measured, exact, fixed_ones, rounding, tolerance)
    shapes = shapes_of(raw, bodies, exact, notes)
    if joints is None:
        found = [(touch, None) for touch in _found(shapes, bodies, slack, notes)]
        notes += _said(found, bodies, slack, rounding, tolerance)
    else:
        found = _taken(joints, shapes, bodies, slack, exact, notes)
    _require_held(found, bodies)
    moving, fixed = np.flatnonzero(~fixed_ones).tolist(), np.flatnonzero(fixed_ones).tolist()
    blocks = _blocks(bodies, shapes, moving, density)
    supports = tuple(Support(shapes[index].parts, bodies[index].name) for index in fixed)
    made = _joints(found, moving, fixed)
    # Those found lead from `before` to `after`: none has to be made to be turned.
    every = made if joints is None else tuple(made)
    return Assembly(blocks, every, size, supports), tuple(notes)


def _sound(bodies: Sequence[Body], size: float | None) -> tuple[list[tuple[Array, ...]], float]:
    """Return polygons of bodies, and the characteristic length, where they may be built."""
    require(0 < len(bodies) <= MOST_BLOCKS, "blocks", len(bodies), f"1 to {MOST_BLOCKS}")
    raw = [finite(body, index) for index, body in enumerate(bodies)]
    moving = [index for index, body in enumerate(bodies) if not body.fixed]
    require(bool(moving), "blocks", "all fixed", "at least one that is not fixed")
    held = (
        "at least one with fixed = true (drawings: on the layer supports; compas: is_support)"
    )
    require(len(moving) < len(bodies), "blocks", "none fixed", held)
    points = np.concatenate([polygon for index in moving for polygon in raw[index]])
    size = float(np.ptp(points, axis=0).max()) / 2 if size is None else size
    require(size > 0, "blocks", "no extent", "polygons with an area")
    farthest = max(float(np.abs(polygon).max()) for polygons in raw for polygon in polygons)
    said, most = f"coordinates up to {farthest:g} m", TOLERANCE * size / _ROUNDING
    require(COORDINATE.has(farthest), "blocks", said, COORDINATE.words)
    allowed = f"below {most:.3g} m for this size: move the drawing to its origin"
    require(farthest <= most, "blocks", said, allowed)
    return raw, size


def _require_apart(
    shapes: Sequence[Shape], bodies: Sequence[Body], fixed: NDArray[np.bool_], slack: Slack
) -> None:
    """Raise `InputError` where bodies overlap; the first overlap is enough."""
    for one, other, depth in overlaps([shape.parts for shape in shapes], fixed, slack, 1):
        most = float(slack.at(one, other).close)
        raise InputError(
            f"overlap of blocks {name_of(bodies, one)} and {name_of(bodies, other)}",
            f"{depth:.3g} m",
            f"at most {most:.3g} m: move one of them, give the joints, or --tolerance",
        )


def _taken(
    joints: Sequence[GivenJoint],
    shapes: Sequence[Shape],
    bodies: Sequence[Body],
    slack: Slack,
    exact: Array,
    notes: list[str],
) -> list[tuple[Touch, float | None]]:
    """Return joints as they are given, each with its own friction."""
    fixed = np.array([body.fixed for body in bodies])
    deep = overlaps([shape.parts for shape in shapes], fixed, slack, SHOWN)
    if deep:
        pairs = [(one, other) for one, other, _ in deep]
        notes.append(f"overlaps taken, as joints are given: {_pairs(bodies, pairs)}")
    outlines = [shape.outlines for shape in shapes]
    names = [name_of(bodies, index) for index in range(len(bodies))]
    found = as_given(joints, outlines, names, exact / TOLERANCE, TOLERANCE, notes)
    notes.append(f"{counted(len(found), 'joint')} as given")
    return found


def _slack(
    measured: Extents,
    exact: Array,
    fixed: NDArray[np.bool_],
    step: float,
    tolerance: float | None,
) -> Slack:
    """How far apart each body may be drawn from others and touch them nevertheless."""
    most, share = ROUNDED * step, NARROW
    least = exact
    if tolerance is not None:
        # Mortar of 10 mm is closed by 10 mm, whatever was rounded.
        most, share = tolerance * (1 + TOLERANCE), NARROW_ASKED
        least = np.minimum(exact, tolerance)
    width = measured.area / np.where(measured.across > 0, measured.across, 1.0)
    close = np.maximum(least, np.minimum(most, share * width))
    return Slack(*(np.where(fixed, np.inf, each) for each in (least, close)))


def _said(
    found: Sequence[tuple[Touch, object]],
    bodies: Sequence[Body],
    slack: Slack,
    step: float,
    tolerance: float | None,
) -> list[str]:
    """Say within what distance joints were found, and what was closed."""
    closed = sorted((touch for touch, _ in found if touch.gap), key=lambda t: -abs(t.gap))
    notes = [f"{counted(len(found), 'joint')} found"]
    if not closed and tolerance is None:
        return [f"{notes[0]}, within {TOLERANCE:g} of the smaller block's size"]
    close = slack.close[np.isfinite(slack.close)]
    why = f"coordinates are rounded to {step:.3g} m" if tolerance is None else "as asked"
    if tolerance is not None and close.max() < tolerance:
        why = f"a quarter of the narrower block; asked: {tolerance:g} m"
    notes[0] += f", within {close.max():.3g} m ({why})"
    if closed:
        pairs = [
            f"{name_of(bodies, each.one)}-{name_of(bodies, each.other)}" for each in closed
        ]
        sizes = [f"{1000 * each.gap:+.3g} mm" for each in closed[:SHOWN]]
        listed = ", ".join(map(" ".join, zip(pairs, sizes, strict=False)))
        more = f" and {len(closed) - SHOWN} more" if len(closed) > SHOWN else ""
        notes.append(f"gaps (+) and overlaps (-) closed at joints: {listed}{more}")
    return notes


def _found(
    shapes: Sequence[Shape], bodies: Sequence[Body], slack: Slack, notes: list[str]
) -> list[Touch]:
    """Find where bodies touch, in a fixed order and sense."""
    fixed = np.array([body.fixed for body in bodies])
    _require_apart(shapes, bodies, fixed, slack)
    outlines = [outline for shape in shapes for outline in shape.outlines]
    owner = [index for index, shape in enumerate(shapes) for _ in shape.outlines]
    faces = faces_of_polygons(outlines, owner)
    found, near = touches(faces, near_faces(faces, fixed, slack), slack)
    if any(len(shape.outlines) > 1 for shape in shapes):
        found = merged(found, slack)

    def sense(touch: Touch) -> Touch:
        before = (not bodies[touch.one].fixed, touch.one)
        after = (not bodies[touch.other].fixed, touch.other)
        return touch if before < after else touch.turned()

    def order(touch: Touch) -> tuple[float, ...]:
        before = SUPPORT if bodies[touch.one].fixed else touch.one
        return before, touch.other, touch.one, *touch.ends.ravel().tolist()

    found = sorted((sense(touch) for touch in found), key=order)
    if near:
        one, other = np.array(near).T
        here = slack.at(one, other)
        close = f"{here.close.max():.3g} m"
        notes.append(
            f"nearly touching, more than {close} apart or along less than "
            f"{here.near.max():.3g} m, so no joint there: {_pairs(bodies, near)}"
        )
    return found


def _pairs(bodies: Sequence[Body], pairs: Sequence[tuple[int, int]]) -> str:
    """Name pairs of blocks, not more than a line holds."""
    shown = [f"{name_of(bodies, a)} and {name_of(bodies, b)}" for a, b in sorted(set(pairs))]
    more = f" and {len(shown) - SHOWN} pairs more" if len(shown) > SHOWN else ""
    return "blocks " + ", ".join(shown[:SHOWN]) + more


def _require_held(found: Sequence[tuple[Touch, object]], bodies: Sequence[Body]) -> None:
    """Check that joints lead from every block to a fixed one, or one that is free."""
    pairs = np.array([(touch.one, touch.other) for touch, _ in found], dtype=np.int64)
    group = connected(len(bodies), *pairs.reshape(-1, 2).T)
    held = group[[body.fixed or body.free for body in bodies]]
    loose = next(iter(np.flatnonzero(~np.isin(group, held)).tolist()), None)
    if loose is not None:
        raise InputError(
            f"block {name_of(bodies, loose)}",
            "held by nothing",
            "joined to a fixed block, directly or by others: close the gap, or by a larger "
            "tolerance, give its joints, or say that it is free",
        )


def _blocks(
    bodies: Sequence[Body], shapes: Sequence[Shape], moving: Sequence[int], density: float
) -> Rows[Block]:
    """Return the blocks that move, those of numbers out of range made: they are refused."""
    made: list[dict[str, Any]] = []
    for at in moving:
        parts, one = shapes[at].parts, len(shapes[at].parts) == 1
        corners = {"vertices": parts[0] if one else hull(parts), "parts": () if one else parts}
        made.append({**corners, **bodies[at].measured(parts, at, density)})
    blocks = Rows(Block, **{name: [each[name] for each in made] for name in made[0]})
    for at, each in enumerate(made):
        numbers = MASS.has(each["mass"]) and INERTIA.has(each["inertia"])
        if not (numbers and LENGTH.has(each["depth"])):
            _ = blocks[at]
    return blocks


def _joints(
    found: Sequence[tuple[Touch, float | None]], moving: Sequence[int], fixed: Sequence[int]
) -> Rows[Joint]:
    """Return joints where bodies touch, with blocks and supports by their own numbers."""
    touching = [touch for touch, _ in found]
    place = dict.fromkeys(fixed, SUPPORT) | {index: at for at, index in enumerate(moving)}
    bed = {index: at for at, index in enumerate(fixed)}
    ends = np.reshape([touch.ends for touch in touching], (-1, 2, 2))
    return Rows(
        Joint,
        before=[place[touch.one] for touch in touching],
        after=[place[touch.other] for touch in touching],
        inner=ends[:, 0],
        outer=ends[:, 1],
        friction=[own for _, own in found],
        across=[touch.normal for touch in touching],
        faces=[
            None if (touch.faces == touch.ends).all() else touch.faces for touch in touching
        ],
        support=[bed.get(touch.one, bed.get(touch.other)) for touch in touching],
        gap=[touch.gap for touch in touching],
    )
