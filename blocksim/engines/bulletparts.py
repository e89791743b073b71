"""How bodies of Bullet are made of blocks, in the plane and in space alike."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.engines.boxes import Box
from blocksim.engines.bulletspace import Space, State, friction_share

Masses = list[float] | None
"""Of a block, and its moments of inertia; a support has none."""
Joints = dict[tuple[int, int, int, int], list[tuple[int, float]]]
"""By two bodies and the link of each, as `bulletspace.Contact.pair`: the joints at which they
touch, and 1 if the first is `after`, else -1."""
Ends = dict[int, list[tuple[int, int, float]]]
"""By joint: on its first side a body, a link of it, 1 if on `after` and else -1; then what it
touches on the other, likewise."""


class Link(NamedTuple):
    """What touches on a body: a joint, 1 if on `after` and else -1, and a box.

    `rubs`, (2,): Sides of the rectangle its friction is held within; None for a cone.
    """

    joint: int
    sense: float
    box: Box
    rubs: Array | None = None


def linked(
    space: Space,
    links: Mapping[int, Sequence[Link]],
    built: Sequence[State],
    masses: Callable[[int], Masses],
    friction: Array,
) -> tuple[list[int], Ends]:
    """Create a body with links for each block; the last one is that of all supports.

    `links`: By block, or `SUPPORT`.
    `built`: How bodies are built, the last one that of supports.
    `masses`: Masses of a block.
    `friction`, (joints,).
    """
    bodies = list[int]()
    ends: Ends = defaultdict(list)
    for index, state in zip([*range(len(built) - 1), SUPPORT], built, strict=True):
        its = links[index]
        shares = [friction_share(friction[each.joint]) for each in its]
        body = space.linked([each.box for each in its], shares, state, masses(index))
        for link, each in enumerate(its):
            ends[each.joint].append((body, link, each.sense))
            if each.rubs is not None:
                share = friction_share(friction[each.joint])
                space.rectangles.narrow(body, link, share**2, each.rubs)
        bodies.append(body)
    return bodies, ends


def met(space: Space, ends: Ends) -> Joints:
    """Let the two sides of each joint touch each other."""
    joints: Joints = defaultdict(list)
    for joint, ((one, first, sense), *others) in ends.items():
        for other, second, against in others:
            joints[one, other, first, second].append((joint, sense))
            joints[other, one, second, first].append((joint, against))
            space.meet(one, other, first, second)
    return joints


def let_go(
    space: Space, bodies: list[int], states: Iterable[State], gravity: Array
) -> list[int]:
    """Let bodies that were created lie and move as in given states, and gravity act."""
    space.step()
    for body, state in zip(bodies, states, strict=True):
        space.put(body, state)
    space.pull(gravity)
    return bodies
