"""What acts on blocks, drawn as they move: loads, ground that shakes, supports that move."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from blocksim.arch.circular import GRAVITY
from blocksim.blocks.acting import is_push
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Load, Problem
from blocksim.blocks.shaking import Shaking
from blocksim.blocks.space.extruded import UP
from blocksim.view.arrows import forces_of
from blocksim.view.canvas import Label, Panel, Shape, arrow, colour, mixed, width_of
from blocksim.view.stage import SolidStage, Stage
from blocksim.view.style import DEAD, GROUND, INK, LIVE, PAPER, QUIET, THRUST
from blocksim.view.timeline import UPRIGHT
from blocksim.view.views import View, direction

LONGEST = 0.15
"""Share of a panel's height that the largest load is long."""
FEW, SHORT = 8, 0.4
"""Loads from which on arrows are shorter, and by how much."""
WIDE, TALL = 190.0, 64.0
"""Size of the inset with a pulse [pixels at 720]."""
POINTS = 240
"""Points at which the curve of a pulse is drawn."""
FIXED = 0.25
"""Distance between marks that stand still as the ground moves [size]."""
ROD, FAR = 0.3, 6.0
"""A rod holds a support: half its width over the support's radius, and its length [size]."""
PUSH = 56.0
"""Length of the arrow of a push, beside its words [pixels at 720]."""


