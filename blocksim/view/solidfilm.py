"""A recording in space as frames of a film: blocks in perspective, a clock, and words."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from blocksim.arch.circular import GRAVITY
from blocksim.blocks.assembly import Array
from blocksim.blocks.joints import JointState
from blocksim.blocks.space.parting import displacement_in_space
from blocksim.simulation.space import SpatialRecording
from blocksim.view.canvas import Canvas, Label, Panel, Shape, colour
from blocksim.view.captions import legend_of
from blocksim.view.drawing import words_of
from blocksim.view.film import AFTER, BEFORE, FOOT, HEAD, TALL
from blocksim.view.filmwords import digits_of, fitting, slowness
from blocksim.view.solidjoints import marks_of, states_at
from blocksim.view.solidscene import Camera, blocks_of, corners_of, supports_of
from blocksim.view.style import INK, QUIET

MARGIN = 30.0
"""To both sides of what is shown, at a height of `TALL` [pixels]."""
LAST, STILL = 5, 1e-3
"""Frames at the end, and the way in them, over the size, that nobody sees."""


class SolidFilm:
    """Frames drawn from a recording alone: equal recordings give equal frames.

    The camera keeps in frame all places that blocks come to.

    Parameters
    ----------
    recording : SpatialRecording
    slow : float, optional
        How many times slower than it happened; by default such that the motion takes
        about six seconds.
    height : int
        Of a frame [pixels]; it is 16:9.
    rate : int
        Frames in a second.
    """

    def __init__(
        self,
        recording: SpatialRecording,
        *,
        slow: float | None = None,
        height: int = TALL,
        rate: int = 30,
    ) -> None:
        self.height, self.width = 2 * (height // 2), 2 * round(height * 8 / 9)
        self.rate, self._recording = rate, recording
        assembly = recording.problem.assembly
        self._unit = math.sqrt(assembly.size / GRAVITY)
        self.seconds = float(recording.times[-1]) * self._unit
        self.slow = slowness(self.seconds) if slow is None else slow
        self.count = 1 + round(rate * (BEFORE + self.seconds * self.slow + AFTER))
        # Turns between frames of the recording are even.
        self._turns = [Rotation.from_rotvec(each[:, 3:]) for each in recording.poses]
        low, high = self._reached()
        self._supports = supports_of(assembly, low, high)
        self._camera = Camera(low, high)
        self._size = self.height / TALL
        self._frame_all(low, high)
        self._canvas = Canvas(self.width, self.height)
        self._canvas.keep((), self._words())
        self._last: tuple[float, NDArray[np.uint8]] | None = None

    @property
    def at_rest(self) -> bool:
        """Whether blocks hardly move as it ends."""
        recording = self._recording
        last = recording.poses[-LAST:]
        way = displacement_in_space(last - last[-1], recording.problem.assembly)
        return len(last) == LAST and float(way.max()) < STILL

    def frame(self, number: int) -> NDArray[np.uint8]:
        """Draw a frame, shape (height, width, 4): RGBA, not to be changed."""
        seconds = min(max((number / self.rate - BEFORE) / self.slow, 0.0), self.seconds)
        if self._last is None or self._last[0] != seconds:
            self._draw(seconds)
            self._last = seconds, self._canvas.pixels()
        return self._last[1]

    def corners(self, seconds: float) -> Array:
        """Return where all corners that move are in the picture at a time, (k, 2) [pixels]."""
        corners = corners_of(self._recording.problem.assembly, *self._at(seconds))
        return self._in_pixels(self._camera.seen(corners))

    def _at(self, seconds: float) -> tuple[Array, Array]:
        """Return turns of the blocks at a time, and shifts of their centres [m]."""
        times, poses = self._recording.times, self._recording.poses
        at = float(np.clip(seconds / self._unit, times[0], times[-1]))
        k = min(int(np.searchsorted(times, at, side="right")) - 1, len(times) - 2)
        share = (at - times[k]) / (times[k + 1] - times[k])
        one, two = self._turns[k], self._turns[k + 1]
        between = Rotation.from_rotvec(share * (two * one.inv()).as_rotvec()) * one
        shift = poses[k, :, :3] + share * (poses[k + 1, :, :3] - poses[k, :, :3])
        shift = (shift - poses[0, :, :3]) * self._recording.problem.assembly.size
        return between.as_matrix(), shift

    def _reached(self) -> Array:
        """Return least and largest places that corners come to, (2, 3) [m]."""
        assembly = self._recording.problem.assembly
        moments = (self._recording.times * self._unit).tolist()
        every = np.concatenate([corners_of(assembly, *self._at(each)) for each in moments])
        return np.stack([every.min(axis=0), every.max(axis=0)])

    def _frame_all(self, low: Array, high: Array) -> None:
        """Choose scale and middle so that the box of all places is in frame."""
        ends = list(itertools.product(*zip(low, high, strict=True)))
        seen = self._camera.seen(np.array(ends))
        wide, tall = np.ptp(seen, axis=0)
        room = np.array(
            [self.width - 2 * MARGIN * self._size, self.height - (HEAD + FOOT) * self._size]
        )
        self._scale = float(min(room / np.array([wide, tall])))
        self._middle = (seen.min(axis=0) + seen.max(axis=0)) / 2

    def _in_pixels(self, seen: Array) -> Array:
        middle = np.array([self.width, self.height + (FOOT - HEAD) * self._size]) / 2
        return (seen - self._middle) * self._scale + middle

    def _words(self) -> list[Label]:
        """Say what it is, and how slow."""
        recording, s = self._recording, self._size
        problem = recording.problem
        title = problem.title or "blocks in space"
        said = f"{title}, {len(problem.assembly.blocks)} blocks, mu {problem.mu:g}"
        top = self.height - 34 * s
        foot = f"{recording.engine} {recording.engine_version}"
        if self.slow > 1.05:
            foot += f", {self.slow:.3g} times slower than it happens"
        return [
            Label(
                24 * s, top, fitting(said, 17 * s, self.width - 48 * s), 17 * s, INK, bold=True
            ),
            Label(24 * s, 18 * s, foot, 13 * s, QUIET),
        ]

    def _draw(self, seconds: float) -> None:
        s = self._size
        assembly = self._recording.problem.assembly
        states = self._states_at(seconds)
        marks = marks_of(assembly, states)
        pieces = [*self._supports, *blocks_of(assembly, *self._at(seconds), marks)]
        polygons, fills = self._camera.painted(pieces)
        edge = colour(INK)
        shapes: list[Shape] = []
        for each, fill in zip(polygons, fills, strict=True):
            red, green, blue = fill.tolist()
            shapes.append(Shape(self._in_pixels(each), (red, green, blue, 1.0), edge, 0.7 * s))
        clock = f"t = {seconds:.{digits_of(self.seconds)}f} s"
        if seconds >= self.seconds:
            clock += ", at rest" if self.at_rest else ", still moving"
        panel = Panel(0, 0, self.width, self.height)
        words = [Label(self.width - 24 * s, 18 * s, clock, 15 * s, INK, across="right")]
        told = dict.fromkeys(
            words_of(each, is_arch=False) for each in states if each is not JointState.CLOSED
        )
        lines, said = legend_of(list(told), self.width - 220 * s, s)
        self._canvas.draw([(panel, [*shapes, *lines])], [*words, *said])

    def _states_at(self, seconds: float) -> tuple[JointState, ...]:
        """Tell what joints are seen to do at a time."""
        recording = self._recording
        turns, shifts = self._at(seconds)
        assembly = recording.problem.assembly
        poses = np.concatenate(
            [
                recording.poses[0, :, :3] + shifts / assembly.size,
                Rotation.from_matrix(turns).as_rotvec(),
            ],
            axis=1,
        )
        return states_at(assembly, poses)
