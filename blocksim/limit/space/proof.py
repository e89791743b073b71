"""Proofs in space that blocks stand or fall, in rational numbers, as of `limit.proof`.

A force lies in the cone of friction where its part across the normal is at most mu times that
along it; of both parts squares are compared, so no root is taken. The normal is the vector that
is stored, of whatever length.

- *Stands*: forces of the cone programme lie within their cones, but balance to round-off only.
  What is left on each block is handed on, exactly, over the points of its widest joint, from
  block to block to a support. The sums still lie within the cones, or it is no proof.
- *Falls*: rates open each point by more than the solver leaves over. Where blocks are wedged no
  rates open all points. Then blocks that the mechanism does not part move as one, to the last
  digit, and points between such bodies are opened.

Where friction has no bound points may not slip at all. Corners of a face lie in one plane but
for their last digits, so a hinge slips by those: such a fall is hardly ever proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import islice

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.limit.exact import NOTHING, SLACK, Exact, Number, along_and_across, apart, moment
from blocksim.limit.exact import whole_numbers as whole
from blocksim.limit.handing import borne, fine, ways
from blocksim.limit.proof import Proof
from blocksim.limit.space.contacts import Contacts

Force = list[Number]
Wrench = list[Number]
Forces = list[list[Force]]


def proof_of_rest(exact: Exact, contacts: Contacts, forces: Array) -> Proof | None:
    """Prove that a problem stands.

    `forces`, (points, 3): Along the normal of each point and two ways across, which hardly
        balance [mean weights].
    Returns: None where these forces prove nothing.
    """
    stored, unit = _stored(exact, contacts, forces * contacts.unit)
    times = int(exact.force / unit)
    left: list[Wrench] = [[times * each for each in pull] for pull in exact.pull]
    for joint, each in enumerate(stored):
        for block in exact.sides[joint]:
            if block != SUPPORT:
                left[block] = _sum(left[block], _acting(exact, joint, each, block))
    tolerance = NOTHING
    found = _handed_on(exact, contacts, forces, stored, left)
    if found is None or not _within(exact, found):
        tolerance, found = SLACK, stored
        # Less than is allowed: how far a block reaches is rounded here.
        few = zip(left, exact.allowed, strict=True)
        if not _within(exact, found) or any(
            2 * abs(over) > times * most for wrench, allowed in few
            for over, most in zip(wrench, allowed, strict=True)
        ):  # fmt: skip
            return None
    return Proof(exact=exact, claim="stands", tolerance=tolerance, forces=found, unit=unit)


def _stored(exact: Exact, contacts: Contacts, forces: Array) -> tuple[Forces, Fraction]:
    """Return forces as they are stored, by joint and point, and the unit they are in.

    Without friction they go along the normal to the last digit.
    """
    across = np.einsum("pi,pid->pd", forces, contacts.axes[contacts.joint])
    grain, parts = whole(across.ravel().tolist())
    unit = min(grain, exact.force)
    parts = [each * int(grain / unit) for each in parts]
    found, at = Forces(), 0
    for joint, ends in enumerate(exact.ends):
        found.append([[*parts[3 * each : 3 * each + 3]] for each in range(at, at + len(ends))])
        if exact.friction[joint] == 0:
            n = exact.normals[joint]
            long = sum(p * p for p in n)
            for force in found[-1]:
                press = Fraction(sum(p * q for p, q in zip(force, n, strict=True)), long)
                force[:] = [max(press, NOTHING) * each for each in n]
        at += len(ends)
    return found, unit


def _acting(exact: Exact, joint: int, forces: Sequence[Force], block: int) -> Wrench:
    """Return what forces at the points of a joint do to a block beside it."""
    sign = 1 if exact.sides[joint][1] == block else -1
    total: Wrench = [0] * 6
    for point, force in zip(exact.ends[joint], forces, strict=True):
        turn = moment(apart(point, exact.centres[block]), force)
        for at, each in enumerate((*force, *turn)):
            total[at] += sign * each
    return total


def _handed_on(
    exact: Exact, contacts: Contacts, forces: Array, stored: Forces, unbalanced: list[Wrench]
) -> Forces | None:
    """Hand on what is left on each block through the widest joints to a support.

    `forces`, (points, 3), `stored`: The same forces.
    `unbalanced`: What they leave on each block.
    Returns: Forces that leave nothing; None where some joint cannot bear what is left.
    """
    room: Array = np.maximum(contacts.slack(forces.ravel()), 0.0)
    of_joint: Array = np.zeros(len(exact.sides))
    np.add.at(of_joint, contacts.joint, room)
    shares = iter(fine(room))
    own = [[*islice(shares, len(ends))] for ends in exact.ends]
    added: dict[int, list[Force]] = {}
    order, left, found = ways(exact, of_joint), [*unbalanced], [*stored]
    if len(order) < len(left):
        return None
    for block, joints in reversed(order):
        wrench = left[block]
        if not any(wrench):
            continue
        bears = borne(exact, block, joints[:1], wrench, own)
        bears = bears or borne(exact, block, joints, wrench, own)
        if bears is None:
            return None
        more = {
            joint: [_along(exact, joint, each) for each in its] for joint, its in bears.items()
        }
        for joint, each in more.items():
            before, after = exact.sides[joint]
            other = before if after == block else after
            if other != SUPPORT:
                if len(more) == 1:
                    # All that is left goes on, which is told without its parts.
                    arm = apart(exact.centres[block], exact.centres[other])
                    handed = [*wrench[:3], *_sum(wrench[3:], moment(arm, wrench[:3]))]
                else:
                    handed = _acting(exact, joint, each, other)
                left[other] = _sum(left[other], handed)
            old: list[Force] = added.get(joint, [[0, 0, 0]] * len(each))
            added[joint] = [*map(_sum, old, each)]
    for joint, each in added.items():
        found[joint] = [*map(_sum, found[joint], each)]
    return found


def _along(exact: Exact, joint: int, parts: Sequence[Number]) -> Force:
    """Return a force of its parts along the ways of a joint."""
    n = exact.normals[joint]
    return [parts[0] * each for each in n] if len(parts) == 1 else [*parts]


def _sum(one: Sequence[Number], other: Sequence[Number]) -> list[Number]:
    return [p + q for p, q in zip(one, other, strict=True)]


def _within(exact: Exact, forces: Forces) -> bool:
    """Tell whether all forces press and lie within friction."""
    for n, mu, each in zip(exact.normals, exact.friction, forces, strict=True):
        for force in each:
            along, across = along_and_across(force, n)
            if along < 0 or (mu is not None and across > mu * mu * along * along):
                return False
    return True
