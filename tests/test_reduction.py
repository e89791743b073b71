"""Half an arch in a few blocks answers as all its voussoirs do.

Truth is limit analysis, Newton's law for every voussoir, closed forms for single blocks, and
the whole arch in the same engine. A guess of which joints move is made wrong on purpose, and
must not change an answer.
"""

import math

import numpy as np
import pytest
from arches import arch_at, least
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from worlds import Simulation, hold, observe, observed_mode, onset

from blocksim import Arch, CircularArch, Verdict, bracket, check
from blocksim.arch.reduction import MIRROR, Reduction

CASES = [
    (90, 0.7, 27, "centreline"),
    (90, 0.7, 28, "sector"),
    (90, 0.37, 30, "centreline"),
    (90, 0.31, 27, "sector"),
    (125, 0.9, 26, "centreline"),
    (125, 0.9, 101, "sector"),
    (145, 1.6, 40, "centreline"),
    (145, 1.6, 27, "sector"),
    (154, 2.6, 101, "centreline"),
    (110, 0.9, 301, "sector"),
    (32, 1.0, 44, "centreline"),
    (65, 0.9, 9, "sector"),
]
SWEEPS = {"direct": 1, "pymunk": 40_000, "pybullet": 40_000}
EXACT = {"direct": 1e-10, "pymunk": 1e-5, "pybullet": 2e-4}
"""Of resultants [mean weights]; where engines sweep, shapes overlap by 2.5e-7 and 2e-5 r."""


def accelerations(held):
    """Accelerations in the plane that the onset test ended with, shape (n, 3)."""
    return held.world.hold(1)[:, :3]


