"""Loads as structure files say them, in the plane and in space: on blocks, or along a patch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import numpy as np

from blocksim.blocks.acting import Load
from blocksim.blocks.assembly import Array, Blocks
from blocksim.blocks.entries import Around, BlockEntry, Id, JointEntry, LoadEntry
from blocksim.blocks.patch import Profile
from blocksim.blocks.polygons import Body
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.errors import MISSING, InputError

if TYPE_CHECKING:
    from blocksim.blocks.space.assembly import Solid
    from blocksim.blocks.space.files import (
        FaceEntry,
        SolidEntry,
        SpatialAround,
        SpatialLoadEntry,
    )

Block = TypeVar("Block", bound="BlockEntry | SolidEntry")
Between = TypeVar("Between", bound="JointEntry | FaceEntry")
FORMS = ("body", "block", "patch")
"""What a load acts on: blocks by their weight, one block, or what lies uppermost."""


class Names:
    """Bodies by name."""

    def __init__(self, bodies: Sequence[Body] | Sequence[Solid]) -> None:
        self._index = {body.name: at for at, body in enumerate(bodies)}

    def __call__(self, name: Id, field: str) -> int:
        """Return the place of a body."""
        require(str(name) in self._index, field, name, "the id of a block")
        return self._index[str(name)]


def named_blocks(
    blocks: Iterable[Block], key: Literal["polygons", "polyhedra"]
) -> Iterator[tuple[Block, str, tuple[Any, ...]]]:
    """Give each block of a file with its name, which no other has, and its parts.

    `key`: Of the parts it consists of where it has no `vertices`.
    """
    known = set[str]()
    for at, block in enumerate(blocks):
        name, parts, field = str(block.id), getattr(block, key), f"blocks[{at}]"
        require(name not in known, f"{field}.id", block.id, "an id that no other block has")
        known.add(name)
        if block.vertices is None and parts is None:
            raise InputError(f"{field}.vertices", MISSING, "given")
        if block.vertices is not None and parts is not None:
            beside = f"{len(parts)} beside vertices"
            raise InputError(f"{field}.{key}", beside, "left out, or vertices")
        yield block, name, tuple(parts or [block.vertices])


def given_joints(
    joints: Iterable[Between], bodies: Sequence[Body] | Sequence[Solid], tolerance: float | None
) -> Iterator[tuple[Between, int, int]]:
    """Give each joint of a file with the places of its two bodies, one of which moves."""
    allowed = "left out: joints are given, none is found"
    require(tolerance is None, "tolerance", tolerance, allowed)
    body_of = Names(bodies)
    for at, joint in enumerate(joints):
        field = f"joints[{at}]"
        a, b = body_of(joint.a, f"{field}.a"), body_of(joint.b, f"{field}.b")
        require(a != b, f"{field}.b", joint.b, "another block than a")
        both = bodies[a].fixed and bodies[b].fixed
        require(not both, field, "two fixed blocks", "left out")
        yield joint, a, b


class LoadsOf:
    """What a load of a file comes to on the bodies of a structure.

    `dimensions`: Numbers of a force: 2 in the plane, 3 in space.
    """

    def __init__(self, bodies: Sequence[Body] | Sequence[Solid], dimensions: int = 2) -> None:
        self._bodies, self._names, self.dimensions = bodies, Names(bodies), dimensions
        fixed = [body.fixed for body in bodies]
        # Blocks that move are numbered without the fixed ones.
        self._place = np.cumsum([not each for each in fixed]) - 1
        self._count = fixed.count(False)

    def __call__(self, load: LoadEntry | SpatialLoadEntry, field: str) -> list[Load]:
        """Return the loads of one entry."""
        given = [form for form in FORMS if getattr(load, form, None) is not None]
        forms = FORMS if self.dimensions == 2 else FORMS[:2]
        allowed = f"one of {', '.join(forms[:-1])} and {forms[-1]}"
        require(len(given) == 1, field, _keys(load), allowed)
        if load.body is not None:
            return [self._body(load, list(load.body), field)]
        require(load.blocks is None, f"{field}.blocks", load.blocks, "left out: body has it")
        if load.force is None:
            raise InputError(f"{field}.force", MISSING, "given")
        force = np.array(load.force, dtype=float)
        if isinstance(load, LoadEntry) and load.patch is not None:
            return self._patch(load.patch, load, force, field)
        assert load.block is not None  # noqa: S101
        point = None if load.point is None else np.array(load.point, dtype=float)
        on = self._moving(load.block, f"{field}.block")
        return [Load(force=force, blocks=(on,), point=point)]

    def _body(self, load: LoadEntry | SpatialLoadEntry, body: list[float], field: str) -> Load:
        alone = load.force is None and load.point is None
        require(alone, field, _keys(load), "body and blocks alone")
        flat = not any(body[self.dimensions :])
        require(flat, f"{field}.body", body, "x and y, on these blocks")
        on = [self._moving(name, f"{field}.blocks") for name in load.blocks or ()]
        once = len(set(on)) == len(on)
        require(once, f"{field}.blocks", load.blocks, "each block once")
        blocks = tuple(on) if on else tuple(range(self._count))
        force = np.array(body[: self.dimensions], dtype=float)
        return Load(force=force, blocks=blocks, per_weight=True)

    def _patch(
        self, patch: tuple[float, float], load: LoadEntry, force: np.ndarray, field: str
    ) -> list[Load]:
        low, high = patch
        require(low < high, f"{field}.patch", patch, "two places, the left one first")
        require(load.point is None, f"{field}.point", load.point, "left out beside patch")
        polygons = [
            [np.asarray(each) for each in body.polygons]
            for body in self._bodies
            if isinstance(body, Body)
        ]
        found = Profile.of(polygons).along(low, high)
        if found is None:
            raise InputError(f"{field}.patch", patch, "above blocks all along")
        return [
            Load(force=share * force, blocks=(int(self._place[index]),), point=point)
            for index, share, point in found
            if not self._bodies[index].fixed
        ]

    def _moving(self, name: Id, field: str) -> int:
        place = self._names(name, field)
        require(not self._bodies[place].fixed, field, name, "a block that is not fixed")
        return int(self._place[place])


def _keys(load: LoadEntry | SpatialLoadEntry) -> list[str]:
    names = ("body", "blocks", "block", "point", "force", "patch")
    return [name for name in names if getattr(load, name, None) is not None]


class Acts(NamedTuple):
    """What acts on blocks, as a file says, and what is to be noted of it."""

    written: Around | SpatialAround
    gravity: Array
    dead: tuple[Load, ...]
    live: tuple[Load, ...]
    notes: tuple[str, ...]

    def on(self, assembly: Blocks, mu: float) -> Problem[Blocks]:
        """Return the problem of blocks with a friction, under all of it."""
        written = self.written
        return Problem(
            assembly=assembly,
            mu=mu,
            gravity=self.gravity,
            dead=self.dead,
            live=self.live,
            load=float(written.load),
            title=written.title,
            source=written.source,
            weighed=written.density is not None,
            notes=(*written.notes, *self.notes),
        )


def acting_of(written: Around | SpatialAround, loads_of: LoadsOf, down: Array) -> Acts:
    """Return gravity and loads; a body force on all blocks is gravity.

    `down`, (3,): Gravity where the file says nothing of it.
    """
    gravity, dead = down, list[Load]()
    notes: tuple[str, ...] = ()
    if written.dead is not None:
        gravity = np.zeros(3)
        for at, load in enumerate(written.dead):
            if load.body is not None and load.blocks is None:
                flat: list[float] = list(load.body)
                loads_of(replace(load, body=flat[: loads_of.dimensions]), f"dead[{at}]")
                gravity[: len(flat)] += flat
            else:
                dead += loads_of(load, f"dead[{at}]")
        if not gravity.any():
            notes = ("no gravity: dead has no body force on all blocks",)
    live = [
        each for at, load in enumerate(written.live) for each in loads_of(load, f"live[{at}]")
    ]
    return Acts(written, gravity, tuple(dead), tuple(live), notes)
