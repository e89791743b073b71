"""Where the band of two answers ends in closed form, for one motion of the keystone.

Question: two_answers.py finds by search how far above its least thickness an arch may still
begin to move. Can that end be said in closed form, and what becomes of it with many voussoirs?

In the motion that is looked at one half turns away about the outer corner of its springing
joint. The keystone follows: it turns about the inner corner of its joint with the other half,
which rests, and its outer corner slides down along the half that leaves. Two rates and the
pressure at the sliding corner follow from two balances of moments and from the contact there.
The motion ends where its rates become nothing. There the pressure that holds the keystone also
holds the half.

Expected: that end is the one that `direct`'s solver finds as it follows the motion, with 101
voussoirs as well. It exists from mu tan(alpha/n) = 1 on only, and is below the thickness from
which the half stands by itself.

    python -m analysis.keystone OUT [--quick]

Rows are kept in OUT/keystone.jsonl as they come, and written as keystone.csv.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from analysis.command import run
from analysis.rows import write_rows
from analysis.saved_answers import Row, answers
from analysis.two_answers import THICKEST, Case, follow_on, has_limit, limit_of, settled
from blocksim.arch.circular import Weight
from blocksim.blocks.assembly import Array
from blocksim.blocks.problem import Load, Problem
from blocksim.engines.contact import Solution
from blocksim.engines.contact.coulomb import OPEN, SLIDES_UP, STICKS
from blocksim.limit import equilibrium

VOUSSOIRS = 7, 15, 27, 51, 101
ANGLES = 150.0, 152.5, 155.0, 157.5
FRICTIONS = 1.05, 1.2, 1.5
"""Friction times tan(alpha/n)."""
ROUNDED = 1e-9
"""Pull that a contact may need where forces are rounded [mean weights]."""
APART: tuple[tuple[int, Weight, float, float], ...] = ((7, "sector", 147.5, 5.0),)
"""An arch that rests just above its least thickness, and may move further up."""
BEFORE = THICKEST - 1e-9
"""Thickness up to which ends are looked for: from 2 on the inner faces are gone."""
NEAR = 0.997
"""Thickness over that of the end from which on the motion is followed."""
POWER = 1e-11
"""Power of the loads, over that of the fall, up to which nothing moves: many voussoirs move
little so near the end."""
BEYOND = 1.0005
"""Thickness over that of the end at which the rest of the arch is looked at."""


@dataclass(frozen=True, kw_only=True)
class Slide:
    """The keystone's motion in which one half leaves.

    Parameters
    ----------
    half, keystone : float
        Their angular accelerations, positive as they leave and fall [g/size].
    pressure : float
        At the corner that slides [mean weights].
    needed : float
        Friction over pressure at the corner about which the keystone turns, over mu.
    """

    half: float
    keystone: float
    pressure: float
    needed: float


class Keystone:
    """Moments and inertias of an arch of an odd number of voussoirs about the two corners.

    Parameters
    ----------
    problem : Problem
        An arch, its blocks and joints from left to right.
    """

    def __init__(self, problem: Problem) -> None:
        assembly, joints = problem.assembly, problem.assembly.joint_arrays
        self.middle = len(assembly.blocks) // 2
        self._centres, self._masses = assembly.centres / assembly.size, assembly.masses
        self._pull, self._mu = problem.pull(), float(problem.friction[self.middle])
        inner, outer = 0, 1
        self.foot = joints.ends[0, outer]
        self.corner = joints.ends[self.middle, outer]
        self.edge = joints.ends[self.middle + 1, inner]
        self._normal, self._tangent = joints.normal[self.middle], joints.tangent[self.middle]
        self._other = joints.normal[self.middle + 1], joints.tangent[self.middle + 1]
        half, own = range(self.middle), range(self.middle, self.middle + 1)
        self._inertias = self._inertia(self.foot, half), self._inertia(self.edge, own)
        self.overturning = self._moment(self.foot, half)
        self._tipping = self._moment(self.edge, own)

    @property
    def rubs(self) -> Array:
        """Force on the keystone at the sliding corner over its pressure: friction is up."""
        return self._normal + self._mu * self._tangent

    @property
    def excess(self) -> float:
        """What overturns the half beyond what the pressure `held` does against it."""
        return self.overturning - self._upright * self.held

    @property
    def held(self) -> float:
        """Pressure at the sliding corner that just holds the keystone."""
        return self._tipping / self._holding

    @property
    def slide(self) -> Slide:
        """The motion; none where a rate or the pressure is negative or `needed` above 1."""
        turned = _turned(self.corner - self.foot), _turned(self.corner - self.edge)
        apart = [float(self._normal @ each) for each in turned]
        of_half, of_keystone = self._inertias
        free = apart[0] * self.overturning / of_half - apart[1] * self._tipping / of_keystone
        pressed = apart[0] * self._upright / of_half - apart[1] * self._holding / of_keystone
        pressure = free / pressed
        half = (self.overturning - self._upright * pressure) / of_half
        keystone = (self._tipping - self._holding * pressure) / of_keystone
        middle = self.middle
        moved = keystone * _turned(self._centres[middle] - self.edge)
        force = self._masses[middle, :2] * moved - self._pull[middle, :2]
        normal, tangent = self._other
        other = pressure * self.rubs - force
        return Slide(
            half=half,
            keystone=keystone,
            pressure=pressure,
            needed=abs(float(other @ tangent)) / float(other @ normal) / self._mu,
        )

    def solution(self) -> Solution:
        """Return the motion as the contact solver begins with it."""
        slide, middle = self.slide, self.middle
        joints = 2 * middle + 2
        acceleration = np.zeros_like(self._centres, shape=(len(self._centres), 3))
        blocks = (slice(0, middle), self.foot, slide.half), (
            slice(middle, middle + 1), self.edge, slide.keystone)  # fmt: skip
        for own, about, rate in blocks:
            acceleration[own, :2] = [
                rate * _turned(each - about) for each in self._centres[own]
            ]
            acceleration[own, 2] = rate
        contacts = np.full((joints, 2), STICKS, dtype=np.int8)
        contacts[0] = OPEN, STICKS
        contacts[middle] = OPEN, SLIDES_UP
        contacts[middle + 1] = STICKS, OPEN
        forces = np.zeros((joints, 4))
        forces[middle, [1, 3]] = slide.pressure, self._mu * slide.pressure
        return Solution(
            acceleration=acceleration,
            forces=forces,
            contacts=contacts,
            residual=0.0,
            iterations=0,
        )

    @property
    def _holding(self) -> float:
        return -_cross(self.corner - self.edge, self.rubs)

    @property
    def _upright(self) -> float:
        return _cross(self.corner - self.foot, self.rubs)

    def _inertia(self, about: Array, blocks: range) -> float:
        own = self._masses[blocks]
        away = ((self._centres[blocks] - about) ** 2).sum(axis=1)
        return float((own[:, 2] + own[:, 0] * away).sum())

    def _moment(self, about: Array, blocks: range) -> float:
        arms, own = self._centres[blocks] - about, self._pull[blocks]
        return float((arms[:, 0] * own[:, 1] - arms[:, 1] * own[:, 0] + own[:, 2]).sum())


def _cross(arm: Array, force: Array) -> float:
    return float(arm[0] * force[1] - arm[1] * force[0])


def _turned(arm: Array) -> Array:
    """Velocity at the end of an arm that turns at rate 1."""
    return np.array([-arm[1], arm[0]])


def half_alone(case: Case, least: float) -> float | None:
    """Return the thickness from which a half without the keystone stands by itself.

    None where that is not between the least thickness of the arch and 2.
    """
    return _root(lambda eta: Keystone(case.problem(eta)).overturning, least)


def end(case: Case, least: float) -> float | None:
    """Return the thickness at which the motion ends; None where not between the least and 2."""
    return _root(lambda eta: Keystone(case.problem(eta)).excess, least)


def rest_holds(case: Case, eta: float) -> bool:
    """Tell whether the rest of the arch can rest under what the sliding corner carries.

    The arch is cut at the joint that slides, and the forces there are put on as loads.
    """
    problem = case.problem(eta)
    key, assembly = Keystone(problem), problem.assembly
    force = key.held * key.rubs * problem.unit_force
    point, middle = key.corner * assembly.size, key.middle
    joints = tuple(each for at, each in enumerate(assembly.joints) if at != middle)
    pair = (
        Load(force=force, blocks=(middle,), point=point),
        Load(force=-force, blocks=(middle - 1,), point=point),
    )
    cut = replace(problem, assembly=replace(assembly, joints=joints), dead=pair)
    # The forces are rounded, so to the last digit nothing need balance them.
    return equilibrium(cut).margin >= -ROUNDED


def _root(excess: Callable[[float], float], low: float, high: float = BEFORE) -> float | None:
    if not excess(low) > 0 > excess(high):
        return None
    return float(brentq(excess, low, high, xtol=1e-12))


def ask(case: Case) -> Row:
    """Find the end of the motion in closed form, and by following it."""
    least, mode = limit_of(case)
    ends = end(case, least)
    holds = ends is not None and rest_holds(case, ends * BEYOND)
    followed = None
    if holds:
        eta = ends * NEAR
        begun = settled(case.problem(eta), Keystone(case.problem(eta)).solution(), POWER)
        followed = None if begun is None else follow_on(case, eta, begun, POWER)
    return {
        "voussoirs": case.voussoirs,
        "weight": case.weight,
        "alpha_deg": case.alpha_deg,
        "mu": case.mu,
        "wedge": wedge(case),
        "eta_limit": least,
        "mode": mode,
        "eta_half": half_alone(case, least),
        "eta_end": ends,
        "needed": None if ends is None else Keystone(case.problem(ends)).slide.needed,
        "rest_holds": holds,
        "eta_followed": followed,
    }


def wedge(case: Case) -> float:
    """Return friction times the tangent of the keystone's half-angle."""
    return case.mu * math.tan(math.radians(case.alpha_deg) / case.voussoirs)