class Acting:
    """Arrows, a pulse and amounts beside the blocks of one stage.

    `size`: Height of the film over 720 pixels.
    """

    def __init__(
        self, stage: Stage | SolidStage, view: View, panel: Panel, size: float
    ) -> None:
        self._stage, self._view, self._panel, self._size = stage, view, panel, size
        problem = stage.recording.problem
        self._pushes, self._loads = _pushes(problem), _resultants(problem)
        self._largest = max((float(np.linalg.norm(f)) for *_, f in self._loads), default=0.0)
        long = LONGEST * panel.height * (1.0 if len(self._loads) <= FEW else SHORT)
        # As built, all arrows begin within the panel.
        lines = (ends for _, ends in self._arrows(stage.at(0.0), long))
        self._long = long * min((_within(panel, *each) for each in lines), default=1.0)

    @property
    def _held(self) -> list[tuple[int, Array]]:
        """Supports that move, as blocks, and the direction of each."""
        moves = self._stage.recording.problem.moves
        ways = (move.direction for move in moves)
        return list(zip(sorted(self._stage.carriers), ways, strict=True))

    @property
    def entries(self) -> list[tuple[str, str]]:
        """Words and colours for the legend."""
        words = {"dead": ("dead load", DEAD), "live": ("live load", LIVE)}
        return [words[kind] for kind in words if kind in {load[0] for load in self._loads}]

    def shapes(self, moment: Any) -> list[Shape]:
        """Draw the loads where they act, on blocks as they are."""
        drawn: list[Shape] = []
        for kind, (tail, tip) in self._arrows(moment, self._long):
            drawn += arrow(tail, tip, colour(LIVE if kind == "live" else DEAD), self._size)
        return drawn

    def _arrows(self, moment: Any, long: float) -> Iterator[tuple[str, tuple[Array, Array]]]:
        """Give the kind of each load, and its tail and tip, the largest so long [pixels]."""
        for kind, block, arm, force in self._loads:
            place = self._stage.point_at(moment, block, arm)
            share = force / self._largest
            tip, way = self._view.places(place), direction(self._view, place, share)
            yield kind, (tip - long * float(np.linalg.norm(share)) * way, tip)

    def thrust(self, moment: Any) -> list[Shape]:
        """Draw the line of thrust, on the near face, while all is at rest."""
        tone, half = colour(THRUST, moment.statics), self._stage.depth / 2
        lines = self._stage.thrust if moment.statics else ()
        near = [np.pad(each, ((0, 0), (0, 1)), constant_values=half) for each in lines]
        places = map(self._view.places, near)
        return [Shape(each, edge=tone, width=2.4, closed=False) for each in places]

    def behind(self, moment: Any) -> list[Shape]:
        """Draw rods that hold supports which move, from beyond the picture or the ground."""
        stage, size = self._stage, self._stage.assembly.size
        built = stage.recording.poses[0, :, :2]
        edge = mixed(colour(GROUND), colour(INK), 0.45)
        fill = mixed(colour(GROUND), colour(PAPER), 0.35)
        rods: list[Shape] = []
        for block, way in self._held:
            place = moment.places[block]
            away = np.append(way, 0.0) / np.hypot(*way)
            away *= 1.0 if away[:2] @ (built[block] - built.mean(axis=0)) > 0 else -1.0
            long = FAR if away[1] >= -0.5 else (place[1] - stage.ground) / -away[1]
            wide = ROD * stage.assembly.reach[block] / size
            beside, end = wide * np.array([-away[1], away[0], 0.0]), place + long * away
            outline = np.stack([place - beside, end - beside, end + beside, place + beside])
            rods.append(
                Shape(self._view.places(outline), fill=fill, edge=edge, width=self._size)
            )
        return rods

    def aside(self, moment: Any, share: float) -> tuple[list[Shape], list[Label]]:
        """Draw what has its own place: a push, the pulse with the time, how far supports are.

        `share`: Of their size at which blocks are drawn.
        """
        problem, size = self._stage.recording.problem, self._size
        shapes, labels = list[Shape](), list[Label]()
        if problem.shaking is not None:
            seconds = moment.time * self._stage.unit
            shapes, labels = self._pulse(problem.shaking, seconds)
            # In space the ground is no line along which marks could go.
            shapes += [] if problem.in_space else self._marks(problem.shaking, seconds, share)
        if (moved := self._moved(moment)) is not None:
            labels.append(self._corner(f"supports moved {abs(1e3 * moved):.1f} mm"))
        below = 0 if moved is None else 1
        for row, (kind, share_of_weight) in enumerate(self._pushes, start=below):
            label = self._corner(f"push {np.linalg.norm(share_of_weight):.3g} g", row)
            labels.append(label)
            way = PUSH * size * direction(self._view, np.zeros(3), share_of_weight)
            middle = np.array([label.x - (PUSH / 2 + 14) * size, label.y + 5 * size])
            tone = colour(LIVE if kind == "live" else DEAD)
            shapes += arrow(middle - way / 2, middle + way / 2, tone, size)
        return shapes, labels

    def _corner(self, words: str, row: int = 0) -> Label:
        """Place words in the upper right corner, below the inset of ground that shakes.

        `row`: How many such words are above.
        """
        size, panel = self._size, self._panel
        x = panel.x + panel.width - 24 * size - width_of(words, 16 * size, bold=True)
        inset = 0.0 if self._stage.recording.problem.shaking is None else (TALL + 66) * size
        # An arrow as high as it may be stands beside it.
        y = panel.y + panel.height - (PUSH / 2 + 10 + row * (PUSH + 8)) * size - inset
        return Label(x, y, words, size=16 * size, bold=True)

    def _moved(self, moment: Any) -> float | None:
        """Return how far supports have moved along their way [m], or None where none do."""
        built = self._stage.recording.poses[0, :, :2]
        found = [
            float((moment.places[block, :2] - built[block]) @ way) / float(way @ way)
            for block, way in self._held
            if way.any()
        ]
        return float(np.mean(found)) * self._stage.assembly.size if found else None

    def _pulse(self, shaking: Shaking, now: float) -> tuple[list[Shape], list[Label]]:
        """Draw acceleration over time in a corner, with a mark at the time shown."""
        size, panel = self._size, self._panel
        wide, tall = WIDE * size, TALL * size
        left = panel.x + panel.width - wide - 24 * size
        middle = panel.y + panel.height - tall / 2 - 14 * size
        times, values = _accelerations(shaking)
        end, step = float(times[-1]), times[1]
        largest = float(np.abs(values).max()) or 1.0
        places = left + np.column_stack([times[:-1], times[:-1] + step]).ravel() / end * wide
        across, upwards = (
            np.column_stack([places, middle + np.repeat(each / largest, 2) * tall / 2])
            for each in values.T
        )
        at = left + min(now / end, 1.0) * wide
        ends = now if now >= end else now + step
        rate, up = (shaking.gained(now, ends) / step / largest).tolist()
        ink, quiet = colour(INK), colour(QUIET)
        base = np.array([[left, middle], [left + wide, middle]])
        dot = np.array([at, middle + rate * tall / 2])
        turn = np.linspace(0, 2 * np.pi, 20)
        ring = dot + 4.5 * size * np.column_stack([np.cos(turn), np.sin(turn)])
        shapes = [
            Shape(base, edge=quiet, width=1.0, closed=False),
            Shape(across, edge=ink, width=1.8 * size, closed=False),
            Shape(ring, fill=colour(LIVE)),
        ]
        words, upward = f"ground {_signed(rate * largest)} g", list[Label]()
        if shaking.is_vertical:
            shapes.insert(1, Shape(upwards, edge=quiet, width=1.4 * size, closed=False))
            # Below the other: the corner is no wider.
            low, says = middle - tall / 2 - 34 * size, f"upwards {_signed(up * largest)} g"
            upward = [Label(left, low, says, size=14 * size)]
        under = middle - tall / 2 - 16 * size
        return shapes, [Label(left, under, words, size=14 * size, bold=True), *upward]

    def _marks(self, shaking: Shaking, now: float, share: float) -> list[Shape]:
        """Draw marks in the ground that stand still, as the ground and the picture move."""
        size, panel = self._stage.assembly.size, self._panel
        times = np.linspace(0.0, now, 64)
        speeds = [shaking.gained(0.0, each)[0] * GRAVITY for each in times.tolist()]
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


