"""Structures in space that planes of symmetry halve: part of the blocks, asked for all.

The mirror image of forces that balance a symmetric problem balances it, too, and so does the
mean of both, since the programme is convex. So forces need be looked for that are their own
image in every plane of symmetry: those at some of the points say all others, and if some of the
blocks are in balance all are. What is found is that of the whole: forces and motion of all
blocks are held to the same check as without.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import KDTree

from blocksim.blocks.assembly import SUPPORT, Array
from blocksim.blocks.space.points import JointPoints

ALIKE = 1e-9
"""Distance within which points, and difference within which pulls, are the same: over the size,
and over the largest pull."""
FEWEST = 20
"""Blocks below which no planes are looked for: that takes as long as it saves."""
KINDS = 1e-6
"""To which it is told whether a point may be the image of another."""
SOME = 8
"""Blocks that are looked at first."""
MOST = 400
"""Most images of a block."""

Places = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Image:
    """A way to lay a structure onto itself.

    `turn`, (3, 3): In space; its determinant is -1 for a mirror.
    `blocks`, (blocks,), `points`, (points,): Where each goes.
    """

    turn: Array
    blocks: Places
    points: Places

    def after(self, other: Image) -> Image:
        """Return what comes of another and then this."""
        return Image(
            self.turn @ other.turn, self.blocks[other.blocks], self.points[other.points]
        )


class Symmetry:
    """All images of a structure in its planes of symmetry, and what stands for the rest.

    `blocks`, (some,): Blocks of which all others are images.
    `points`, (some,): Likewise.
    """

    def __init__(self, contacts: JointPoints, images: list[Image]) -> None:
        self._contacts, self._images = contacts, images
        self._block_of = np.min([each.blocks for each in images], axis=0)
        self._point_of = np.min([each.points for each in images], axis=0)
        self.blocks, self._block_at = np.unique(self._block_of, return_inverse=True)
        self.points, self._point_at = np.unique(self._point_of, return_inverse=True)

    @property
    def halves(self) -> bool:
        """Whether not all blocks have to be asked."""
        return len(self._images) > 1

    @property
    def counts(self) -> Array:
        """How many images each of the points has, (some,)."""
        return np.bincount(self._point_at).astype(np.float64)

    @cached_property
    def forces(self) -> Any:
        """What forces at the points come to at all, (3 points, 3 some), sparse."""
        contacts, some = self._contacts, self.points
        axes, sides = contacts.axes[contacts.joint], contacts.problem.assembly.sides
        after = sides[1][contacts.joint]
        own = len(self._images) / self.counts
        rows, values = list[Places](), list[Array]()
        for image in self._images:
            there = image.points[some]
            gone = _gone(image.blocks, after[some])
            sense = np.where(after[there] == gone, 1.0, -1.0) / own
            turned = np.matmul(axes[there] @ image.turn, axes[some].transpose(0, 2, 1))
            # To the last digit.
            if image is self._images[0]:
                turned[:] = np.eye(3)
            rows.append(there)
            values.append(sense[:, None, None] * turned)
        return _blocks(rows, values, len(contacts.joint))

    @cached_property
    def rates(self) -> Any:
        """What rates of the blocks come to at all, (6 blocks, 6 some), sparse."""
        count = len(self._contacts.problem.assembly.blocks)
        rows, values = list[Places](), list[Array]()
        for image in self._images:
            rows.append(image.blocks[self.blocks])
            turn = _twist(image.turn) / len(self._images)
            values.append(np.tile(turn, (len(self.blocks), 1, 1)))
        return _blocks(rows, values, count)

    @cached_property
    def free(self) -> Any:
        """Ways in which the blocks may move and be their own images, (6 some, ways), sparse."""
        # The sum of the images of a way that come back to its block is a projection, or more.
        sums = np.zeros((len(self.blocks), 6, 6))
        for image in self._images:
            sums[image.blocks[self.blocks] == self.blocks] += _twist(image.turn)
        sizes, ways = np.linalg.eigh(sums)
        every = sparse.csc_matrix(_blocks([np.arange(len(ways))], [ways], len(ways)))
        return every[:, np.flatnonzero(sizes.ravel() > 0.5)]


def _twist(turn: Array) -> Array:
    """Return what a turn does to velocities and rotations, or forces and moments, (6, 6)."""
    found = np.zeros((6, 6))
    found[:3, :3], found[3:, 3:] = turn, np.linalg.det(turn) * turn
    return found


def unmoved(contacts: JointPoints) -> Image:
    """Return the image in which all stays where it is."""
    count = len(contacts.problem.assembly.blocks)
    return Image(np.eye(3), np.arange(count), np.arange(len(contacts.joint)))


def images_of(contacts: JointPoints, *pulls: Array) -> list[Image]:
    """Return all images of a structure and what acts on it, in its planes of symmetry.

    `pulls`, each (6 blocks,): Forces and moments on the blocks.
    """
    first = unmoved(contacts)
    assembly = contacts.problem.assembly
    if len(assembly.blocks) < FEWEST or not assembly.joints:
        return [first]
    seen, images, mirrors = _Seen(contacts, pulls), {_key(np.eye(3)): first}, list[Image]()
    for normal in seen.normals():
        turn = np.eye(3) - 2 * np.outer(normal, normal)
        if _key(turn) in images or (mirror := seen.mirror(turn)) is None:
            continue
        mirrors.append(mirror)
        # Every image is a product of mirrors.
        new = list(images.values())
        while new and len(images) <= MOST:
            made = {
                _key((each := by.after(image)).turn): each for image in new for by in mirrors
            }
            new = [each for key, each in made.items() if key not in images]
            images |= {_key(each.turn): each for each in new}
    return list(images.values()) if len(images) <= MOST else [first]


def _key(turn: Array) -> tuple[int, ...]:
    """Return what is the same for turns that are."""
    return tuple(np.round(turn.ravel() / KINDS).astype(int).tolist())


class _Seen:
    """Points and blocks as mirrors see them; lengths in units of the size."""

    def __init__(self, contacts: JointPoints, pulls: tuple[Array, ...]) -> None:
        assembly = contacts.problem.assembly
        places = assembly.points / assembly.size
        middle = places.mean(axis=0)
        self._contacts, self._places = contacts, places - middle
        self._centres = assembly.centres / assembly.size - middle
        self._pulls = [each.reshape(-1, 6) for each in pulls]
        self._pairs = np.sort(assembly.sides, axis=0)[:, contacts.joint]
        self._block_tree = KDTree(self._centres)
        # Where two faces of the same two blocks meet, points differ by their joints' middles.
        corners = np.bincount(contacts.joint).clip(1)
        sums = [np.bincount(contacts.joint, each) for each in self._places.T]
        self._middles = (np.stack(sums) / corners).T[contacts.joint]
        self._point_tree = KDTree(self._known(self._places, self._middles, self._pairs))

    def _known(self, places: Array, middles: Array, pairs: Places) -> Array:
        """Return what tells points apart, (points, 7); pairs of blocks by a number."""
        numbers = (pairs[0] + 1.0) * (len(self._centres) + 1) + pairs[1]
        return np.column_stack([places, middles, numbers])

    def normals(self) -> Iterator[Array]:
        """Give normals of planes, among which those of all planes of symmetry are."""
        contacts, places = self._contacts, self._places
        down = places @ contacts.problem.gravity
        kinds = np.column_stack([np.linalg.norm(places, axis=1), down, contacts.own])
        _, kind, counts = np.unique(
            np.round(kinds / KINDS), axis=0, return_inverse=True, return_counts=True
        )
        kind = kind.reshape(-1)
        order = np.lexsort((-kinds[:, 0], counts[kind]))
        first = int(order[0])
        # A plane has a point on it, or maps it to another of its kind.
        off = np.linalg.norm(np.cross(places[order], places[first]), axis=1) > KINDS
        chosen = [first, *order[off][:1].tolist()]
        found = list[Array]()
        for each in chosen:
            ways: Array = places[kind == kind[each]] - places[each]
            found.append(ways[np.linalg.norm(ways, axis=1) > KINDS])
        if len(chosen) > 1:
            both = places[chosen]
            found.append(cast("Array", np.cross(both[:1], both[1:])))
        units: Array = np.concatenate(found)
        units /= np.linalg.norm(units, axis=1, keepdims=True)
        for at in range(len(units)):
            if not (np.abs(units[:at] @ units[at]) > 1 - ALIKE).any():
                yield units[at]

    def mirror(self, turn: Array) -> Image | None:
        """Return the image in a plane; None where it is another structure."""
        if _nearest(self._block_tree, self._centres[:SOME] @ turn) is None:
            return None
        blocks = _nearest(self._block_tree, self._centres @ turn)
        if blocks is None:
            return None
        for pull in self._pulls:
            image = np.hstack([pull[:, :3] @ turn, -pull[:, 3:] @ turn])
            if np.abs(pull[blocks] - image).max() > ALIKE * np.abs(pull).max():
                return None
        pairs = np.sort(_gone(blocks, self._pairs), axis=0)
        there = self._known(self._places @ turn, self._middles @ turn, pairs)
        points = _nearest(self._point_tree, there)
        if points is None:
            return None
        contacts = self._contacts
        normals = contacts.axes[contacts.joint][:, 0]
        across = np.abs(np.einsum("pi,pi->p", normals @ turn, normals[points])) < 1 - ALIKE
        unlike = np.abs(contacts.own[points] - contacts.own) > ALIKE * contacts.own
        other = contacts.friction[points] != contacts.friction
        return None if (across | unlike | other).any() else Image(turn, blocks, points)


def _nearest(tree: KDTree, places: Array) -> Places | None:
    """Return which of a tree's each place is; None where one is none, or two are the same."""
    found: Any = tree.query(places)
    which: Places = found[1]
    is_one = float(found[0].max()) <= ALIKE and len(np.unique(which)) == len(which)
    return which if is_one else None


def _gone(blocks: Places, sides: Places) -> Places:
    """Return where blocks beside joints go; what is fixed stays so."""
    return np.where(sides == SUPPORT, SUPPORT, blocks[sides])


def _blocks(rows: list[Places], values: list[Array], count: int) -> Any:
    """Return blocks of k by k in a sparse matrix; those of the same place are added."""
    some, each = len(rows[0]), values[0].shape[1]
    at = np.arange(each, dtype=np.int64)
    every = np.concatenate(values)
    row, column = np.zeros(every.shape, dtype=np.int64), np.zeros(every.shape, dtype=np.int64)
    row[:] = each * np.concatenate(rows)[:, None, None] + at[:, None]
    column[:] = each * np.tile(np.arange(some), len(rows))[:, None, None] + at
    entries: Any = (every.ravel(), (row.ravel(), column.ravel()))
    return sparse.csc_matrix(entries, shape=(each * count, each * some))
