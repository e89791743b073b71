"""Blocks on ground that shakes: what pulls in a step, and when in it they begin to move."""

from __future__ import annotations

from typing import Any

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Problem

AT_REST = 1e-9
"""Velocity of blocks at rest [sqrt(size g)]."""
BEGINS = 1 / 32
"""Share of a step to which the moment is known at which blocks begin to move."""


class OnGround:
    """A world whose ground may shake.

    `_asked`: The problem.
    `_step`: Of the settings [sqrt(size/g)].
    `_time`: Since the release.
    `_sets_off`: Whether blocks are known to begin to move in this step.
    """

    _asked: Problem[Any]
    _step: float
    _time: float
    _sets_off: bool

    @property
    def _is_at_rest(self) -> bool:
        """Whether no block moves."""
        return float(self._speeds().max()) < AT_REST

    def _speeds(self) -> Array:
        """Return the largest velocity of each block's corners, at most, (blocks,)."""
        raise NotImplementedError

    def _move(self, step: float) -> None:
        """Go on for a time."""
        raise NotImplementedError

    def _gravity_in(self, step: float) -> Array:
        """Go on in time; return gravity as it is seen from the ground meanwhile, (3,).

        By that at its end it is seen whether blocks at rest begin to move: by the mean of the
        step they might not, and begin too late. Where they rest at both ends they rest between.
        """
        start, self._time = self._time, self._time + step
        if self._asked.shaking is None:
            return self._asked.gravity
        if self._is_at_rest and not self._sets_off:
            start = self._time - BEGINS * step
        return self._asked.shaken(start, self._time)

    def _set_off(self, step: float, before: dict[str, Any]) -> None:
        """Take a step in which blocks at rest begin to move, from when they do on.

        `before`: All that was known at its beginning.
        """
        rests, moves = 0.0, step
        while moves - rests > BEGINS * self._step:
            middle = (rests + moves) / 2
            vars(self).update(before)
            self._move(middle)
            rests, moves = (middle, moves) if self._is_at_rest else (rests, middle)
        vars(self).update(before)
        if rests:
            self._move(rests)
        self._sets_off = True
        self._move(step - rests)
        self._sets_off = False
