"""What drawings of all formats have in common: outlines on layers, a unit, what is left out.

Closed outlines are blocks on the layer `blocks`, and blocks that stay where they are on the
layer `supports`, or on layers that are named instead. Lines and arcs there that close are
outlines, too. Words are no blocks; anything else there is refused by name and place, so that
no verdict leaves it out. What is on other layers is counted and named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from blocksim.blocks.outlines import counter_clockwise
from blocksim.blocks.polygons import MOST_BLOCKS
from blocksim.common.checks import COORDINATE, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.words import printable
from blocksim.reading.asked import UNITS, Reading, Unit
from blocksim.reading.curves import Corners
from blocksim.reading.loops import loops_of

LARGEST_DRAWING = 20_000_000
"""Bytes; a larger drawing is not read."""
MOST_SHAPES = 1_000_000
"""Of a drawing."""
FARTHEST = 1e15
"""Coordinate of a drawing, whatever its unit; what is said is the farthest in metres."""
MOST_KINDS = 8
"""Kinds of what was left out that are named, each with its number and layer."""
OUTLINE = (
    "a closed outline in the plane, or on another layer "
    "(blocksim convert --picture FILE draws where)"
)


@dataclass(frozen=True, kw_only=True)
class Shape:
    """Something drawn.

    `what`: What it is called in its format.
    `corners`, list of (x, y): In units of the drawing, y upwards; of what is no line, where it
        is, as far as known.
    `closed`: Whether it is an outline; if not, it may be a part of one.
    `wrong`: Why it cannot be read: said where it is on a layer that is read.
    `words`: Whether it is text or a dimension, which bears nothing.
    `step`: To which its corners were rounded, in units of the drawing.
    `stray`: How far chords are off the curves they stand for.
    """

    what: str
    layer: str
    name: str = ""
    corners: Corners = field(default_factory=Corners)
    closed: bool = True
    wrong: str | None = None
    words: bool = False
    step: float = 0.0
    stray: float = 0.0

    @property
    def said(self) -> str:
        """What it is called in messages, with its place on the drawing."""
        named = " ".join(f"{self.what} {plain(self.name)}".split())
        return f"{named} on layer {plain(self.layer)}{place_words(self.corners)}"


def place_words(corners: Corners) -> str:
    """Say where on the drawing something is."""
    if not corners:
        return ""
    (low_x, low_y), (high_x, high_y) = np.min(corners, axis=0), np.max(corners, axis=0)
    return f" at ({(low_x + high_x) / 2:.6g}, {(low_y + high_y) / 2:.6g})"


@dataclass(frozen=True, kw_only=True)
class Refused:
    """What is on a layer that is read, and cannot be: a shape, and why."""

    shape: Shape
    why: str
    at: tuple[float, float] | None = None

    @property
    def said(self) -> str:
        """What it is called in messages, with the place where it cannot be read."""
        shape = self.shape
        return shape.said if self.at is None else replace(shape, corners=[self.at]).said


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """What was found on a drawing.

    `path`: Which names the structure.
    `unit`: None where the drawing has none, and none was asked for.
    `blocks`, tuple of (Shape, bool): Outlines, and whether they stay where they are.
    `left`: What is on other layers, in words.
    `moved`: How far ends of lines were moved to meet, in units of the drawing.
    """

    path: Path
    unit: Unit | None
    blocks: tuple[tuple[Shape, bool], ...]
    refused: tuple[Refused, ...] = ()
    left: str = ""
    moved: float = 0.0

    def structure(self) -> dict[str, Any]:
        """Return it as the dict of a structure file; it has no friction."""
        for each in self.refused[:1]:
            more = len(self.refused) - 1
            others = f"; {more} more of it cannot be read" if more else ""
            raise InputError(each.said, each.why, OUTLINE + others)
        for role in ("blocks", "supports"):
            found = any(fixed is (role == "supports") for _, fixed in self.blocks)
            # With several blocks, convert can be told which of them are fixed.
            if not found and (role == "blocks" or len(self.blocks) < 2):
                there = f"none (there is {self.left or 'nothing else'})"
                allowed = f"at least one; --layer {role}=NAME reads them on another layer"
                raise InputError(f"closed outlines on layer {role}", there, allowed)
        unit = self.unit
        if unit is None:
            points = np.array([each for shape, _ in self.blocks for each in shape.corners])
            wide, high = np.ptp(points, axis=0)
            allowed = f"given, as the drawing has none: --unit {', '.join(UNITS)}, or in metres"
            large = f"it is {wide:.6g} by {high:.6g} units large"
            raise InputError("unit", MISSING, f"{allowed}; {large}")
        notes = [unit.said, *self._moved(unit)]
        notes += [f"left out of the drawing: {self.left}"] * bool(self.left)
        return {
            "title": plain(self.path.stem)[:200],
            "source": plain(self.path.name)[:500],
            "notes": notes,
            "rounding": min(shape.step for shape, _ in self.blocks) * unit.metres,
            "blocks": [_block(shape, unit, fixed=fixed) for shape, fixed in self.blocks],
        }

    def _moved(self, unit: Unit) -> list[str]:
        """Say how far what is read is off what was drawn."""
        stray, many = max(shape.stray for shape, _ in self.blocks), 1e3 * unit.metres
        notes = list[str]()
        if stray:
            chords = f"arcs are chords, at most {stray * many:.2g} mm off; areas are exact"
            notes.append(chords)
        if self.moved * many >= 1e-6:
            notes.append(f"ends of lines up to {self.moved * many:.2g} mm apart are one corner")
        return notes


def drawing_of(
    shapes: Iterable[Shape], path: Path, unit: Unit | None, reading: Reading
) -> Drawing:
    """Sort what was drawn by its layers, and put lines together to outlines."""
    roles = reading.roles
    lines: dict[bool, list[Shape]] = {False: [], True: []}
    blocks: list[tuple[Shape, bool]] = []
    refused: list[Refused] = []
    left, seen = Counter[str](), set[str]()
    for count, shape in enumerate(shapes):
        require(count < MOST_SHAPES, "drawing", "more shapes", f"at most {MOST_SHAPES}")
        layer = plain(shape.layer)
        seen.add(layer)
        far = max((abs(each) for corner in shape.corners for each in corner), default=0.0)
        require(far <= FARTHEST, shape.said, far, f"within {COORDINATE.high:g} m")
        role = roles.get(layer.casefold())
        if role == "ignored":
            continue
        if role is None or shape.words:
            left[f"{shape.what} on layer {layer}" if layer else shape.what] += 1
        elif shape.wrong is not None:
            refused.append(Refused(shape=shape, why=shape.wrong))
        elif shape.closed:
            blocks.append((shape, role == "supports"))
        else:
            lines[role == "supports"].append(shape)
        require(len(blocks) <= MOST_BLOCKS, "blocks", "more", f"at most {MOST_BLOCKS}")
    reading.require_layers(seen)
    require(reading.up is None, "up", reading.up, "left out: it is of meshes")
    moved = 0.0
    metres = reading.unit_of(unit)
    # Without a unit it is refused; what it would be in the unit m is drawn nevertheless.
    snap = reading.snap and reading.snap / (1.0 if metres is None else metres.metres)
    for fixed, drawn in lines.items():
        found, wrong, far = _closed(drawn, snap)
        blocks += [(shape, fixed) for shape in found]
        refused += wrong
        moved = max(moved, far)
    return Drawing(
        path=path,
        unit=metres,
        blocks=tuple(blocks),
        refused=tuple(refused),
        left=_listed(left),
        moved=moved,
    )


def _closed(
    drawn: Sequence[Shape], snap: float | None
) -> tuple[list[Shape], list[Refused], float]:
    """Put lines together to outlines, named by the first of their lines."""
    if not drawn:
        return [], [], 0.0
    loops, wrong = loops_of([shape.corners for shape in drawn], snap)
    found: list[Shape] = []
    for loop in loops:
        parts = [drawn[k] for k in loop.lines]
        kinds = " and ".join(sorted({each.what for each in parts}))
        found.append(
            replace(
                parts[0],
                what=f"outline of {kinds}",
                corners=loop.corners,
                closed=True,
                step=min(each.step for each in parts),
                stray=max(each.stray for each in parts),
            )
        )
    refused = [Refused(shape=drawn[e.line], why=e.why, at=e.at) for e in wrong]
    return found, refused, max((loop.moved for loop in loops), default=0.0)


def plain(text: str) -> str:
    """Return text of a stranger as `printable` does, cut at a length."""
    return printable(text[:80]).strip()


def _block(shape: Shape, unit: Unit, *, fixed: bool) -> dict[str, Any]:
    corners = shape.corners
    if corners[:1] == corners[-1:]:
        corners = corners[:-1]
    require(len(corners) >= 3, shape.said, f"{len(corners)} corners", "at least three corners")
    far = max(abs(each) * unit.metres for corner in corners for each in corner)
    require(far <= COORDINATE.high, shape.said, far, f"within {COORDINATE.high:g} m")
    # Nobody means anything by the direction in which an outline was drawn.
    around = counter_clockwise(np.array(corners))
    vertices = [[x * unit.metres, y * unit.metres] for x, y in around.tolist()]
    return {"id": plain(shape.name), "vertices": vertices, **({"fixed": True} if fixed else {})}


def _listed(left: Counter[str]) -> str:
    """Name what was left out: how many of which, on which layer."""
    kinds = left.most_common()
    words = [f"{number} {what}" for what, number in kinds[:MOST_KINDS]]
    more = sum(number for _, number in kinds[MOST_KINDS:])
    return ", ".join(words + ([f"{more} others"] if more else []))
