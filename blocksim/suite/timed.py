"""Scenes of which the motion is known in closed form, or by one equation of motion.

Each is drawn in three sizes. What rocks follows Housner (1963): a slender block on a corner
turns back, meets the floor with its whole base, and turns on about the other corner with the
share 1 - 3/2 sin^2(alpha) of its angular velocity.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY as G
from blocksim.suite.scene import Body, Scene

SIZES = (0.6, 1.0, 1.7)
"""Sizes each scene is drawn in [m]."""
DENSITY = 2000.0
"""[kg/m^3]"""
FRAMES = 10
ALPHA = math.atan(1 / 3)
"""Angle of what rocks: its width over its height."""
DOWN = np.array([0.0, -G])
Path = Callable[[Array], Array]
"""Times [s] to poses x, y and angle of each body, (frames, bodies, 3) float."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A scene, and the motion that is known."""

    scene: Scene
    path: Path

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.name

    @property
    def group(self) -> str:
        """The kind of motion."""
        return self.scene.group

    @cached_property
    def poses(self) -> Array:
        """Poses at the scene's times."""
        return self.path(self.scene.times)


def motions() -> Iterator[Motion]:
    """Make all scenes of known motion."""
    for number, size in enumerate(SIZES):
        for make in (_thrown, _slides_down, _comes_to_rest, _meets, _lands, _tips):
            yield make(size, f"{make.__name__[1:].replace('_', '-')}-{number + 1}")
        for name, after in (("falls-back", False), ("rocks-on", True)):
            yield _rocks(size, f"{name}-{number + 1}", after=after)


def _box(
    name: str, corner: tuple[float, float], sides: tuple[float, float],
    velocity: tuple[float, float] = (0.0, 0.0), spin: float = 0.0, angle: float = 0.0,
) -> Body:  # fmt: skip
    """Make a box, turned by an angle about its lower left corner."""
    (width, height), at = sides, np.array(corner)
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array([[cos, sin], [-sin, cos]])
    local = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
    mass = DENSITY * width * height
    return Body(
        name=name,
        shapes=(at + local @ turn,),
        mass=mass,
        centre=at + np.array([width, height]) / 2 @ turn,
        inertia=mass * (width**2 + height**2) / 12,
        velocity=np.array(velocity),
        spin=spin,
    )


def _motion(
    name: str, group: str, bodies: tuple[Body, ...], path: Path, duration: float,
    friction: float, gravity: Array = DOWN,
) -> Motion:  # fmt: skip
    reach = 30 * SIZES[-1]
    corners = np.array([[-reach, -2.0], [reach, -2.0], [reach, 0.0], [-reach, 0.0]])
    floor = Body(name="floor", shapes=(corners,), centre=np.zeros(2))
    return Motion(
        scene=Scene(
            name=name,
            group=group,
            level=None,
            gravity=gravity,
            friction=friction,
            bodies=(floor, *bodies),
            times=np.linspace(0.0, duration, FRAMES),
            bound=0.0,
        ),
        path=path,
    )


def _straight(bodies: tuple[Body, ...], ways: Callable[[Array], Array]) -> Path:
    """Return the path of bodies that do not turn, from their ways (bodies, frames, 2)."""

    def path(times: Array) -> Array:
        start = np.array([body.centre for body in bodies])
        at = start[:, None] + ways(times)
        return np.concatenate([at, np.zeros((*at.shape[:2], 1))], axis=-1).swapaxes(0, 1)

    return path


def _thrown(size: float, name: str) -> Motion:
    """Make a box that is thrown and spun."""
    velocity, spin = (1.5, 2.0), 3.0
    body = _box("box", (0.0, 6 * size), (size, size / 2), velocity, spin)

    def path(times: Array) -> Array:
        at = body.centre + np.outer(times, velocity) + np.outer(times**2 / 2, DOWN)
        return np.column_stack([at, spin * times])[:, None]

    return _motion(name, "free fall", (body,), path, math.sqrt(4 * size / G), 0.5)


def _slides_down(size: float, name: str) -> Motion:
    """Make a box on a slope of 25 degrees with friction 0.3."""
    slope, mu = math.radians(25), 0.3
    gains = G * (math.sin(slope) - mu * math.cos(slope))
    bodies = (_box("box", (-4 * size, 0.0), (size, size / 2)),)
    path = _straight(bodies, lambda t: np.stack([gains * t**2 / 2, 0 * t], axis=-1)[None])
    pull = G * np.array([math.sin(slope), -math.cos(slope)])
    duration = math.sqrt(8 * size / gains)
    return _motion(name, "sliding in time", bodies, path, duration, mu, pull)