def cases() -> list[Case]:
    """Return wide arches whose friction cone at the keystone contains the vertical."""
    found = [
        Case(n, "centreline", alpha, share / math.tan(math.radians(alpha) / n))
        for n in VOUSSOIRS
        for alpha in ANGLES
        for share in FRICTIONS
    ]
    found += [Case(*each) for each in APART]
    return [each for each in found if has_limit(each)]


def main(out: Path, *, processes: int = 2, quick: bool = False) -> str:
    """Hold the closed form against the motion that is followed."""
    asked = cases()
    if quick:
        asked = [Case(7, "centreline", 155.0, 3.0), Case(101, "centreline", 155.0, 40.0)]
    rows = answers(out / "keystone.jsonl", asked, ask, processes)
    write_rows(out / "keystone.csv", rows)
    return summary(rows)


def summary(rows: list[Row]) -> str:
    """Say in words what came out."""
    held = [row for row in rows if row["rest_holds"]]
    apart = [
        abs(float(row["eta_followed"]) / float(row["eta_end"]) - 1)
        for row in held
        if row["eta_followed"]
    ]
    lines = [
        f"{len(rows)} arches, {len(held)} of which the rest holds",
        f"closed form and motion followed within {max(apart):.3%} at {len(apart)}",
    ]
    for n in sorted({int(row["voussoirs"]) for row in held}):
        wide = [
            float(row["eta_end"]) / float(row["eta_limit"]) - 1
            for row in held
            if row["voussoirs"] == n
        ]
        lines.append(f"{n} voussoirs: up to {max(wide):.1%} above the least thickness")
    return "\n".join(lines)


if __name__ == "__main__":
    run(main)
