"""Blocks as bodies of a Bullet space: at rest, in motion, and once they may meet others.

How a near-critical arch has to be put into it, each point measured:

- Hulls are unfit: they get one contact point a step, or rounded corners. A block has a
  thin box on each side of a joint, which Bullet collides exactly.
- Each box is a link of its block, fixed to it. So the two boxes of a joint touch each other
  and nothing else, and have the joint's friction. Bullet bounds friction of such bodies anew
  in each sweep; that of bodies without links it leaves where pressure is lost.
- Corners that coincide make contact points jump. One face of each joint reaches beyond
  the other by a `LEDGE`, along the joint and in depth: the contacts are those of the
  smaller face, whose corners are true.
- Bodies sink until they overlap by the slop, so they start with just that overlap.
- Points of contact closer than Bullet's breaking threshold replace each other. It is a
  share of a box's size.
- Where gravity lies in the plane so does all motion, by symmetry. Sweeps break it, though:
  of two contacts across the plane the first takes more, and walls rock out of the plane
  for as long as they are solved. There inertias out of the plane are beyond reach (`LOCK`),
  and a joint is so narrow that Bullet makes one contact of two. A million times the true
  ones, as others take, leave a hundred times more that no sweeps remove (1e-6 g).
- Where gravity leans out of the plane inertias are the true ones.

Bullet's x and y are those of the assembly's plane, z is out of it. In that frame the two
directions of friction Bullet chooses at rest lie in the plane and across it.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly
from blocksim.blocks.problem import Problem
from blocksim.engines.boxes import EDGE, Box, Frame, edge, plate
from blocksim.engines.bulletspace import SLOP, Space, State, friction_share
from blocksim.engines.faces import LEDGE, LEDGE_SHARE, Side, reaching, sides_of
from blocksim.engines.solids import Solids, prisms

OVERLAP = SLOP
"""Of two closed faces: they would sink until they overlap by it [size]."""
LOCK = 1e12
"""Inertias out of the plane where gravity lies in it [mean mass, size squared]."""
NARROW, MERGED = 0.04, 0.1
"""Depth of a joint there, in units of its length, and Bullet's breaking threshold, in units
of half a box's diagonal: contacts across the plane are one, those along it are two."""
TIE = 1e-11
"""Angle between the boxes of a joint: Bullet takes the normal of the longer one, always."""
BREAKING = 0.1
"""Distance at which contact points count as one else, in units of the shortest joint."""
MOST_BREAKING = 0.02
"""Bullet's own such distance, in units of a block's size."""


class Built(NamedTuple):
    """Bodies in a space.

    Parameters
    ----------
    bodies : list of int
        Of each block.
    joints : dict
        By two bodies and the link of each, as `bulletspace.Contact.pair`: the joints at which
        they touch, and 1 if the first is `after`, else -1.
    """

    bodies: list[int]
    joints: dict[tuple[int, int, int, int], list[tuple[int, float]]]


Ends = dict[int, list[tuple[int, int, float]]]
"""By joint, for each side: a body, a link of it, 1 if on `after` and else -1."""


def place_of(frame: Frame, assembly: Assembly, index: int) -> list[float]:
    """Return where the body of a block, or of the support, is built."""
    blocks, at_rest = assembly.blocks, index == SUPPORT
    return frame.place(np.zeros(2) if at_rest else blocks[index].centre / assembly.size)


def breaking_of(problem: Problem) -> float:
    """Return the breaking threshold for blocks with links."""
    return MERGED if problem.is_planar else _breaking(problem.assembly)


def linked(space: Space, problem: Problem, reaches: Array | None = None) -> Built:
    """Create a body with links for each block, and one for the support.

    Parameters
    ----------
    space : Space
    problem : Problem
    reaches : (joints, 2) float, optional
        How far the sides of each joint reach into each other at its ends [size].
    """
    boxes, bodies = _boxes(problem, reaches), list[int]()
    ends: Ends = defaultdict(list)
    for index in [*range(len(problem.assembly.blocks)), SUPPORT]:
        its = boxes[index]
        shares = [friction_share(problem.friction[each.joint]) for each in its]
        place, masses = place_of(space.frame, problem.assembly, index), _masses(problem, index)
        body = space.linked([each.box for each in its], shares, place, masses)
        for link, each in enumerate(its):
            ends[each.joint].append((body, link, each.sense))
        bodies.append(body)
    return Built(bodies[:-1], _meet(space, ends))


def can_be_layered(problem: Problem) -> bool:
    """Tell whether blocks can be bodies without links.

    Such a body has one friction, and its boxes cannot be told whom to touch. So they lie
    in layers: in the plane it does not matter where across it a joint is.
    """
    joints = problem.assembly.joint_arrays
    between = (joints.before != SUPPORT) & (joints.after != SUPPORT)
    is_one = not (problem.friction[between] != problem.mu).any()
    return problem.is_planar and is_one and problem.mu > 0


def layered(space: Space, problem: Problem) -> Built:
    """Build anew, of bodies without links, and those of the support one for each joint."""
    assembly, mu = problem.assembly, friction_share(problem.mu)
    layers = _layers(assembly)
    space.clear(_breaking(assembly, layers.max()))
    boxes, bodies = _boxes(problem), list[int]()
    ends: Ends = defaultdict(list)
    blocks = [(index, boxes[index]) for index in range(len(assembly.blocks))]
    for index, its in [*blocks, *((SUPPORT, [each]) for each in boxes[SUPPORT])]:
        # What a block has of a pair's friction is the same everywhere.
        own = mu
        if index == SUPPORT:
            own = friction_share(problem.friction[its[0].joint]) ** 2 / mu
        placed = [
            replace(box, centre=[*box.centre[:2], float(layers[joint])])
            for joint, _, box in its
        ]
        place = place_of(space.frame, assembly, index)
        body = space.layered(placed, own, place, _masses(problem, index))
        for each in its:
            ends[each.joint].append((body, -1, each.sense))
        bodies.append(body)
    joints = _meet(space, ends)
    space.step()
    space.pull(problem.gravity)
    return Built(bodies[: len(blocks)], joints)


