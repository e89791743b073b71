"""What acts on blocks, drawn as they move: loads, ground that shakes, supports that move."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from blocksim.arch.circular import GRAVITY
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.shaking import Shaking
from blocksim.view.arrows import forces_of
from blocksim.view.canvas import Label, Panel, Shape, colour, width_of
from blocksim.view.stage import Moment, Stage
from blocksim.view.style import DEAD, INK, LIVE, QUIET

LONGEST = 0.15
"""Share of a panel's height that the largest load is long."""
FEW, SHORT = 8, 0.4
"""Loads from which on arrows are shorter, and by how much."""
WIDE, TALL = 190.0, 64.0
"""Size of the inset with a pulse [pixels at 720]."""
POINTS = 240
"""Of a pulse."""
FIXED = 0.25
"""Distance between marks that stand still as the ground moves [size]."""


class Places(Protocol):
    """A view that tells where points are seen."""

    def places(self, points: Array) -> Array:
        """Return pixels of points in space."""
        ...


class Acting:
    """Arrows, a pulse and amounts beside the blocks of one stage.

    Parameters
    ----------
    stage : Stage
    view : Places
    panel : Panel
    size : float
        Pixels of the frame over 720.
    """

    def __init__(self, stage: Stage, view: Places, panel: Panel, size: float) -> None:
        self._stage, self._view, self._panel, self._size = stage, view, panel, size
        problem = stage.recording.problem
        self._loads = _resultants(problem)
        self._largest = max((float(np.hypot(*f)) for *_, f in self._loads), default=0.0)
        self._unit = math.sqrt(stage.assembly.size / GRAVITY)

    @property
    def entries(self) -> list[tuple[str, str]]:
        """Words and colours for the legend."""
        words = {"dead": ("dead load", DEAD), "live": ("live load", LIVE)}
        return [words[kind] for kind in words if kind in {load[0] for load in self._loads}]

    def shapes(self, moment: Moment) -> list[Shape]:
        """Draw the loads where they act, on blocks as they are."""
        drawn: list[Shape] = []
        long = LONGEST * self._panel.height * (1.0 if len(self._loads) <= FEW else SHORT)
        for kind, block, arm, force in self._loads:
            tip = self._view.places(self._stage.point_at(moment, block, arm)[None])[0]
            tail = tip - long * force / self._largest
            drawn += _arrow(tail, tip, LIVE if kind == "live" else DEAD, self._size)
        return drawn

    def aside(self, moment: Moment, share: float) -> tuple[list[Shape], list[Label]]:
        """Draw what has its own place: the pulse with the time, the amount of a spread.

        Parameters
        ----------
        moment : Moment
        share : float
            Of their size at which blocks are drawn.
        """
        problem, size = self._stage.recording.problem, self._size
        shapes, labels = list[Shape](), list[Label]()
        if problem.shaking is not None:
            seconds = moment.time * self._unit
            shapes, labels = self._pulse(problem.shaking, seconds)
            shapes += self._marks(problem.shaking, seconds, share)
        moved = self._moved(moment)
        if moved is not None:
            words = f"supports moved {1e3 * moved:.1f} mm"
            x = self._panel.x + self._panel.width - 24 * size
            x -= width_of(words, 16 * size, bold=True)
            y = self._panel.y + self._panel.height - 24 * size
            labels.append(Label(x, y, words, size=16 * size, bold=True))
        return shapes, labels

    def _moved(self, moment: Moment) -> float | None:
        """How far supports have moved, as they are told to [m]; None where none do."""
        stage, found = self._stage, list[float]()
        moves = stage.recording.problem.moves
        for block, move in zip(sorted(stage.carriers), moves, strict=True):
            way = stage.point_at(moment, block, np.zeros(2))[:2]
            way = way - stage.assembly.built[block, :2]
            long = float(move.direction @ move.direction)
            if long:
                found.append(float(way @ move.direction) / long * stage.assembly.size)
        return float(np.mean(found)) if found else None

    def _pulse(self, shaking: Shaking, now: float) -> tuple[list[Shape], list[Label]]:
        """Draw acceleration over time in a corner, with a mark at the time shown."""
        size, panel = self._size, self._panel
        wide, tall = WIDE * size, TALL * size
        left = panel.x + panel.width - wide - 24 * size
        middle = panel.y + panel.height - tall / 2 - 14 * size
        end = max(1.25 * shaking.duration, 1e-9)
        times = np.linspace(0, end, POINTS)
        gained = np.array([shaking.gained(0.0, each) for each in times.tolist()])
        values = np.diff(gained) / np.diff(times)
        largest = float(np.abs(values).max()) or 1.0
        step = times[1]
        heights = np.repeat(values / largest, 2)
        places = np.column_stack([times[:-1], times[:-1] + step]).ravel()
        curve = np.column_stack([left + places / end * wide, middle + heights * tall / 2])
        at = left + min(now / end, 1.0) * wide
        rate = shaking.gained(now, now + step) / step / largest if now < end else 0.0
        ink, quiet = colour(INK), colour(QUIET)
        base = np.array([[left, middle], [left + wide, middle]])
        dot = np.array([at, middle + rate * tall / 2])
        turn = np.linspace(0, 2 * np.pi, 20)
        ring = dot + 4.5 * size * np.column_stack([np.cos(turn), np.sin(turn)])
        shapes = [
            Shape(base, edge=quiet, width=1.0, closed=False),
            Shape(curve, edge=ink, width=1.8 * size, closed=False),
            Shape(ring, fill=colour(LIVE)),
        ]
        words = f"ground {rate * largest:+.2f} g"
        under = middle - tall / 2 - 16 * size
        return shapes, [Label(left, under, words, size=14 * size, bold=True)]

    def _marks(self, shaking: Shaking, now: float, share: float) -> list[Shape]:
        """Draw marks in the ground that stand still, as the ground and the picture move."""
        size, panel = self._stage.assembly.size, self._panel
        times = np.linspace(0.0, now, 64)
        speeds = [shaking.gained(0.0, each) * GRAVITY for each in times.tolist()]
        way = float(np.sum((np.array(speeds[1:]) + speeds[:-1]) / 2 * np.diff(times)))
        ends = self._view.places(
            np.array([[0.0, self._stage.ground, 0.0], [FIXED, self._stage.ground, 0.0]])
        )
        apart = float(ends[1, 0] - ends[0, 0]) * share
        top = float(ends[0, 1]) - 4 * self._size
        first = (-way / size / FIXED * apart) % apart
        return [
            Shape(
                np.array([[x, top], [x - 5 * self._size, top - 12 * self._size]]),
                edge=colour(QUIET), width=1.4 * self._size, closed=False,
            )
            for x in np.arange(panel.x + first, panel.x + panel.width, apart).tolist()
        ]  # fmt: skip


