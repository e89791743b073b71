"""A block that rocks, from impact to impact: the truth that engines are held against.

A rectangle turns about one lower corner (Housner, Bull. Seism. Soc. Am. 53, 1963, 403-417):

    angle'' = p^2 (a cos(alpha - angle) - sin(alpha - angle)),    p^2 = 3 g / (4 R)

for angle > 0, tan alpha = width/height, R half the diagonal, and its mirror image. `a` is the
ground's acceleration [g]. When the angle comes to 0 the other corner hits. Nothing bounces and
nothing slips, so the impulse acts at that corner alone, and about it angular momentum stays:
the block keeps 1 - 1.5 sin^2 alpha of its angular velocity, or none where that is below 0. The
impulse leans by (height/width) (1 - kept)/(1 + kept), which friction has to bear.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from blocksim import Problem, structure_of

G = 9.81
LONGEST, SHARE, STILL = 0.02, 0.1, 1e-8
FALLEN = math.pi / 2


def block(width: float = 1.0, height: float = 4.0, mu: float = 2.0) -> Problem:
    """A block on a floor."""
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    corners = [[0, 0], [width, 0], [width, height], [0, height]]
    return structure_of({"friction": mu, "blocks": [floor, {"id": 1, "vertices": corners}]})


def on_shaking_ground(problem: Problem, **shake: object) -> Problem:
    """The same on ground that shakes, as a structure file says how."""
    return structure_of(problem.to_dict() | {"shake": shake})


def on_pulse(problem: Problem, shape: str, amplitude: float, duration: float) -> Problem:
    """The same on ground that shakes by one pulse [g, s]."""
    return on_shaking_ground(problem, shape=shape, amplitude_g=amplitude, duration_s=duration)


def on_record(problem: Problem, times: np.ndarray, values: np.ndarray) -> Problem:
    """The same on ground that shakes by a record [s, g]."""
    return on_shaking_ground(problem, times_s=times.tolist(), accelerations_g=values.tolist())


@dataclass
class Rocks:
    """What became of it."""

    overturns: bool = False
    largest: float = 0.0
    impacts: list[float] = field(default_factory=list)
    peaks: list[float] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)


def still(_: float) -> float:
    """Ground at rest."""
    return 0.0


def rocks(
    width: float,
    height: float,
    ground: Callable[[float], float] = still,
    *,
    angle: float = 0.0,
    until: float = 60.0,
    shaken: float = 0.0,
    longest: float = LONGEST,
    most: int = 10_000,
) -> Rocks:
    """Follow a block on ground that shakes until a time `shaken`, at most until another."""
    alpha, radius = math.atan2(width, height), math.hypot(width, height) / 2
    squared = 3 * G / (4 * radius)
    kept = max(0.0, 1 - 1.5 * math.sin(alpha) ** 2)
    found, time, speed = Rocks(), 0.0, 0.0
    angle_now = angle
    while time < until and len(found.impacts) < most:
        if angle_now == 0.0 and abs(speed) < STILL:
            lifts = _lifts(ground, math.tan(alpha), time, shaken, longest)
            if lifts is None:
                return found
            time, speed = lifts, 0.0
            sense = math.copysign(1.0, ground(time))
        else:
            sense = math.copysign(1.0, angle_now or speed)

        def motion(now: float, state: np.ndarray, sense: float = sense) -> list[float]:
            tilt = alpha - sense * state[0]
            push = sense * ground(now) * math.cos(tilt) - math.sin(tilt)
            return [state[1], sense * squared * push]

        def lands(_: float, state: np.ndarray, sense: float = sense) -> float:
            return sense * float(state[0])

        def falls(_: float, state: np.ndarray) -> float:
            return FALLEN - abs(float(state[0]))

        def turns(_: float, state: np.ndarray, sense: float = sense) -> float:
            return sense * float(state[1])

        lands.terminal = falls.terminal = True  # type: ignore[attr-defined]
        lands.direction = turns.direction = -1  # type: ignore[attr-defined]
        flight = 2 * abs(speed) / (squared * math.sin(alpha)) if angle_now == 0 else longest
        most_step = min(longest, SHARE * flight) if flight else longest / 20
        if flight == 0:
            # Just lifted: a little way first, for a place to fall back to.
            ahead = solve_ivp(
                motion, (time, time + most_step), [0.0, 0.0], rtol=1e-11, atol=1e-15
            )
            time, (angle_now, speed) = time + most_step, ahead.y[:, -1]
            if sense * angle_now <= 0:
                angle_now, speed = 0.0, 0.0
                continue
        run = solve_ivp(
            motion,
            (time, until),
            [angle_now, speed],
            events=[lands, falls, turns],
            rtol=1e-10,
            atol=1e-14,
            max_step=min(longest, most_step),
            method="DOP853",
        )
        found.largest = max(found.largest, float(np.abs(run.y[0]).max()))
        found.peaks += [float(abs(state[0])) for state in run.y_events[2][:1]]
        time = float(run.t[-1])
        if len(run.t_events[1]):
            found.overturns = True
            return found
        if not len(run.t_events[0]):
            return found
        found.impacts.append(time)
        angle_now, speed = 0.0, kept * float(run.y[1, -1])
        found.speeds.append(abs(speed))
    return found


def _lifts(
    ground: Callable[[float], float], least: float, time: float, shaken: float, longest: float
) -> float | None:
    """When the ground's acceleration next is more than the block bears at rest."""

    def more(now: float) -> float:
        return abs(ground(now)) - least

    if more(time) > 0:
        return time
    step = longest / 20
    while time < shaken:
        if more(time + step) > 0:
            return float(brentq(more, time, time + step, xtol=1e-13))
        time += step
    return None
