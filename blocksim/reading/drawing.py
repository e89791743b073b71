"""What drawings of all formats have in common: outlines on layers, a unit, what is left out.

Closed outlines of straight sides are blocks on the layer `blocks`, and blocks that stay where
they are on the layer `supports`. Words there are no blocks; anything else there is refused by
name, so that no verdict leaves it out. What is on other layers is counted and named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from blocksim.blocks.outlines import signed_area, step_of
from blocksim.blocks.polygons import MOST_BLOCKS
from blocksim.common.checks import COORDINATE, require
from blocksim.common.errors import InputError
from blocksim.common.words import printable

LAYERS = {"blocks": False, "supports": True}
"""Layers that are read, and whether what is on them is fixed."""
LARGEST_DRAWING = 20_000_000
"""Bytes; a larger drawing is not read."""
MOST_SHAPES = 1_000_000
"""Of a drawing."""
MOST_KINDS = 8
"""Kinds of what was left out that are named, each with its number and layer."""
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "in": 0.0254, "ft": 0.3048}
"""In metres."""

Corners = list[tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class Shape:
    """Something drawn.

    Parameters
    ----------
    what : str
        What it is called in its format.
    layer : str
    name : str
    corners : list of (x, y), optional
        In units of the drawing, y upwards; None if it is no closed outline of straight sides.
    wrong : str, optional
        Why it cannot be read: said where it is on a layer that is read.
    words : bool
        Whether it is text or a dimension, which bears nothing.
    step : float, optional
        To which its corners were rounded, in units of the drawing; by default by their
        decimals.
    """

    what: str
    layer: str
    name: str = ""
    corners: Corners | None = None
    wrong: str | None = None
    words: bool = False
    step: float | None = None


@dataclass(frozen=True, kw_only=True)
class Unit:
    """What a unit of the drawing is.

    Parameters
    ----------
    metres : float
    said : str
        What it was taken for, and why.
    """

    metres: float
    said: str

    def __post_init__(self) -> None:
        """Check the range."""
        ok = 1e-6 <= self.metres <= 1e6
        require(ok, "unit", self.metres, "between 1e-6 and 1e6 m")


def given_unit(metres: float) -> Unit:
    """Return a unit that was asked for."""
    return Unit(metres=metres, said=f"a unit of the drawing is {metres:g} m, as asked")


NO_UNIT = Unit(
    metres=1.0,
    said="no unit in the drawing: taken for m (blocksim convert --unit 0.001: mm)",
)


def structure_from(shapes: Iterable[Shape], path: Path, unit: Unit) -> dict[str, Any]:
    """Make the dict of a structure file of what was drawn; it has no friction.

    Parameters
    ----------
    shapes : iterable of Shape
    path : Path
        Of the drawing, which names the structure.
    unit : Unit

    Raises
    ------
    InputError
        In one line: no outline on a layer that is read, or one that cannot be read.
    """
    blocks: list[dict[str, Any]] = []
    steps = list[float]()
    left = Counter[str]()
    for count, shape in enumerate(shapes):
        require(count < MOST_SHAPES, "drawing", "more shapes", f"at most {MOST_SHAPES}")
        layer = plain(shape.layer)
        fixed = LAYERS.get(layer.lower())
        if fixed is not None and not shape.words:
            blocks.append(_block(shape, layer, unit) | ({"fixed": True} if fixed else {}))
            values = np.array(shape.corners).ravel()
            steps.append(step_of(values) if shape.step is None else shape.step)
            require(len(blocks) <= MOST_BLOCKS, "blocks", "more", f"at most {MOST_BLOCKS}")
        else:
            left[f"{shape.what} on layer {layer}" if layer else shape.what] += 1
    rest = _listed(left)
    for layer, fixed in LAYERS.items():
        found = any(bool(block.get("fixed")) is fixed for block in blocks)
        # With several blocks, convert can be told which of them are fixed.
        if not found and (not fixed or len(blocks) < 2):
            said = f"none (there is {rest or 'nothing else'})"
            raise InputError(f"closed outlines on layer {layer}", said, "at least one")
    return {
        "title": plain(path.stem)[:200],
        "source": plain(path.name)[:500],
        "notes": [unit.said, *([f"left out of the drawing: {rest}"] if rest else [])],
        "rounding": min(steps) * unit.metres,
        "blocks": blocks,
    }


def plain(text: str) -> str:
    """Return text of a stranger as `printable` does, cut at a length."""
    return printable(text[:80]).strip()


def _block(shape: Shape, layer: str, unit: Unit) -> dict[str, Any]:
    corners = shape.corners or []
    if corners[:1] == corners[-1:]:
        corners = corners[:-1]
    field = " ".join(f"{shape.what} {plain(shape.name)}".split()) + f" on layer {layer}"
    if shape.wrong is not None:
        allowed = "a closed outline of straight sides, in the plane, or on another layer"
        raise InputError(field, shape.wrong, allowed)
    require(len(corners) >= 3, field, f"{len(corners)} corners", "at least three corners")
    far = max(abs(each) * unit.metres for corner in corners for each in corner)
    require(far <= COORDINATE.high, field, far, f"within {COORDINATE.high:g} m")
    # Nobody means anything by the direction in which an outline was drawn.
    corners = corners[::-1] if signed_area(np.array(corners)) < 0 else corners
    vertices = [[x * unit.metres, y * unit.metres] for x, y in corners]
    return {"id": plain(shape.name), "vertices": vertices}


def _listed(left: Counter[str]) -> str:
    """Name what was left out: how many of which, on which layer."""
    kinds = left.most_common()
    words = [f"{number} {what}" for what, number in kinds[:MOST_KINDS]]
    more = sum(number for _, number in kinds[MOST_KINDS:])
    return ", ".join(words + ([f"{more} others"] if more else []))