def _resultants(problem: Problem) -> list[tuple[str, int, Array, Array]]:
    """Collect loads: kind, block, point from its centre [size], and force."""
    found: list[tuple[str, int, Array, Array]] = []
    assembly = problem.assembly
    kinds: tuple[tuple[str, tuple[Load, ...], float], ...] = (
        ("dead", problem.dead, 1.0),
        ("live", problem.live, problem.load),
    )
    for kind, loads, factor in kinds:
        for load in loads if factor else ():
            acting = zip(load.blocks, forces_of(problem, load), strict=True)
            for block, (place, force) in acting:
                arm = (np.asarray(place) - assembly.centres[block]) / assembly.size
                found.append((kind, block, arm, factor * force[:2]))
    return found


def _arrow(tail: Array, tip: Array, tone: str, size: float) -> list[Shape]:
    """Draw an arrow from one place to another [pixels]."""
    way = tip - tail
    long = float(np.hypot(*way))
    if long < 2 * size:
        return []
    way = way / long
    head = min(12 * size, long)
    across = np.array([-way[1], way[0]]) * 0.42 * head
    back = tip - head * way
    return [
        Shape(np.array([tail, back]), edge=colour(tone), width=2.6 * size, closed=False),
        Shape(np.array([tip, back + across, back - across]), fill=colour(tone)),
    ]
