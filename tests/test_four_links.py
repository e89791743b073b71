"""Oppenheim's arch in motion, held to the equation of three links on four hinges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from four_links import Arch

from analysis import oppenheim
from analysis.convergence import world
from analysis.rows import FIGURES, read_kept
from analysis.shaking import ARCH
from blocksim import simulate, structure_of


def test_the_equation_starts_as_published_and_keeps_energy() -> None:
    arch = Arch()
    # 0.37 g, hinges at joints 0, 3, 5 and 7 where the arch is pushed to the right.
    assert arch.starts == pytest.approx(0.37, abs=0.005)
    assert [joint for joint, _ in arch.hinges] == [7 - each for each in (7, 5, 3, 0)]
    end = 0.8
    found = arch.rocks(lambda time: 0.4 * arch.gravity * (time < end), 1.2, 0.005)
    later = np.flatnonzero(found.times > end + 0.01)
    assert not found.impacts
    moving, weights, _ = (curve(found.angles[later]) for curve in arch._curves)
    spin = np.gradient(found.angles[later], found.times[later])
    steps = np.diff(found.angles[later]) * (weights[1:] + weights[:-1]) / 2
    kinetic = moving * spin**2 / 2
    lifted = np.append(0.0, np.cumsum(steps))
    assert np.ptp((kinetic + lifted)[5:-5]) < 2e-3 * kinetic.max()


@pytest.mark.parametrize("mu", [0.8, 3.0])
def test_an_impact_of_the_arch_loses_as_little_as_contacts_allow(mu: float) -> None:
    arch = Arch()
    least, turned = arch.least_loss
    assert turned > 0.3
    assert least == pytest.approx(0.5592, abs=1e-4)
    assert arch.kept**2 < least - 0.1
    problem = structure_of({**ARCH, "friction": mu})
    speed, spin = arch.velocities()
    each = problem.seconds / problem.assembly.size
    start = -0.05 * np.stack(
        [speed.real * each, speed.imag * each, spin * problem.seconds], axis=1
    )
    made = world(problem, 1e-5, start)
    made.advance(1)
    masses = problem.assembly.masses
    left = (masses * made.velocities**2).sum() / (masses * start**2).sum()
    assert left == pytest.approx(least, rel=1e-3)


def test_a_push_turns_the_arch_as_the_equation_says() -> None:
    name = "0.4 g for 1.3 s"
    ground = oppenheim.motions()[name]
    problem = replace(structure_of({**ARCH, "friction": oppenheim.MU}), shaking=ground)
    until = ground.duration / problem.seconds
    seen = simulate(problem, method="direct", duration=until)
    arch = Arch()
    truth = arch.rocks(lambda _: 0.4 * arch.gravity, 1.4, 0.01)
    wanted = np.interp(seen.times * problem.seconds, truth.times, truth.angles)
    turned = seen.poses[:, 0, 2] - seen.poses[0, 0, 2]
    assert np.abs(turned - wanted).max() < 2e-4 * wanted.max()


@pytest.mark.long
@pytest.mark.parametrize("name", list(oppenheim.motions()))
def test_motions_of_the_arch_are_those_of_the_rows(name: str) -> None:
    row, _ = oppenheim.followed(name, oppenheim.motions()[name])
    kept = next(each for each in read_kept(FIGURES / "oppenheim.csv") if each["motion"] == name)
    for key, value in row.items():
        wanted = pytest.approx(kept[key], rel=1e-3) if isinstance(value, float) else kept[key]
        assert value == wanted
    assert row["equation_falls"] == (row["direct_verdict"] == "collapses")
    pulse = name.startswith("0.4 g")
    for engine, off in (("direct", 2e-4), ("pymunk", 2e-3)):
        assert row[f"{engine}_off_while_pushed"] < (off if pulse else 0.1)
