"""Where Coulomb's law has two answers, rest and motion, and what the onset test says there.

An equilibrium exists above the least thickness: that is exact, by limit analysis and by
`direct`. A motion found there by an impulse engine must not be believed.
"""

import math
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import pytest
from arches import arch_at, bracket_at, problem_at
from images import moved
from structure_cases import some_of
from worlds import ContactProblem, Quality, Simulation, hold, observe

from blocksim import CircularArch, Problem, Settings, Verdict, Wall, bracket, check, simulate
from blocksim.engines.contact.solver import Solution
from blocksim.simulation.motion import EARLY, FINER, MOVED, QUIET, moving_run

TWO_ANSWERS = [
    (125.023, 0.8594, 10, "centreline"),
    (129.59079, 0.9681690607, 24, "sector"),
    (148.65732, 2.0065096596, 12, "sector"),
    (150.094, 2.7221, 5, "sector"),
    (151.66775, 2.150333384, 7, "sector"),
    (155.0, 3.0, 7, "centreline"),
]
"""Half-angle, friction, voussoirs, weight: above the limit impulses from nothing move these."""
Case = tuple[float, float, int, str]
every_case = pytest.mark.parametrize("case", TWO_ANSWERS)


@every_case
@pytest.mark.parametrize(
    ("ratio", "right"), [(0.99, "collapses"), (0.9995, "collapses"), (1.0005, "stands")]
)
@pytest.mark.parametrize("engine", ["pymunk", "direct"])
def test_an_arch_stands_if_it_can_rest(
    engine: str, ratio: float, right: str, case: Case
) -> None:
    arch = CircularArch.of(arch_at(ratio, *case), case[1])
    assert check(arch, method=engine, reduce=False).verdict == right


@every_case
def test_brackets_close_where_there_are_two_answers(case: Case) -> None:
    exact = arch_at(1.0, *case).eta
    found = bracket_at(*case, method="pymunk", tol=2e-4)
    assert found.confirmed
    assert found.undecided == 0
    assert found.arch.eta_low < exact < found.arch.eta_high
    assert found.arch.eta_high / found.arch.eta_low <= 1 + 2.1e-4
    assert found.arch.mode == found.arch.mode_limit


def test_what_was_given_is_told() -> None:
    """The answer says whether it took forces of equilibrium to find rest."""
    case = TWO_ANSWERS[-1]
    assert "they were given" in hold(problem_at(1.01, *case), "pymunk").onset.reason
    alone = hold(problem_at(1.01, 90.0, 0.7, 27), "pymunk").onset
    assert alone.verdict is Verdict.STANDS
    assert alone.forces is None


@pytest.mark.parametrize(
    "case",
    [pytest.param(TWO_ANSWERS[1], marks=pytest.mark.long), TWO_ANSWERS[2], *TWO_ANSWERS[4:]],
)
def test_bullet_keeps_forces_it_is_given(case: Case) -> None:
    """It keeps no impulses: joints press by themselves, and friction has to be found."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    below = hold(problem_at(0.9995, *case), "pybullet").onset
    above = hold(problem_at(1.0005, *case), "pybullet").onset
    assert below.verdict is Verdict.COLLAPSES
    assert above.verdict is Verdict.STANDS
    assert "they were given" in above.reason


def test_pybullet_says_why_it_is_undecided() -> None:
    """Let go, it moves: blocks that can rest may do so, and Bullet forgets friction."""
    pytest.importorskip("pybullet", exc_type=ImportError)
    case = TWO_ANSWERS[-1]
    seen = observe(problem_at(1.0005, *case), "pybullet")
    assert seen.verdict is Verdict.UNDECIDED
    assert "friction may let it move, too" in seen.reason
    assert "released, it moved" in seen.reason


def test_what_cannot_be_found_is_said_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numbers that end in none give no verdict, and no reason says nan."""
    problem = problem_at(1.01, 90, 0.7, 9)
    held = hold(problem, "direct")
    solve = ContactProblem.solve

    def broken(*args: object, **named: object) -> Solution:
        found = solve(*args, **named)
        return replace(found, acceleration=found.acceleration * math.nan, residual=math.nan)

    monkeypatch.setattr(ContactProblem, "solve", broken)
    for seen in (hold(problem, "direct").onset, held.release()):
        assert seen.verdict is Verdict.UNDECIDED
        assert "contact forces could not be found" in seen.reason
        assert "nan" not in seen.reason


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
    made = Simulation.of(problem_at(1.1, 90, 0.9, 5), "direct")
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
    held = hold(problem_at(1 - below, 90, 0.7, 27), "direct")
    recording = held.release().recording
    moved = recording.displacement
    assert EARLY < moved[moved > EARLY][0] < 1.5 * EARLY
    assert len(recording.times) < 45


