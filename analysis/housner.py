"""Which sine pulses overturn a block: `direct` against Housner's equation with impacts.

Question: does `direct` at its usual step say of each pulse what the equation says? Blocks of
1 x 4 and 1 x 2 m, half and full sines, a grid of durations by amplitudes.

Expected: the same everywhere but within 0.5 % of the amplitude at which the equation changes
its mind. The equation (Housner, Bull. Seism. Soc. Am. 53, 1963, 403-417; derived in
`tests/rocking.py`) is solved for all pulses at once by the rule of Runge and Kutta in steps of
1 ms, which end at impacts. A run ends where a block lies, or where after the pulse it has too
little energy to pass its balance, which no impact adds to.

    python -m analysis.housner OUT [--quick]
"""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.command import run
from analysis.rows import write_rows
from blocksim import Problem, structure_of
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import STANDARD_GRAVITY
from blocksim.blocks.shaking import Shaking
from blocksim.engines.direct import ENGINE, Blocks

WIDTH, HEIGHTS = 1.0, (4.0, 2.0)
SHAPES = ("half-sine", "full-sine")
MANY, FEW = 40, 3
NEAR = 0.005
"""Share of an amplitude to whose both sides the equation has to say the same."""
STEP, ROUNDS = 1e-3, 6
"""Of the equation [s], and secants for the moment of an impact."""
LONGEST = 20.0
"""Time after which what still rocks has survived [s]."""
FALLEN = math.pi / 2
Told = NDArray[np.bool_]


def grid(height: float, count: int) -> tuple[Array, Array]:
    """Durations [s] and amplitudes [g], from what just lifts a block."""
    least = WIDTH / height
    return np.geomspace(0.2, 2.0, count), least * np.geomspace(1.02, 5.0, count)


def rocking(height: float) -> tuple[float, float, float]:
    """Angle of the diagonal [rad], 3 g/(4 R) [1/s^2], and the speed kept at an impact."""
    alpha, radius = math.atan2(WIDTH, height), math.hypot(WIDTH, height) / 2
    squared = 3 * STANDARD_GRAVITY / (4 * radius)
    return alpha, squared, max(0.0, 1 - 1.5 * math.sin(alpha) ** 2)


def overturned(height: float, shape: str, durations: Array, amplitudes: Array) -> Told:
    """Tell by the equation which pulses overturn a block, shape of both."""
    alpha, squared, kept = rocking(height)
    turns = math.pi * (2 if shape == "full-sine" else 1)
    angle, speed, now = (np.zeros_like(durations) for _ in range(3))
    falls = np.zeros(durations.shape, dtype=np.bool_)

    def ground(at: Array) -> Array:
        inside = (at >= 0) & (at <= durations)
        return np.where(inside, amplitudes * np.sin(turns * at / durations), 0.0)

    def gains(at: Array, where: Array, side: Array) -> Array:
        tilt = alpha - side * where
        return side * squared * (side * ground(at) * np.cos(tilt) - np.sin(tilt))

    def stepped(length: Array, side: Array) -> tuple[Array, Array]:
        half = length / 2
        a, b = speed, gains(now, angle, side)
        c, d = speed + half * b, gains(now + half, angle + half * a, side)
        e, f = speed + half * d, gains(now + half, angle + half * c, side)
        g, h = speed + length * f, gains(now + length, angle + length * e, side)
        return (
            angle + length / 6 * (a + 2 * c + 2 * e + g),
            speed + length / 6 * (b + 2 * d + 2 * f + h),
        )

    for _ in range(round(LONGEST / STEP)):
        push = ground(now + STEP / 2)
        lies = (angle == 0) & (speed == 0) & (np.abs(push) <= math.tan(alpha))
        side = np.sign(np.where(angle != 0, angle, np.where(speed != 0, speed, push)))
        length = np.full_like(now, STEP)
        after, rate = stepped(length, side)
        lands = (side * after < 0) & (side * angle > 0)
        if lands.any():
            one, two = np.zeros_like(length), length.copy()
            low, high = angle.copy(), after.copy()
            for _ in range(ROUNDS):
                with np.errstate(divide="ignore", invalid="ignore"):
                    cut = one - low * (two - one) / (high - low)
                cut = np.where(lands & np.isfinite(cut), cut, length)
                there, _ = stepped(cut, side)
                before = side * there > 0
                one, low = np.where(before, cut, one), np.where(before, there, low)
                two, high = np.where(before, two, cut), np.where(before, high, there)
            # The last secant: one end of what it is between may never have moved.
            length = np.where(lands, cut, length)
            after, rate = stepped(length, side)
            after, rate = np.where(lands, 0.0, after), np.where(lands, kept * rate, rate)
        # What lifts and comes down within a step has not lifted.
        rests = lies | ((side * after <= 0) & ~lands)
        angle = np.where(falls, angle, np.where(rests, 0.0, after))
        speed = np.where(falls, speed, np.where(rests, 0.0, rate))
        now = now + length
        falls |= np.abs(angle) > FALLEN
        if (falls | ((now > durations) & _caught(angle, speed, alpha, squared))).all():
            break
    return falls


