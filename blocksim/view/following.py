"""A camera that draws back as blocks leave the picture, and keeps every one in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.view.canvas import Label, Panel, Shape

EASED = 0.5
"""How long before a block would leave the camera begins to draw back [s of film]."""
FARTHEST = 1 / 12
"""Least share of its size at the release that anything is drawn with."""
AHEAD = 0.01
"""Way along a vector by which its direction in the picture is found [size]."""
MARGIN = 0.03
"""Share of a panel on each side that blocks keep off."""


class View(Protocol):
    """A view of a stage."""

    still: list[Shape]
    """What stays the same in every frame."""

    def shapes(self, moment: Any) -> list[Shape]:
        """Draw a moment of the stage."""
        ...

    def scale_bar(
        self, length: float, words: str, size: float
    ) -> tuple[list[Shape], list[Label]]:
        """Draw a bar of a length in units of the radius, and its words so large [over 720]."""
        ...

    def places(self, points: Array) -> Array:
        """Return where points in space are seen [pixels]."""
        ...

    @property
    def centre(self) -> Array:
        """The place that stays as the camera draws back [pixels]."""
        ...


def direction(view: View, place: Array, vector: Array) -> Array:
    """Return the direction in which a vector at a place is seen, (2,); 0 where it has none."""
    start, end = view.places(np.stack([place, place + AHEAD * vector]))
    long = float(np.hypot(*(end - start)))
    return (end - start) / long if long > 0 else np.zeros(2)


def needed(places: Array, panel: Panel, centre: Array) -> float:
    """Return the share at which places find room in a panel, about a point that stays."""
    low = np.array([panel.x + MARGIN * panel.width, panel.y])
    high = np.array([panel.x + (1 - MARGIN) * panel.width, panel.y + panel.height])
    off = places - centre
    room = np.where(off > 0, high - centre, centre - low)
    least = float((room / np.maximum(np.abs(off), 1e-9)).min(initial=1.0))
    return max(FARTHEST, min(1.0, least))


def is_lost(places: Array, panel: Panel, centre: Array) -> bool:
    """Tell whether no point is in the picture, however far the camera draws back."""
    off = FARTHEST * (places - centre) + centre - [panel.x, panel.y]
    return not bool(((off > 0) & (off < [panel.width, panel.height])).all(axis=1).any())


def eased(times: Array, shares: Array, before: float) -> tuple[Array, Array]:
    """Return times and shares of a camera that never comes nearer, and draws back smoothly.

    At each time the share is at most what is needed there: it is the mean over a while of the
    least that is needed up to the end of that while.
    """
    least: Array = np.minimum.accumulate(shares)
    fine = np.linspace(float(times[0]), float(times[-1]), 4 * len(times))
    ahead: Array = least[np.minimum(np.searchsorted(times, fine + before), len(times) - 1)]
    # Sums of the mean, with what was at first going on before the release.
    summed = np.concatenate([[0.0], np.cumsum((ahead[1:] + ahead[:-1]) / 2 * np.diff(fine))])
    back = np.interp(fine - before, fine, summed)
    early = np.maximum(0.0, before - (fine - fine[0])) * ahead[0]
    mean: Array = (summed - back + early) / before if before > 0 else ahead
    now: Array = least[np.minimum(np.searchsorted(times, fine), len(times) - 1)]
    return fine, np.minimum(mean, now)


def zoomed(shapes: Sequence[Shape], share: float, centre: Array) -> list[Shape]:
    """Draw shapes smaller about a point. Lines keep their width."""
    if share == 1:
        return list(shapes)
    return [shape._replace(points=centre + share * (shape.points - centre)) for shape in shapes]
