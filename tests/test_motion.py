"""Moving runs that contradict the onset test: repeated with more sweeps, or given up."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from arches import arch_at
from worlds import Quality, Settings, Simulation, hold

from blocksim import CircularArch, Problem, Verdict
from blocksim.simulation.motion import EARLY, FINER, MOVED, QUIET, moving_run

SWEEPS = 10
FASTEST = 1e-3
"""Rate at which blocks creep with that many sweeps."""


@dataclass
class Creeping:
    """Blocks that all move at one rate, which falls with the square of the sweeps."""

    problem: Problem
    settings: Settings
    time: float = field(default=0.0, init=False)

    def hold(self, sweeps: int) -> np.ndarray:
        """Rest."""
        del sweeps
        return np.zeros((len(self.problem.assembly.blocks), 3))

    def advance(self, steps: int) -> None:
        """Creep on."""
        self.time += steps * self.settings.step

    def poses(self) -> np.ndarray:
        """Move along x."""
        assembly = self.problem.assembly
        poses = np.column_stack([assembly.centres / assembly.size, self.hold(0)[:, 0]])
        poses[:, 0] += FASTEST * (SWEEPS / self.settings.sweeps) ** 2 * self.time
        return poses

    def quality(self) -> Quality:
        """Know nothing."""
        return Quality()


def creeping(repeats: int) -> Simulation:
    """An arch in an engine whose arches creep."""
    made = Simulation.of(CircularArch.of(arch_at(1.1, 90, 0.9, 5), 0.9).problem(), "direct")
    # As a whole it overlaps its supports by nothing: blocks slide along the springings.
    settings = replace(made.settings, sweeps=SWEEPS, repeats=repeats, rest=1e-5, noise=1.0)
    return replace(made, engine=replace(made.engine, build=Creeping), settings=settings)


@pytest.mark.parametrize(
    ("repeats", "rests", "sweeps", "expected"),
    [
        # 1e-3 in a unit of time is a fall, and a 16th of it neither that nor rest.
        (3, False, SWEEPS, Verdict.COLLAPSES),
        (3, True, SWEEPS * FINER, Verdict.UNDECIDED),
        (0, True, SWEEPS, Verdict.COLLAPSES),
    ],
)
def test_what_falls_though_it_can_rest_is_asked_again(
    repeats: int, rests: bool, sweeps: int, expected: Verdict
) -> None:
    asked: list[Creeping] = []
    simulation = creeping(repeats)
    motion = moving_run(simulation, simulation.world(), asked.append, rests=rests)
    assert motion.verdict is expected
    assert motion.recording.settings.sweeps == sweeps
    assert len(asked) == (sweeps > SWEEPS)
    # With the first sweeps it falls by then; found at rest it is not watched for longer.
    assert motion.recording.times[-1] < QUIET + 0.3


@pytest.mark.parametrize("rests", [False, True])
def test_a_film_of_what_rests_is_no_film_of_a_fall(rests: bool) -> None:
    simulation, until = creeping(3), 8.0
    motion = moving_run(
        simulation, simulation.world(), lambda _: None, rests=rests, until=until
    )
    assert motion.recording.times[-1] == pytest.approx(until, abs=0.1)
    fell = motion.recording.displacement[-1] > MOVED
    assert bool(fell) is not rests


@pytest.mark.parametrize("below", [1e-8, 1e-6, 1e-4, 1e-2])
def test_few_looks_suffice_and_none_is_too_late_for_the_mechanism(below: float) -> None:
    """What falls is first seen to have moved while the motion still is the mechanism."""
    held = hold(CircularArch.of(arch_at(1 - below, 90, 0.7, 27), 0.7).problem(), "direct")
    recording = held.release().recording
    moved = recording.displacement
    assert EARLY < moved[moved > EARLY][0] < 1.5 * EARLY
    assert len(recording.times) < 45