def _comes_to_rest(size: float, name: str) -> Motion:
    """Make a box that slides, on level ground, until friction has stopped it."""
    mu, speed = 0.25, 2.0 * math.sqrt(size)
    bodies = (_box("box", (-2 * size, 0.0), (size, size / 2), (speed, 0.0)),)
    stops = speed / (mu * G)

    def ways(times: Array) -> Array:
        until = np.minimum(times, stops)
        return np.stack([speed * until - mu * G * until**2 / 2, 0 * times], axis=-1)[None]

    return _motion(name, "sliding in time", bodies, _straight(bodies, ways), 1.5 * stops, mu)


def _meets(size: float, name: str) -> Motion:
    """Make a box that meets one half as heavy on ice: they go on together."""
    speed, gap = 1.5 * math.sqrt(size), 0.5 * size
    first = _box("first", (-2 * size, 0.0), (size, size / 2), (speed, 0.0))
    second = _box("second", (gap - size, 0.0), (size / 2, size / 2))
    meet, both = gap / speed, speed * first.mass / (first.mass + second.mass)

    def ways(times: Array) -> Array:
        after = both * np.maximum(times - meet, 0.0)
        one = speed * np.minimum(times, meet) + after
        return np.stack([np.stack([x, 0 * x], axis=-1) for x in (one, after)])

    bodies = (first, second)
    return _motion(name, "impact", bodies, _straight(bodies, ways), 4 * meet, 0.0)


def _lands(size: float, name: str) -> Motion:
    """Make a box that falls on its base, and stays."""
    high = size / 2
    bodies = (_box("box", (0.0, high), (size, size / 2)),)

    def ways(times: Array) -> Array:
        fallen = np.minimum(G * times**2 / 2, high)
        return np.stack([0 * times, -fallen], axis=-1)[None]

    duration = 3 * math.sqrt(2 * high / G)
    return _motion(name, "impact", bodies, _straight(bodies, ways), duration, 0.5)


@dataclass(frozen=True)
class _Rocking:
    """A block of width and height that turns about a lower corner.

    A lean is its angle from upright to the side of that corner [rad]; `first` is that of the
    start.
    """

    width: float
    height: float
    first: float

    @property
    def radius(self) -> float:
        return math.hypot(self.width, self.height) / 2

    def turns(self, lean: float, speed: float, until: float) -> Callable[[Array], Array]:
        """Return the lean over time, from a lean and its speed."""

        def rates(_: float, state: Array) -> Array:
            pull = 3 * G / (4 * self.radius) * math.sin(ALPHA - state[0])
            return np.array([state[1], -pull])

        found: Any = solve_ivp(
            rates, (0.0, until), (lean, speed), "DOP853", rtol=1e-12, atol=1e-13,
            dense_output=True,
        )  # fmt: skip
        return found.sol

    def poses(self, lean: Array, foot: float, side: float) -> Array:
        """Return poses at leans over a foot on the right (1) or on the left (-1)."""
        away = ALPHA - lean
        x = foot - side * self.radius * np.sin(away)
        angle = self.first - side * lean
        return np.column_stack([x, self.radius * np.cos(away), angle])[:, None]

    @property
    def body(self) -> Body:
        """The block, leaning to the right about a corner at the origin."""
        left = (-self.width * math.cos(self.first), self.width * math.sin(self.first))
        return _box("block", left, (self.width, self.height), angle=-self.first)


def _tips(size: float, name: str) -> Motion:
    """Make a block let go beyond its balance, until it lies almost flat."""
    block = _Rocking(size / 2, 1.5 * size, first=1.2 * ALPHA)
    leans = block.turns(block.first, 0.0, 10.0 * math.sqrt(size))
    times = np.linspace(0.0, 10.0 * math.sqrt(size), 100_001)
    duration = float(times[np.argmax(leans(times)[0] > 1.2)])

    def path(times: Array) -> Array:
        return block.poses(leans(times)[0], 0.0, 1.0)

    return _motion(name, "rocking", (block.body,), path, duration, 1.5)


def _rocks(size: float, name: str, *, after: bool) -> Motion:
    """Make a block let go on its corner: until it is upright, or on to the other side."""
    block = _Rocking(size / 2, 1.5 * size, first=0.5 * ALPHA)
    rate = math.sqrt(3 * G / (4 * block.radius))
    leans = block.turns(block.first, 0.0, 5 / rate)
    low, high = 0.0, 5 / rate
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if leans(np.array([middle]))[0, 0] > 0 else (low, middle)
    kept = 1 - 1.5 * math.sin(ALPHA) ** 2
    other = block.turns(0.0, -kept * float(leans(np.array([low]))[1, 0]), 5 / rate)

    def path(times: Array) -> Array:
        first = block.poses(leans(np.minimum(times, low))[0], 0.0, 1.0)
        second = block.poses(other(np.maximum(times - low, 0.0))[0], -block.width, -1.0)
        return np.where((times < low)[:, None, None], first, second)

    duration = low * (1.5 if after else 0.95)
    group = "impact" if after else "rocking"
    return _motion(name, group, (block.body,), path, duration, 1.5)
