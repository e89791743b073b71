"""How errors of motion by `direct` fall with its step: six motions, five steps.

Question: of which order is each, and how far off is it at the usual step?

Expected: second order, and no more than 0.1 % off at the usual step of 0.025 sqrt(size/g).

Truth: closed forms, and equations of motion integrated to 1e-9 and less from event to event,
with nothing of blocksim in them:

- a block thrown up with a spin: a parabola; the pose just before it lands;
- a block that slides and stops: the way v^2/(2 mu g);
- a block of 1 x 4 m rocks (Housner 1963): the tops after 1, 3 and 10 impacts;
- two legs of different length with a beam, on ground that leans: three links on four hinges,
  from rest to half a radian: the turn of the first leg;
- a block that slides, tips about its leading corner and topples when that stops: its turn;
- two columns with a lintel rock as one (N. Makris and M. F. Vassiliou; the equation is derived
  here): the tops after 1 and 3 impacts.

Lengths are in units of the size, times in those of sqrt(size/g).

    python -m analysis.convergence OUT [--quick]
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from analysis.command import run
from analysis.rows import write_rows
from blocksim import Problem, structure_of
from blocksim.blocks.assembly import Array
from blocksim.engines.direct import ENGINE, Blocks

STEPS, QUICK = (0.1, 0.05, 0.025, 0.0125, 0.00625), (0.05, 0.025)
ROUND_OFF = 1e-12
FINE = {"rtol": 1e-11, "atol": 1e-12}
Way = Callable[[float], float]
"""What a motion comes to at a step: its value, which is held to the truth."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A motion, what it comes to, and how `direct` sees it in steps of a length."""

    name: str
    truth: float
    seen: Way


def main(out: Path, *, quick: bool = False) -> list[dict[str, object]]:
    """Let every motion go in steps of each length, write rows, and return them."""
    rows: list[dict[str, object]] = []
    for motion in motions():
        last = 0.0
        for step in QUICK if quick else STEPS:
            started = time.process_time()
            value = motion.seen(step)
            error = abs(value / motion.truth - 1)
            rows.append(
                {
                    "motion": motion.name,
                    "step": step,
                    "truth": motion.truth,
                    "seen": value,
                    "error": error,
                    "order": round(math.log2(last / error), 2) if last > ROUND_OFF else "",
                    "cpu_s": round(time.process_time() - started, 3),
                }
            )
            last = error
    write_rows(out / "convergence.csv", rows)
    return rows


def motions() -> Iterator[Motion]:
    """Give every motion."""
    yield thrown()
    yield stopped()
    for impacts in (1, 3, 10):
        yield rocking(impacts)
    yield hinged()
    yield toppling()
    for impacts in (1, 3):
        yield framed(impacts)


def blocks(mu: float, *corners: list[list[float]]) -> Problem:
    """Blocks on a floor."""
    floor = {"id": 0, "vertices": [[-20, -1], [20, -1], [20, 0], [-20, 0]], "fixed": True}
    made = [{"id": at, "vertices": each} for at, each in enumerate(corners, 1)]
    return structure_of({"friction": mu, "blocks": [floor, *made]})


def box(x: float, y: float, width: float, height: float) -> list[list[float]]:
    """Corners of a rectangle, from its lower left one."""
    return [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]


def world(problem: Problem, step: float, velocities: Array | None = None) -> Blocks:
    """Blocks as built, with velocities."""
    made = Blocks(problem, replace(ENGINE.rule(problem.assembly), step=step))
    made.hold(1)
    if velocities is not None:
        made.push(velocities)
    return made


def later(made: Blocks, step: float, until: float) -> Array:
    """Return the poses after a time, of which the step is a part."""
    made.advance(round(until / step))
    return made.poses()


def thrown() -> Motion:
    """Throw a block of 1 x 2 m up, with a spin: how high it is after most of its way."""
    problem, up, until = blocks(0.5, box(0, 0, 1, 2)), 1.0, 1.6
    start = float(problem.assembly.built[0, 1])

    def seen(step: float) -> float:
        made = world(problem, step, np.array([[0.3, up, 0.4]]))
        return float(later(made, step, until)[0, 1])

    return Motion(name="thrown up", truth=start + up * until - until**2 / 2, seen=seen)


def stopped() -> Motion:
    """Let a flat block slide until friction has stopped it."""
    mu, speed = 0.3, 0.5
    problem = blocks(mu, box(0, 0, 2, 0.5))

    def seen(step: float) -> float:
        made = world(problem, step, np.array([[speed, 0.0, 0.0]]))
        return float(later(made, step, 2.0)[0, 0] - problem.assembly.built[0, 0])

    return Motion(name="slide that stops", truth=speed**2 / (2 * mu), seen=seen)


def top_after(made: Blocks, impacts: int) -> float:
    """Follow the turn of the first block to its top after so many impacts."""
    turns, changes = [0.0, 0.0], 0
    while True:
        made.advance(1)
        turns.append(float(made.poses()[0, 2]))
        one, two, three = (abs(each) for each in turns[-3:])
        changes += turns[-1] * turns[-2] < 0
        if changes == impacts and one < two >= three:
            return two - (three - one) ** 2 / (8 * (one - 2 * two + three))


def rocking(impacts: int, width: float = 1.0, height: float = 4.0) -> Motion:
    """Push a block on the ground, to turn by 0.15 rad before its first impact."""
    problem = blocks(2.0, box(0, 0, width, height))
    size, alpha = problem.assembly.size, math.atan2(width, height)
    squared = 3 / (2 * math.hypot(width, height) / size)
    spin = math.sqrt(2 * squared * (math.cos(alpha - 0.15) - math.cos(alpha)))
    speed = spin * (1 - 1.5 * math.sin(alpha) ** 2) ** impacts
    truth = alpha - math.acos(math.cos(alpha) + speed**2 / (2 * squared))
    half = np.array([width, height]) / 2 / size

    def seen(step: float) -> float:
        start = np.array([[-spin * half[1], spin * half[0], spin]])
        return top_after(world(problem, step, start), impacts)

    return Motion(name=f"rocking, top after {impacts} impacts", truth=truth, seen=seen)


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
    speed = spin * kept**impacts
    truth = alpha - math.acos(math.cos(alpha) + speed**2 / (2 * squared))
    x, y = width / 2 / size, height / 2 / size

    def seen(step: float) -> float:
        column = [-spin * y, spin * x, spin]
        lintel = [-2 * spin * y, 2 * spin * x, 0.0]
        return top_after(world(problem, step, np.array([column, column, lintel])), impacts)

    return Motion(name=f"frame, top after {impacts} impacts", truth=truth, seen=seen)


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

    def seen(step: float) -> float:
        made = world(problem, step, np.array([[speed, 0.0, 0.0]]))
        return -float(later(made, step, until)[0, 2])

    return Motion(name="slide that ends in toppling", truth=float(second.y[0, -1]), seen=seen)


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

    def seen(step: float) -> float:
        return float(later(world(problem, step), step, until)[0, 2])

    return Motion(name="four hinges", truth=float(truth.y[0, -1]), seen=seen)


def weighed(corners: list[list[float]]) -> tuple[float, float]:
    """Area of a rectangle, and its moment of inertia."""
    (x, y), (end, top) = corners[0], corners[2]
    width, height = end - x, top - y
    return width * height, width * height * (width**2 + height**2) / 12


if __name__ == "__main__":
    run(main, lambda rows: "\n".join(map(str, rows)))