def solid(space: Space, problem: Problem, solids: Solids, states: Sequence[State]) -> list[int]:
    """Build anew, blocks in given states as they are, what they stand on and the floor."""
    assembly, own = problem.assembly, friction_share(problem.mu)
    space.clear(_breaking(assembly))
    polygons: dict[int, list[Array]] = defaultdict(list)
    for index, polygon in solids.moving:
        polygons[index].append(polygon)
    bodies = list[int]()
    for index, state in enumerate(states):
        text = prisms(polygons[index], float(assembly.depths[index]))
        bodies.append(space.hulls(text, own, list(state.place), _masses(problem, index)))
    # As deep as it is drawn.
    deep = float(assembly.depths.max())
    for polygon in solids.fixed:
        middle = polygon.mean(axis=0)
        space.hulls(prisms([polygon - middle], deep), own, space.frame.place(middle))
    space.floor(own, space.frame.place(np.array([0.0, solids.level])))
    space.step()
    for body, state in zip(bodies, states, strict=True):
        space.put(body, state)
    space.pull(problem.gravity)
    return bodies


def _masses(problem: Problem, index: int) -> list[float] | None:
    """Return the mass of a block and its inertias about x, y and z; a support has none."""
    if index == SUPPORT:
        return None
    mass, _, inertia, _, *across = problem.assembly.spatial_masses[index].tolist()
    return [mass, *([LOCK, LOCK] if problem.is_planar else across), inertia]


def _meet(space: Space, ends: Ends) -> dict[tuple[int, int, int, int], list[tuple[int, float]]]:
    """Let the two sides of each joint touch each other."""
    joints: dict[tuple[int, int, int, int], list[tuple[int, float]]] = defaultdict(list)
    for joint, ((one, first, sense), (other, second, against)) in ends.items():
        joints[one, other, first, second].append((joint, sense))
        joints[other, one, second, first].append((joint, against))
        space.meet(one, other, first, second)
    return joints


class Touching(NamedTuple):
    """What touches on a body: a joint, 1 if on `after` and else -1, a box."""

    joint: int
    sense: float
    box: Box


def _boxes(problem: Problem, reaches: Array | None = None) -> dict[int, list[Touching]]:
    """Return what touches on each body; see `linked`."""
    assembly = problem.assembly
    found: dict[int, list[Touching]] = defaultdict(list)
    for joint, sides in enumerate(sides_of(assembly)):
        deep, pair = _depths(problem, sides), sides
        if reaches is not None:
            pair = reaching(sides, assembly.joint_arrays.ends[joint], reaches[joint])
        for side, depth, sense in zip(pair, deep, (-1.0, 1.0), strict=True):
            at_rest = side.body == SUPPORT
            origin = np.zeros(2) if at_rest else assembly.centres[side.body] / assembly.size
            box = (edge if side.is_corner else plate)(side, depth, origin, OVERLAP)
            turned = box.turned(math.pi + TIE * (sense > 0))
            found[side.body].append(Touching(joint, sense, turned))
    return found


def _depths(problem: Problem, sides: tuple[Side, Side]) -> tuple[float, float]:
    """Tell how deep both boxes of a joint are, of which the longer is deeper, too."""
    lengths = [side.length for side in sides]
    if problem.is_planar:
        depth = NARROW * (min(lengths) or EDGE)
        more = depth * LEDGE_SHARE
    else:
        depths = problem.assembly.depths
        depth = min(float(depths[each.body]) for each in sides if each.body != SUPPORT)
        more = 2 * LEDGE
    return (depth, depth + more) if lengths[1] > lengths[0] else (depth + more, depth)


def _layers(assembly: Assembly) -> Array:
    """Return where across the plane joints are, (joints,).

    Of two blocks that meet all sides may touch, not those of their joint alone. So each
    joint of either is in a layer of its own: sides of others reach into each other where
    a voussoir is narrow (at eta = 2 the intrados is a point).
    """
    joints_of: dict[int, set[int]] = defaultdict(set)
    meets: dict[int, set[int]] = defaultdict(set)
    blocks = [{joint.before, joint.after} - {SUPPORT} for joint in assembly.joints]
    for index, its in enumerate(blocks):
        for block in its:
            joints_of[block].add(index)
            meets[block] |= its
    found: list[int] = []
    for its in blocks:
        near = {joint for one in its for other in meets[one] for joint in joints_of[other]}
        taken = {found[joint] for joint in near if joint < len(found)}
        found.append(next(k for k in itertools.count() if k not in taken))
    spacing = 2 * NARROW * max(assembly.joint_arrays.length.max(), EDGE)
    return np.array(found) * spacing


def _breaking(assembly: Assembly, across: float = 0.0) -> float:
    """Return a breaking threshold that the shortest joint is longer than."""
    reach = float(assembly.reach.max()) / assembly.size + across
    reach += float(assembly.depths.max()) / 2
    return min(MOST_BREAKING, BREAKING * assembly.shortest / reach)