SIDES = [(0.98, Verdict.COLLAPSES), (1.02, Verdict.STANDS)]


@pytest.mark.parametrize(("ratio", "right"), SIDES)
@pytest.mark.parametrize(
    ("engine", "angle", "count", "short"),
    [("pymunk", 90, 27, 5), ("pybullet", 45, 7, 80)],
)
def test_sweeps_allowed_to_slender_arches(
    engine: str, angle: float, count: int, short: int, ratio: float, right: Verdict
) -> None:
    """The shorter the joints, the more sweeps; with too few of them it is undecided."""
    pytest.importorskip(engine, exc_type=ImportError)
    problem = problem_at(ratio, angle, 0.9, count)
    few = {"hold_sweeps": short * count**2}
    assert check(problem, method=engine, reduce=False).verdict is right
    seen = check(problem, method=engine, reduce=False, settings=few)
    assert seen.verdict in (right, Verdict.UNDECIDED)
    if engine == "pybullet":
        assert "not converged" in seen.reason


@pytest.mark.parametrize("engine", ["direct", "pymunk", "pybullet"])
@pytest.mark.parametrize(("ratio", "right"), SIDES)
def test_far_from_the_origin(engine: str, ratio: float, right: Verdict) -> None:
    """Beyond, round-off would hide what starts to move, or throw blocks."""
    pytest.importorskip("pybullet" if engine == "pybullet" else "numpy", exc_type=ImportError)
    problem = problem_at(ratio, 90, 0.7, 9)
    assembly = problem.assembly
    farthest = simulate(problem, method=engine, duration=0.01).settings.farthest * assembly.size
    near, far = (
        check(Problem(assembly=moved(assembly, (share * farthest, 0.0)), mu=0.7), method=engine)
        for share in (0.99, 1.01)
    )
    assert near.verdict is right
    assert "from the origin" not in near.reason
    assert far.verdict is Verdict.UNDECIDED
    assert "from the origin" in far.reason


@pytest.mark.parametrize(
    ("step", "sweeps", "word"),
    [
        (1.9, 1, ""),
        (0.5, 0.5, ""),
        (2.1, 2.1, "time step 2.1"),
        (1, 0.4, "sweeps 0.4"),
        (1.9, 0.8, "sweeps 0.4"),
    ],
)
def test_settings_beyond_those_measured_are_named(
    step: float, sweeps: float, word: str
) -> None:
    """Of a moving run: what a setting does to the onset test shows in that itself."""
    problem = problem_at(1.02, 90, 0.7, 27)
    rule = simulate(problem, method="pymunk", duration=0.01).settings
    chosen = {"step": rule.step * step, "sweeps": round(rule.sweeps * sweeps)}
    seen = check(problem, method="pymunk", reduce=False, settings=chosen)
    assert ("to be sure" in seen.reason) == (word != "")
    assert word in seen.reason


SLABS = [
    Wall(length=13.576, courses=5, block_length=1.9394, block_height=1.5415),
    Wall(length=2.2006, courses=5, block_length=0.4396, block_height=0.3501),
    Wall(length=23.6849, courses=3, block_length=7.8949, block_height=2.3829),
]


@pytest.mark.parametrize("asked", some_of(product((0.3538, 0.6375), SLABS), every=2))
def test_a_wall_that_ends_in_slabs_of_a_millimetre_can_rest(asked: tuple[float, Wall]) -> None:
    """So light a slab accelerates by less than half of a solution's digits tell apart."""
    friction, wall = asked
    rough = replace(wall, friction=friction)
    limit = bracket(rough, over="tilt", tol=1e-9).limit
    assert limit is not None
    for share in (0.9, 0.99, 0.999, 0.9999, 1.0001, 1.01):
        tilted = rough.problem().tilted(math.radians(share * limit))
        right = Verdict.STANDS if share < 1 else Verdict.COLLAPSES
        assert [check(tilted, method=each).verdict for each in ("limit", "direct")] == [
            right
        ] * 2
