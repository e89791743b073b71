"""Motions whose end is known, each as a problem and what its first block comes to.

Truth: closed forms, and equations of motion integrated to 1e-9 and less from event to event,
with nothing of blocksim in them:

- a block that falls, begun at rest, and one that is thrown up with a spin: parabolas;
- a block that slides and stops: the way v^2/(2 mu g);
- a block of 1 x 4 m that leans rocks (Housner 1963): the tops after 1, 3 and 10 impacts;
- two legs of different length with a beam, on ground that leans: three links on four hinges,
  from rest to half a radian: the turn of the first leg;
- a block that slides, tips about its leading corner and topples when that stops: its turn;
- two columns with a lintel rock as one (N. Makris and M. F. Vassiliou; the equation is derived
  here): the tops after 1 and 3 impacts.

Lengths are in units of the size, times in those of sqrt(size/g).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from scipy.integrate import solve_ivp

from blocksim import Problem, structure_of
from blocksim.blocks.assembly import Array
from blocksim.blocks.space.extruded import extruded
from blocksim.engines import get_engine

FINE = {"rtol": 1e-11, "atol": 1e-12}
HELD = 2000
"""Sweeps before a block is let go: these few have converged by then."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A motion of a problem, and what it comes to by a time, in the pose of the first block.

    `column`: Of that pose in the plane: x, y or the rotation.
    `since`: Where it was, less than as built.
    """

    name: str
    problem: Problem
    until: float
    truth: float
    column: int
    since: float = 0.0

    def seen(self, step: float, engine: str = "direct", *, in_space: bool = False) -> float:
        """Return what an engine makes of it, in steps of about that length."""
        count = round(self.until / step)
        made, _ = world(self.problem, engine, self.until / count, in_space=in_space)
        first = made.poses()
        made.advance(count)
        moved = made.poses()[0] - first[0]
        # Prisms stand in x and z, and turn about -y.
        way = (moved[[0, 2, 4]] * [1, 1, -1] if in_space else moved)[self.column]
        return abs(float(way) + self.since)

    def is_of(self, engine: str, *, in_space: bool) -> bool:
        """Tell whether an engine takes it."""
        found = get_engine(engine)
        if in_space:
            return found.build_in_space is not None and not len(self.problem.velocities)
        return found.shakes or not len(self.problem.velocities)


def world(
    problem: Problem, engine: str, step: float | None = None, *, in_space: bool = False
) -> tuple[Any, float]:
    """Return blocks let go in an engine, and its step."""
    asked, found = extruded(problem) if in_space else problem, cast("Any", get_engine(engine))
    build = found.build_in_space if in_space else found.build
    rule = (found.rule_in_space if in_space else found.rule)(asked.assembly)
    made = build(asked, replace(rule, step=step or rule.step))
    made.hold(HELD)
    if len(problem.velocities):
        size = problem.assembly.size
        made.push(problem.velocities / [size, size, 1.0] * problem.seconds)
    return made, rule.step


def blocks(mu: float, *corners: list[list[float]], free: bool = False) -> Problem:
    """Blocks on a floor, or `free` above it."""
    floor = {"id": 0, "vertices": box(-20, -1, 40, 1), "fixed": True}
    made = [{"id": at, "vertices": each, "free": free} for at, each in enumerate(corners, 1)]
    return structure_of({"friction": mu, "blocks": [floor, *made]})


def box(x: float, y: float, width: float, height: float) -> list[list[float]]:
    """Corners of a rectangle, from its lower left one."""
    return [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]


def moving(problem: Problem, *velocities: list[float]) -> Problem:
    """Blocks with velocities, in units of the size and sqrt(size/g)."""
    size = problem.assembly.size
    return replace(problem, velocities=velocities * np.array([size, size, 1]) / problem.seconds)


def falling() -> Motion:
    """Let a block fall that touches nothing."""
    problem = blocks(0.5, box(0, 6, 1, 2), free=True)
    return Motion(name="free fall", problem=problem, until=1.6, truth=1.6**2 / 2, column=1)


def thrown() -> Motion:
    """Throw a block of 1 x 2 m up, with a spin: how high it is after most of its way."""
    up, until = 1.0, 1.6
    problem, truth = blocks(0.5, box(0, 0, 1, 2)), up * until - until**2 / 2
    problem = moving(problem, [0.3, up, 0.4])
    return Motion(name="thrown up", problem=problem, until=until, truth=truth, column=1)


def stopped() -> Motion:
    """Let a flat block slide until friction has stopped it."""
    mu, speed = 0.3, 0.5
    problem, truth = blocks(mu, box(0, 0, 2, 0.5)), speed**2 / (2 * mu)
    problem = moving(problem, [speed, 0.0, 0.0])
    return Motion(name="slide that stops", problem=problem, until=2.0, truth=truth, column=0)


def sliding() -> Motion:
    """Let a flat block slide down, from rest."""
    mu, lean, until = 0.4, math.radians(30), 1.5
    problem = blocks(mu, box(0, 0, 2, 1)).tilted(lean)
    truth = (math.sin(lean) - mu * math.cos(lean)) * until**2 / 2
    return Motion(name="slide from rest", problem=problem, until=until, truth=truth, column=0)


def tops(
    squared: float, alpha: float, spin: float, kept: float, impacts: int
) -> tuple[float, float, float]:
    """Return when a block that sets off upright is highest, and after impacts, with its turn.

    Each impact leaves a share `kept` of its spin.
    """
    first = until = turn = 0.0

    def stops(_: float, state: Array) -> float:
        return float(state[1])

    stops.terminal = True  # type: ignore[attr-defined]
    for at in range(impacts + 1):
        way = solve_ivp(
            lambda _, state: [state[1], -squared * math.sin(alpha - state[0])],
            (0.0, 99.0),
            [0.0, spin * kept**at],
            events=stops,
            **FINE,
        )
        last, turn = float(way.t[-1]), float(way.y[0, -1])
        first = first or last
        until += last if at == impacts else 2 * last
    return first, until, turn


def rocking(impacts: int, lean: float = 0.15) -> Motion:
    """Let a block of 1 x 4 m rock that leans on its left corner."""
    width, height = 1.0, 4.0
    alpha = math.atan2(width, height)
    turned = np.array(box(0, 0, width, height)) @ [1, 1j] * np.exp(1j * lean)
    problem = blocks(2.0, np.column_stack([turned.real, turned.imag]).tolist())
    squared = 3 / (2 * math.hypot(width, height) / problem.assembly.size)
    spin = math.sqrt(2 * squared * (math.cos(alpha - lean) - math.cos(alpha)))
    first, until, turn = tops(squared, alpha, spin, 1 - 1.5 * math.sin(alpha) ** 2, impacts)
    name = f"rocking, top after {impacts} impacts"
    return Motion(
        name=name, problem=problem, until=until - first, truth=turn, column=2, since=lean
    )


def framed(impacts: int) -> Motion:
    """Push two columns of 1 x 5 m with a lintel of as much weight as both.

    Each column turns as a block does; the lintel goes along with their tops and does not turn.
    About the new corners, momentum along the motion that is left stays in an impact.
    """
    width, height, share = 1.0, 5.0, 1.0
    problem = blocks(
        3.0,
        box(0, 0, width, height),
        box(6, 0, width, height),
        box(0, height, 7, 2 * share * width * height / 7),
    )
    size, alpha = problem.assembly.size, math.atan2(width, height)
    radius = math.hypot(width, height) / 2 / size
    squared = 3 / (4 * radius) * (1 + 2 * share) / (1 + 3 * share)
    kept = (1 - 1.5 * math.sin(alpha) ** 2 + 3 * share * math.cos(2 * alpha)) / (1 + 3 * share)
    spin = math.sqrt(2 * squared * (math.cos(alpha - 0.1) - math.cos(alpha)))
    _, until, turn = tops(squared, alpha, spin, kept, impacts)
    x, y = width / 2 / size, height / 2 / size
    column, lintel = [-spin * y, spin * x, spin], [-2 * spin * y, 2 * spin * x, 0.0]
    name, problem = (
        f"frame, top after {impacts} impacts",
        moving(problem, column, column, lintel),
    )
    return Motion(name=name, problem=problem, until=until, truth=turn, column=2)


def toppling() -> Motion:
    """Push a block of 1 x 2 m, which slides, tips meanwhile, stops there and topples."""
    mu, width, height, speed, until = 0.65, 1.0, 2.0, 1.6, 1.6
    problem = blocks(mu, box(0, 0, width, height))
    size = problem.assembly.size
    alpha, radius = math.atan2(width, height), math.hypot(width, height) / 2 / size
    inertia = radius**2 / 3

    def arms(turn: float) -> tuple[float, float]:
        """Return how far the centre is left of the lower right corner, and above it."""
        return radius * math.sin(alpha - turn), radius * math.cos(alpha - turn)

    def slides(_: float, state: Array) -> list[float]:
        turn, spin = float(state[0]), float(state[1])
        x, y = arms(turn)
        # The corner stays on the floor: up'' = 1/m (N - m g) = d2(y)/dt2 with y' = x turn'.
        # About the centre N turns back by its arm x, friction mu N on by its arm y.
        pressed = (1 - y * spin**2) / (1 - x * (mu * y - x) / inertia)
        gained = pressed * (mu * y - x) / inertia
        # The corner's velocity is the centre's less that of turning: v - y turn'.
        corner = -mu * pressed - (y * gained + x * spin**2)
        return [spin, gained, corner]

    def stops(_: float, state: Array) -> float:
        return float(state[2])

    stops.terminal = True  # type: ignore[attr-defined]
    first = solve_ivp(slides, (0, until), [0.0, 0.0, speed], events=stops, **FINE)
    turn, spin, _ = first.y[:, -1]
    squared = 3 / (4 * radius)
    second = solve_ivp(
        lambda _, state: [state[1], -squared * math.sin(alpha - state[0])],
        (first.t[-1], until),
        [turn, spin],
        **FINE,
    )

    name, truth = "slide that ends in toppling", abs(float(second.y[0, -1]))
    problem = moving(problem, [speed, 0.0, 0.0])
    return Motion(name=name, problem=problem, until=until, truth=truth, column=2)


NEAR = 1e-5
"""Change of the turn for differences of energies."""


def hinged() -> Motion:
    """Let a leg of 2 m and one of 2.6 m fall with a beam, to the side on four hinges."""
    lean, until = math.radians(20), 2.1
    grounds = ([[-9, -3], [1, -3], [1, 0], [-9, 0]], [[1, -3], [12, -3], [12, -0.6], [1, -0.6]])
    fixed = [
        {"id": f"f{at}", "vertices": each, "fixed": True} for at, each in enumerate(grounds)
    ]
    shapes = (box(0, 0, 0.5, 2), box(3.5, -0.6, 0.5, 2.6), box(-0.2, 2, 4.4, 0.5))
    made = [{"id": at, "vertices": each} for at, each in enumerate(shapes)]
    problem = structure_of({"friction": 3.0, "blocks": [*fixed, *made]}).tilted(lean)
    # Feet and heads of the legs as complex numbers, then the centres of all three.
    feet, heads = np.array([0.5, 4 - 0.6j]), np.array([0 + 2j, 3.5 + 2j])
    centres = np.array([0.25 + 1j, 3.75 + 0.7j, 2 + 2.25j])
    mass, inertia = (np.array(each) for each in zip(*map(weighed, shapes), strict=True))
    pull = complex(math.sin(lean), -math.cos(lean))
    beam, leg = heads[1] - heads[0], heads[1] - feet[1]

    def placed(turn: float) -> tuple[Array, Array]:
        """Return the centres and turns of all three."""
        first = feet[0] + (heads[0] - feet[0]) * np.exp(1j * turn)
        # The second head is where circles about the first one and its own foot cross.
        way = feet[1] - first
        along = (abs(way) ** 2 + abs(beam) ** 2 - abs(leg) ** 2) / (2 * abs(way))
        up = math.sqrt(abs(beam) ** 2 - along**2)
        second = first + way / abs(way) * (along + 1j * up)
        turns = np.array(
            [turn, np.angle((second - feet[1]) / leg), np.angle((second - first) / beam)]
        )
        pivots, built = np.array([*feet, first]), np.array([*feet, heads[0]])
        return pivots + (centres - built) * np.exp(1j * turns), turns

    def energies(turn: float) -> tuple[float, float]:
        """Return the potential energy, and twice the kinetic one at a spin of 1."""
        (one, before), (two, after) = placed(turn - NEAR), placed(turn + NEAR)
        speeds, spins = (two - one) / (2 * NEAR), (after - before) / (2 * NEAR)
        where, _ = placed(turn)
        moving = float((mass * abs(speeds) ** 2 + inertia * spins**2).sum())
        return -float((mass * (where * np.conj(pull)).real).sum()), moving

    def motion(_: float, state: Array) -> list[float]:
        turn, spin = float(state[0]), float(state[1])
        (low, less), (high, more) = energies(turn - NEAR), energies(turn + NEAR)
        bend = (more - less) / (2 * NEAR) * spin**2 / 2
        return [spin, -((high - low) / (2 * NEAR) + bend) / energies(turn)[1]]

    truth = solve_ivp(
        motion, (0, until * math.sqrt(problem.assembly.size)), [0.0, 0.0], rtol=1e-9, atol=1e-11
    )

    turn = abs(float(truth.y[0, -1]))
    return Motion(name="four hinges", problem=problem, until=until, truth=turn, column=2)


def weighed(corners: list[list[float]]) -> tuple[float, float]:
    """Area of a rectangle, and its moment of inertia."""
    (x, y), (end, top) = corners[0], corners[2]
    width, height = end - x, top - y
    return width * height, width * height * (width**2 + height**2) / 12
