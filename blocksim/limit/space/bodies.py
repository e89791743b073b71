"""Blocks in space that a mechanism moves as one, and motions that open joints between them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy import sparse

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.bodies import Owner, bodies_of
from blocksim.limit.space.cones import most
from blocksim.limit.space.contacts import LIFTS, Contacts

ALIKE = 1e-6
"""Rates at a joint, over the largest, up to which its blocks move as one."""
LEAST = 1e-14
"""Rate at which joints are to open where nothing is left over."""


def alike(contacts: Contacts, rates: Array) -> Owner:
    """Return the body of each block, of those that rates do not part; `SUPPORT` at rest.

    `rates`, (6 blocks,).
    """
    assembly = contacts.problem.assembly
    turned = np.vstack([rates.reshape(-1, 6)[:, 3:], np.zeros(3)])[assembly.sides]
    ways = np.zeros(len(assembly.joints))
    at_points = np.abs((contacts.matrix.T @ rates).reshape(-1, 3)).max(axis=1)
    np.maximum.at(ways, contacts.joint, at_points)
    return bodies_of(assembly, ways, np.abs(turned[1] - turned[0]).max(axis=1), ALIKE)


def opened_between(
    contacts: Contacts, pull: Array, rates: Array, owner: Owner
) -> Iterator[Array]:
    """Give what `Contacts.opened` does, of bodies: points within one stay closed.

    `pull`, `rates`, (6 blocks,).
    `owner`, (blocks,): As of `alike`.
    """
    of = np.append(owner, SUPPORT)[contacts.problem.assembly.sides]
    between = np.flatnonzero((of[0] != of[1])[contacts.joint])
    some = (3 * between[:, None] + np.arange(3)).ravel()
    own, friction = contacts.own[between], contacts.friction[between]
    free = _free(contacts, owner)
    matrix = free @ sparse.csr_matrix(contacts.matrix)[:, some]
    left_over = float((-contacts.opening(rates)[between] * own).max())
    for times in LIFTS:
        lift = times * max(left_over, LEAST)
        found = most(matrix @ sparse.diags(np.repeat(own, 3)), free @ pull, friction, lift=lift)
        yield free.T @ found.rates


def _free(contacts: Contacts, owner: Owner) -> Any:
    """Return what forces on blocks are on bodies, and rates the other way, sparse.

    Moments are about the first block of each body; equations are in units of that block.
    """
    centres = contacts.problem.assembly.centres / contacts.problem.assembly.size
    moves = np.flatnonzero(owner != SUPPORT)
    first = moves[np.unique(owner[moves], return_index=True)[1]]
    arms = centres[moves] - centres[first[owner[moves]]]
    carried = np.tile(np.eye(6), (len(moves), 1, 1))
    # Velocities by rotation: the vector product with the arm.
    carried[:, :3, 3:] = np.cross(np.eye(3), arms[:, None]).transpose(0, 2, 1)
    scale = contacts.rows.reshape(-1, 6)[first[owner[moves]]]
    carried /= scale[:, None]
    each = np.arange(6)
    rows = np.broadcast_to(6 * moves[:, None, None] + each[:, None], carried.shape)
    columns = np.broadcast_to(6 * owner[moves][:, None, None] + each, carried.shape)
    entries = (carried.ravel(), (rows.ravel(), columns.ravel()))
    return sparse.csc_matrix(entries, shape=(contacts.rows.size, 6 * len(first))).T.tocsr()