def every_joint(arch, mu):
    """The half, nothing merged.

    Where joints slide Coulomb's law may have several solutions, and all voussoirs may take
    an unsymmetric one; of the half, merging must not change any.
    """
    half = Reduction(arch.assembly(), tuple(range(arch.voussoirs // 2 + 1)))
    return hold(CircularArch.of(arch, mu).problem(), "direct", reduction=half)


def half_and_whole(arch, mu, **how):
    """Answers of `direct` about half of an arch in few blocks, and about all its voussoirs."""
    problem = CircularArch.of(arch, mu).problem()
    return [
        observe(problem, "direct", reduction=each, **how)
        for each in (Reduction.of(arch, mu), None)
    ]


def unbalanced(assembly, resultants, rates):
    """Newton's law for each block: what its two joints leave over, shape (blocks, 3)."""
    force = resultants[:-1] - resultants[1:]
    x, y = assembly.centres.T / assembly.size
    force[:, 2] -= x * force[:, 1] - y * force[:, 0]
    force[:, 1] -= assembly.masses[:, 0]
    return force - assembly.masses * rates


@st.composite
def arches(draw):
    """Arches of either parity with any choice of joints that may move."""
    voussoirs = draw(st.integers(3, 40))
    arch = Arch(
        half_angle=math.radians(draw(st.floats(20, 159))),
        eta=draw(st.floats(0.01, 2.0)),
        voussoirs=voussoirs,
        weight=draw(st.sampled_from(["centreline", "sector"])),
        radius=draw(st.sampled_from([1.0, 7.0])),
    )
    inside = draw(st.sets(st.integers(1, (voussoirs - 1) // 2)))
    crown = set() if voussoirs % 2 else {voussoirs // 2}
    return arch, tuple(sorted({0} | inside | crown))


# What is simulated.


@given(arches())
def test_mass_centre_and_inertia_are_those_of_the_voussoirs(drawn):
    arch, kept = drawn
    whole = arch.assembly()
    half = Reduction(whole, kept).assembly

    def moments(assembly, blocks):
        """Mass, first moment of the height, and polar moment about the origin."""
        mass = np.array([assembly.blocks[k].mass for k in blocks])
        centre = np.array([assembly.blocks[k].centre for k in blocks])
        inertia = np.array([assembly.blocks[k].inertia for k in blocks])
        return mass.sum(), mass @ centre[:, 1], (inertia + mass * (centre**2).sum(1)).sum()

    everything = moments(whole, range(arch.voussoirs))
    halves = moments(half, range(len(half.blocks)))
    assert 2 * halves[0] == pytest.approx(everything[0], rel=1e-12)
    assert 2 * halves[1] == pytest.approx(everything[1], rel=1e-9, abs=1e-9 * everything[0])
    if arch.voussoirs % 2 == 0:
        assert 2 * halves[2] == pytest.approx(everything[2], rel=1e-12)
    else:
        # What holds half a keystone cannot turn.
        assert halves[2] > 1e9 * everything[2]


@given(arches(), st.integers(0, 2**32 - 1))
def test_rates_are_those_of_rigid_blocks_and_their_mirror_images(drawn, seed):
    """Central differences of the poses, which rotate the voussoirs about their blocks."""
    arch, kept = drawn
    size, step = arch.radius, 1e-4
    reduction = Reduction(arch.assembly(), kept)
    blocks = reduction.assembly
    start = np.zeros((len(blocks.blocks), 3))
    start[:, :2] = blocks.centres / size
    rates = np.random.default_rng(seed).uniform(-1, 1, start.shape)
    after, before = (reduction.poses(start + sign * step * rates) for sign in (1, -1))
    moved = reduction.rates(rates)
    assert moved.shape == (arch.voussoirs, 3)
    assert (after - before) / (2 * step) == pytest.approx(moved, abs=1e-7)
    assert moved == pytest.approx(moved[::-1] * MIRROR, abs=1e-12)
    rest = reduction.poses(start)
    assert rest[:, :2] == pytest.approx(reduction.whole.centres / size, abs=1e-12)
    assert np.abs(rest[:, 2:]).max() == 0


# What joints carry.


@pytest.mark.parametrize("ratio", [0.98, 1.02])
@pytest.mark.parametrize("voussoirs", [9, 10])
def test_resultants_obey_newton_for_every_voussoir(engine, voussoirs, ratio):
    arch = arch_at(ratio, 125, 0.9, voussoirs)
    problem = CircularArch.of(arch, 0.9).problem()
    for reduction in (None, Reduction.of(arch, 0.9)):
        world = Simulation.of(problem, engine, reduction=reduction).world()
        rates = world.hold(SWEEPS[engine])[:, :3]
        left = unbalanced(arch.assembly(), world.resultants(), rates)
        # Bodies that overlap have two places for one force.
        assert np.abs(left).max() < EXACT[engine]


# Whether the guess was right.


@pytest.mark.parametrize(("half_angle_deg", "mu", "voussoirs", "weight"), CASES)
@pytest.mark.parametrize("ratio", [pytest.param(0.97, marks=pytest.mark.long), 0.999, 1.001])
def test_any_guess_is_corrected(half_angle_deg, mu, voussoirs, weight, ratio):
    """All joints but the springing, and one at the crown, taken for none that move."""
    arch = arch_at(ratio, half_angle_deg, mu, voussoirs, weight)
    crown = () if voussoirs % 2 else (voussoirs // 2,)
    wrong = Reduction(arch.assembly(), (0, *crown))
    problem = CircularArch.of(arch, mu).problem()
    held = hold(problem, "direct", reduction=wrong)
    assert held.onset.verdict is hold(problem, "direct").onset.verdict
    assert held.simulation.blocks < 10
    half = every_joint(arch, mu)
    scale = max(half.onset.acceleration, 1e-6)
    assert accelerations(held) == pytest.approx(accelerations(half), abs=1e-6 * scale)


def test_without_a_second_look_a_wrong_guess_would_stand():
    arch = arch_at(0.98, 90, 0.7, 28)
    wrong = Reduction(arch.assembly(), (0, 14))
    simulation = Simulation.of(CircularArch.of(arch, 0.7).problem(), "direct", reduction=wrong)
    world = simulation.world()
    assert onset(world, simulation).verdict is Verdict.STANDS
    assert wrong.overstrained(world.resultants(), 0.7, 1e-9)
    held = hold(CircularArch.of(arch, 0.7).problem(), "direct", reduction=wrong)
    assert held.onset.verdict is Verdict.COLLAPSES
    assert held.splits > 0


def test_forces_beyond_a_joint_or_its_friction_are_seen():
    """One arch at rest: its resultants moved by a little more, or less, than there is room."""
    arch = arch_at(1.2, 90, 0.7, 28)
    reduction = Reduction(arch.assembly(), (0, 14))
    joints = reduction.whole.joint_arrays
    middle = joints.ends.mean(axis=1)

    def carried(eccentricity, lean):
        """Pressure 1 at every joint, off its middle, and friction."""
        force = joints.normal + lean * joints.tangent
        place = middle + eccentricity * joints.length[:, None] / 2 * joints.tangent
        moment = place[:, 0] * force[:, 1] - place[:, 1] * force[:, 0]
        return np.column_stack([force, moment])

    for eccentricity, lean in ((0.999, 0.0), (-0.999, 0.0), (0.0, 0.699), (0.0, -0.699)):
        assert reduction.overstrained(carried(eccentricity, lean), 0.7, 1e-9) == ()
    for eccentricity, lean in ((1.001, 0.0), (-1.001, 0.0), (0.0, 0.701), (0.0, -0.701)):
        assert len(reduction.overstrained(carried(eccentricity, lean), 0.7, 1e-9)) == 1
    # No tension, wherever it acts.
    assert len(reduction.overstrained(-carried(0.0, 0.0), 0.7, 1e-9)) == 1


def test_a_keystone_that_leaves_the_plane_takes_all_voussoirs():
    """Five voussoirs with much friction: the halves of the keystone would part."""
    arch = Arch(half_angle=math.radians(146.91), eta=0.5742, voussoirs=5)
    few, every = half_and_whole(arch, 2.43, moving=False)
    assert few.blocks == every.blocks == 5
    assert few.onset.acceleration == every.onset.acceleration
    assert "blocks" not in few.reason


# The answers.


@settings(max_examples=20)
@given(
    st.floats(30, 155),
    st.floats(0.35, 3.0),
    st.integers(3, 60),
    st.sampled_from(["centreline", "sector"]),
    st.sampled_from([0.9, 0.99, 0.9999, 1.0001, 1.01, 1.1]),
)
def test_half_and_whole_agree(half_angle_deg, mu, voussoirs, weight, ratio):
    half_angle = math.radians(half_angle_deg)
    eta = least(half_angle, mu, voussoirs, weight).eta_limit
    assume(eta is not None and 1e-3 < eta * ratio <= 2)
    arch = Arch(half_angle=half_angle, eta=eta * ratio, voussoirs=voussoirs, weight=weight)
    few, every = half_and_whole(arch, mu, moving=False)
    assert few.verdict is every.verdict
    assert observed_mode(few.joints, arch) is observed_mode(every.joints, arch)


@pytest.mark.parametrize(("half_angle_deg", "mu", "voussoirs", "weight"), CASES[:-2])
def test_pymunk_answers_as_limit_analysis_does(half_angle_deg, mu, voussoirs, weight):
    """All 301 voussoirs would take it minutes."""
    for ratio, expected in ((0.999, Verdict.COLLAPSES), (1.001, Verdict.STANDS)):
        arch = arch_at(ratio, half_angle_deg, mu, voussoirs, weight)
        problem = CircularArch.of(arch, mu).problem()
        seen = observe(problem, "pymunk", reduction=Reduction.of(arch, mu))
        assert seen.verdict is expected, seen.reason
        if expected is Verdict.COLLAPSES:
            mode = least(arch.half_angle, mu, voussoirs, weight).mode_limit
            assert observed_mode(seen.joints, arch) is mode


@pytest.mark.parametrize("method", ["direct", "pymunk"])
@pytest.mark.parametrize("voussoirs", [20, 21])
def test_brackets_are_those_of_all_voussoirs(method, voussoirs):
    arch = CircularArch(
        half_angle=math.radians(125), friction=0.9, voussoirs=voussoirs, weight="centreline"
    )
    few, every = (bracket(arch, method=method, tol=2e-3, reduce=r) for r in (True, False))
    # Where they are probed follows accelerations, which differ by how far they converged.
    assert few.arch.eta_low == pytest.approx(every.arch.eta_low, rel=1e-5)
    assert few.arch.eta_high == pytest.approx(every.arch.eta_high, rel=1e-5)
    assert few.confirmed
    assert few.arch.mode is every.arch.mode
    assert few.blocks < 6
    assert every.blocks == voussoirs
    assert f"{few.blocks} instead of {voussoirs} blocks" in few.reason


@pytest.mark.parametrize("voussoirs", [14, 15])
def test_let_go_it_moves_as_all_voussoirs_do(voussoirs):
    arch = arch_at(0.98, 125, 0.9, voussoirs)
    few, every = half_and_whole(arch, 0.9)
    assert few.verdict is every.verdict is Verdict.COLLAPSES
    assert observed_mode(few.joints, arch) is observed_mode(every.joints, arch)
    assert few.joints == every.joints
    runs = few.motion.recording, every.motion.recording
    assert runs[0].times == pytest.approx(runs[1].times)
    # Joints of one half may part later than those of the other by round-off.
    assert runs[0].poses == pytest.approx(runs[1].poses, abs=1e-4)


def test_the_answer_tells_what_was_simulated(engine):
    arch = arch_at(0.98, 90, 0.7, 27)
    asked = CircularArch.of(arch, friction=0.7)
    answer = check(asked, method=engine, reduce=True)
    assert answer.verdict is Verdict.COLLAPSES
    assert (answer.blocks, answer.splits) == (3, 0)
    assert "3 instead of 27 blocks were simulated" in answer.reason
    assert check(asked, method=engine).blocks == (27 if engine == "direct" else 3)
    assert check(asked, method=engine, reduce=False).blocks == 27
    assert check(asked, method="limit").blocks is None
