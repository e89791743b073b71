"""What a maker has made, as blocks and joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Assembly, Block, Joint, Support
from blocksim.blocks.given import Body, GivenJoint
from blocksim.blocks.made import Built, Made
from blocksim.blocks.polygons import assembly_of_bodies
from blocksim.blocks.problem import STANDARD_GRAVITY, Load


def built_of(made: Made, density: float, size: float | None = None) -> Built[Assembly]:
    """Make blocks of bodies, and find their joints where those are not given.

    `size`: Characteristic length [m].
    """
    notes: Sequence[str] = ()
    if made.joints is None:
        assembly, notes = assembly_of_bodies(made.bodies, density=density, size=size)
    else:
        assembly = assembly_as_made(made.bodies, made.joints, size)
    place = np.cumsum([not body.fixed for body in made.bodies]) - 1
    fills = tuple(
        Load(
            force=np.array([0.0, -fill.weight]),
            blocks=(int(place[fill.body]),),
            point=np.array(fill.point),
        )
        for fill in made.fills
    )
    return Built(assembly=assembly, fills=fills, notes=tuple(notes), bodies=made.bodies)


def assembly_as_made(
    bodies: Sequence[Body], joints: Sequence[GivenJoint], size: float | None
) -> Assembly:
    """Build an assembly of bodies with weights, whose joints are whole faces of both.

    Nothing is looked for: a search for the least thickness builds dozens of them.
    """
    moving = [body for body in bodies if not body.fixed]
    place = np.cumsum([not body.fixed for body in bodies]) - 1
    bed = np.cumsum([body.fixed for body in bodies]) - 1
    corners = np.concatenate([np.asarray(body.polygons[0]) for body in moving])
    return Assembly(
        blocks=tuple(
            Block(
                vertices=np.asarray(body.polygons[0]),
                centre=np.asarray(body.centre),
                mass=(body.weight or 0.0) / STANDARD_GRAVITY,
                inertia=body.inertia or 0.0,
                depth=body.depth,
                name=body.name,
            )
            for body in moving
        ),
        joints=tuple(
            Joint(
                before=SUPPORT if bodies[joint.a].fixed else int(place[joint.a]),
                after=SUPPORT if bodies[joint.b].fixed else int(place[joint.b]),
                inner=joint.ends[0],
                outer=joint.ends[1],
                support=next(
                    (int(bed[each]) for each in (joint.a, joint.b) if bodies[each].fixed), None
                ),
            )
            for joint in joints
        ),
        size=float(np.ptp(corners, axis=0).max()) / 2 if size is None else size,
        supports=tuple(
            Support((np.asarray(body.polygons[0]),), body.name) for body in bodies if body.fixed
        ),
    )