def _caught(angle: Array, speed: Array, alpha: float, squared: float) -> Told:
    """Tell which blocks on ground at rest cannot pass their balance any more."""
    barrier = squared * (1 - np.cos(alpha - np.abs(angle)))
    return (np.abs(angle) < alpha) & (speed**2 / 2 < barrier)


def simulated(problem: Problem, alpha: float, squared: float) -> bool:
    """Tell by `direct`, at its usual step, whether a pulse overturns a block."""
    assert problem.shaking is not None  # noqa: S101
    settings, unit = ENGINE.rule(problem.assembly), problem.seconds
    world = Blocks(problem, settings)
    world.hold(1)
    for frame in range(1, round(LONGEST / unit / settings.step)):
        world.advance(1)
        turn = float(world.poses()[0, 2])
        if abs(turn) > FALLEN - alpha:
            return True
        over = frame * settings.step * unit > problem.shaking.duration
        spin = float(world.velocities[0, 2]) / unit
        if over and _caught(np.array(turn), np.array(spin), alpha, squared):
            return False
    return False


def asked(height: float, shape: str, count: int) -> list[dict[str, object]]:
    """Ask the pulses of a grid of one block, by the equation and by `direct`: rows."""
    floor = {"id": 0, "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
    corners = [[0, 0], [WIDTH, 0], [WIDTH, height], [0, height]]
    blocks = [floor, {"id": 1, "vertices": corners}]
    problem = structure_of({"friction": 3.0, "blocks": blocks})
    alpha, squared, _ = rocking(height)
    durations, amplitudes = (each.ravel() for each in np.meshgrid(*grid(height, count)))
    truth, less, more = (
        overturned(height, shape, durations, share * amplitudes)
        for share in (1.0, 1 - NEAR, 1 + NEAR)
    )
    near = (truth != less) | (truth != more)
    rows: list[dict[str, object]] = []
    for at, (duration, amplitude) in enumerate(
        zip(durations.tolist(), amplitudes.tolist(), strict=True)
    ):
        pulse = Shaking(shape=shape, amplitude=amplitude, duration=duration)
        rows.append(
            {
                "height_m": height,
                "shape": shape,
                "duration_s": round(duration, 6),
                "amplitude_g": round(amplitude, 6),
                "equation": bool(truth[at]),
                "direct": simulated(replace(problem, shaking=pulse), alpha, squared),
                "near": bool(near[at]),
            }
        )
    return rows


def main(out: Path, *, quick: bool = False, count: int = MANY) -> list[dict[str, object]]:
    """Ask all pulses, write rows, and return how many differ for each block and shape."""
    told: list[dict[str, object]] = []
    rows: list[dict[str, object]] = []
    for height, shape in itertools.product(HEIGHTS, SHAPES):
        started = time.process_time()
        found = asked(height, shape, FEW if quick else count)
        rows += found
        write_rows(out / "housner.csv.gz", rows)
        differ = [each for each in found if each["direct"] != each["equation"]]
        told.append(
            {
                "height_m": height,
                "shape": shape,
                "pulses": len(found),
                "overturn": sum(each["equation"] is True for each in found),
                "near_the_boundary": sum(each["near"] is True for each in found),
                "differ": sum(not each["near"] for each in differ),
                "differ_near": sum(each["near"] is True for each in differ),
                "cpu_s": round(time.process_time() - started, 1),
            }
        )
    return told


if __name__ == "__main__":
    run(main, lambda told: "\n".join(map(str, told)))