def _within(panel: Panel, tail: Array, tip: Array) -> float:
    """Return which share of an arrow lies in a panel, from its tip on; all if that does not."""
    low = np.array([panel.x, panel.y])
    high = low + np.array([panel.width, panel.height])
    if not ((low < tip) & (tip < high)).all():
        return 1.0
    edge, way = np.where(tail > tip, high, low), tail - tip
    return float(np.divide(edge - tip, way, out=np.ones(2), where=way != 0).min(initial=1.0))


def _signed(value: float) -> str:
    """Write a value with its sign, and 0 without."""
    return f"{value:+.2f}" if round(value, 2) else "0"


@lru_cache(maxsize=4)
def _accelerations(shaking: Shaking) -> tuple[Array, Array]:
    """Return times of a pulse [s], and means between, across and up, (times - 1, 2) [g]."""
    times = np.linspace(0, max(1.25 * shaking.duration, 1e-9), POINTS)
    gained = np.array([shaking.gained(0.0, each) for each in times.tolist()])
    return times, np.diff(gained, axis=0) / np.diff(times)[:, None]


def _loads(problem: Problem[Any]) -> Iterator[tuple[str, float, Load]]:
    """Give each load with its kind and factor."""
    yield from (("dead", 1.0, load) for load in problem.dead)
    if problem.load:
        yield from (("live", problem.load, load) for load in problem.live)


def _pushes(problem: Problem[Any]) -> list[tuple[str, Array]]:
    """Collect pushes: kind, and share of the weight, y upwards, (3,)."""
    flat = np.diag([1.0, 1.0, 0.0])
    return [
        (kind, factor * (UPRIGHT if problem.in_space else flat) @ np.resize(load.force, 3))
        for kind, factor, load in _loads(problem)
        if is_push(problem, load)
    ]


def _resultants(problem: Problem[Any]) -> list[tuple[str, int, Array, Array]]:
    """Collect other loads: kind, block, point from its centre as built [size], and force."""
    return [
        (kind, block, arm / problem.assembly.size, factor * force)
        for kind, factor, load in _loads(problem)
        if not is_push(problem, load)
        for block, force, arm in _acting(problem, load)
    ]


def _acting(problem: Problem[Any], load: Load) -> Iterator[tuple[int, Array, Array]]:
    """Give each block of a load, the force [N], y upwards, and its arm from the centre [m]."""
    if problem.in_space:
        for block, force, arm in problem.assembly.forces_of(load):
            yield block, UPRIGHT @ force, arm
        return
    for block, (place, force) in zip(load.blocks, forces_of(problem, load), strict=True):
        arm = UP @ (np.asarray(place) - problem.assembly.centres[block])
        yield block, np.append(force[:2], 0.0), arm
