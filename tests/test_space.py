"""Blocks in space, held to published cases, closed forms, own programmes and symmetry."""

import itertools
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kind_cases import KINDS
from matplotlib.collections import PolyCollection
from matplotlib.text import Text
from running import inside
from scipy.spatial import transform
from space_cases import GROUND, NAMES, box, case, enclosed, problem_of, rotation, tower
from structure_cases import case as plane_case
from structure_cases import names as plane_names
from structure_cases import scenes, some_of

import blocksim
from analysis.random_space import drawn
from blocksim import (
    BarrelVault,
    CorbelDome,
    Dome,
    GroinVault,
    JointState,
    Load,
    Problem,
    ReturnWall,
    SkewArch,
    Solid,
    Tower,
    Verdict,
    extruded,
    structure_of,
)
from blocksim.blocks.acting import with_push
from blocksim.blocks.space.contact import Contact, contact
from blocksim.blocks.space.extruded import way_of_prisms
from blocksim.blocks.space.polyhedron import Polyhedron, frame
from blocksim.common.errors import InputError
from blocksim.common.fields import fields_of
from blocksim.limit.space import can_rest, largest_load
from blocksim.limit.space.cones import _left_over
from blocksim.view.solidfigure import solid_figure
from blocksim.view.solidscene import moving_box, supports_of
from blocksim.view.style import JOINTS
from blocksim.view.turning import turning_page

SOLID_KINDS = {name: kind for name, kind in KINDS.items() if kind.in_space}


@pytest.mark.parametrize("name", some_of(NAMES))
def test_a_case_has_its_value_verdict_and_joints(name: str) -> None:
    """Each of the 55 cases, by the public reader and verb."""
    known = case(name)
    problem = structure_of(known["scene"])
    answer = blocksim.check(problem)
    if "faces" in known:
        assert len(problem.assembly.joints) == known["faces"]
    expected = known["expected"]
    if known["question"] == "stands":
        assert answer.verdict is (Verdict.STANDS if expected["value"] else Verdict.COLLAPSES)
    else:
        assert answer.load_factor == pytest.approx(expected["value"], rel=1e-6)
        for share, verdict in ((0.999, Verdict.STANDS), (1.001, Verdict.COLLAPSES)):
            at = problem.with_load(share * expected["value"])
            assert blocksim.check(at).verdict is verdict


def test_the_forces_of_a_case_balance_and_lie_within_friction() -> None:
    """Summed again from the forces at the points, in N."""
    problem = structure_of(case("dome_12_7_stands")["scene"])
    static, assembly = can_rest(problem), problem.assembly
    left = problem.applied_forces() * assembly.units
    at = 0
    for joint in assembly.joints:
        first, second = frame(joint.normal)
        for point in joint.points:
            normal, one, other = static.point_forces[at]
            at += 1
            assert math.hypot(one, other) <= problem.mu * normal
            force = normal * joint.normal + one * first + other * second
            for block, sign in ((joint.before, -1), (joint.after, 1)):
                if block >= 0:
                    arm = point - assembly.blocks[block].centre
                    left[block] += sign * np.concatenate([force, np.cross(arm, force)])
    assert np.abs(left).max() < 1e-12 * assembly.weights.min()


def corbelled(share: float) -> Problem[Any]:
    """A dome of corbelled rings on a table, at a share of the tilt at which it falls."""
    dome = CorbelDome(radius=2, width=0.5, height=0.3, rings=6, stones=8, friction=0.7)
    return dome.problem().tilted(share * math.radians(34.909))


FALLING = {
    "dome": lambda: structure_of(case("dome_12_7_falls")["scene"]),
    # Nearly all points slide; most hardly open.
    "0.1 % beyond": lambda: corbelled(1.001),
}


def test_a_corbel_dome_rests_as_near_to_its_limit_as_it_falls() -> None:
    assert can_rest(corbelled(0.999)).exists is True


def pushed(problem: Problem[Any], azimuth: float) -> Problem[Any]:
    """All blocks pushed sideways by a share of their weight, the live load."""
    way = math.radians(azimuth)
    every = tuple(range(len(problem.assembly.blocks)))
    push = Load(force=[math.cos(way), math.sin(way), 0], blocks=every, per_weight=True)
    return replace(problem, live=(push,))


DOME = Dome(radius=1, thickness=0.06, eye_deg=8, lunes=6, courses=4, friction=0.6)
VAULT = BarrelVault(
    radius=1, thickness=0.2, length=1, half_angle_deg=70, voussoirs=7, rings=3, bond="half"
)  # fmt: skip


@pytest.mark.parametrize(
    ("problem", "blocks"),
    [
        (pushed(DOME.problem(), 0), 12),
        (pushed(DOME.problem(), 30), 16),
        (pushed(DOME.problem(), 7), 24),
        (pushed(replace(VAULT, friction=0.8).problem(), 0), 14),
        (pushed(CorbelDome(radius=1, width=0.4, height=0.3, corbel=0.05, rings=4, stones=8,
                           friction=0.5).problem(), 45), 18),
        (pushed(GroinVault(courses=3, friction=0.7).problem(), 45), 13),
    ],
    ids=["dome", "dome through lunes", "dome aslant", "vault", "corbel dome", "groin vault"],
)  # fmt: skip
def test_planes_of_symmetry_halve_what_is_asked_and_change_nothing(
    problem: Problem[Any], blocks: int
) -> None:
    """Load factor, verdicts and margin are those of all blocks, and the answer says so."""
    half, whole = (largest_load(problem, reduce=reduce) for reduce in (True, False))
    assert half.load_factor == pytest.approx(whole.load_factor, rel=1e-7)
    assert half.gap < 1e-7
    for share, verdict in ((0.99, Verdict.STANDS), (1.01, Verdict.COLLAPSES)):
        at = problem.with_load(share * whole.load_factor)
        answer, all_asked = blocksim.check(at), blocksim.check(at, reduce=False)
        assert answer.verdict is verdict
        assert all_asked.verdict is verdict
        assert answer.static.margin == pytest.approx(
            all_asked.static.margin, rel=1e-7, abs=1e-7
        )
        of = len(problem.assembly.blocks)
        said = f"{blocks} instead of {of} blocks were asked, by symmetry" in answer.reason
        assert said is (blocks < of)
        assert answer.blocks == (blocks if blocks < of else None)
        assert "symmetry" not in all_asked.reason


def test_a_block_of_another_weight_or_joint_of_another_friction_is_no_mirror_image() -> None:
    """Nor is a load on one block: one plane is left, through it or along the joint."""
    problem = DOME.problem()
    assembly, count = problem.assembly, len(problem.assembly.blocks)
    heavy = replace(assembly.blocks[3], weight=1.01 * assembly.blocks[3].weight)
    blocks = (*assembly.blocks[:3], heavy, *assembly.blocks[4:])
    rough = replace(assembly.joints[9], friction=0.61)
    joints = (*assembly.joints[:9], rough, *assembly.joints[10:])
    load = Load(force=[0, 0, -1], blocks=(5,), per_weight=True)
    assert can_rest(problem).asked == 4
    # The plane goes through the opposite lune, too: of six lunes four are asked.
    through = 16
    assert can_rest(replace(problem, dead=(load,))).asked == through
    assert (
        can_rest(replace(problem, assembly=replace(assembly, blocks=blocks))).asked == through
    )
    assert can_rest(replace(problem, assembly=replace(assembly, joints=joints))).asked in (
        count / 2,
        through,
    )


@pytest.mark.parametrize("falling", FALLING)
def test_a_mechanism_opens_no_joint_less_than_its_slip_asks(falling: str) -> None:
    """And gravity gains work in it: summed again from the rates of the blocks."""
    problem = FALLING[falling]()
    static, assembly = can_rest(problem), problem.assembly
    assert static.exists is False
    rates = static.mechanism * np.array([assembly.size] * 3 + [1.0] * 3)
    assert (rates * problem.applied_forces() * assembly.units).sum() > 0
    for joint in assembly.joints:
        for point in joint.points:
            parted = np.zeros(3)
            for block, sign in ((joint.before, -1), (joint.after, 1)):
                if block >= 0:
                    arm = point - assembly.blocks[block].centre
                    parted += sign * (rates[block, :3] + np.cross(rates[block, 3:], arm))
            opening = parted @ joint.normal
            slip = np.linalg.norm(parted - opening * joint.normal)
            assert opening >= problem.mu * slip - 1e-9


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10**6), mu=st.sampled_from([0.2, 0.6, 1.5]))
def test_a_load_factor_lies_between_those_of_two_pyramids(seed: int, mu: float) -> None:
    """Towers of boxes pushed sideways, by linear programmes written for the test."""
    problem = problem_of(tower(seed, blocks=4, offset=0.15), mu)
    way = rotation(seed)[0] * np.array([1, 1, 0.2])
    blocks = tuple(range(len(problem.assembly.blocks)))
    problem = replace(problem, live=(Load(force=way, blocks=blocks, per_weight=True),))
    factor = largest_load(problem).load_factor
    low, high = enclosed(problem)
    factor = -math.inf if factor is None else factor
    assert low <= factor + 1e-7 * abs(low) + 1e-9
    assert factor <= high + 1e-7 * abs(high) + 1e-9


def rebuilt(problem: Problem[Any], turn: Any, scale: float, order: list[int]) -> Problem[Any]:
    """Return a problem turned, scaled and renumbered, its joints found anew."""
    assembly = problem.assembly
    solids = [
        Solid(parts=tuple(scale * each.corners @ turn.T + 3.0 for each in block.hulls),
              fixed=fixed, name=block.name, weight=block.weight)
        for blocks, fixed in ((assembly.blocks, False), (assembly.supports, True))
        for block in blocks
    ]  # fmt: skip
    (load,) = problem.live
    count = len(assembly.blocks)
    place = {old: new for new, old in enumerate(at for at in order if at < count)}
    point = None if load.point is None else scale * turn @ load.point + 3.0
    blocks = tuple(place[at] for at in load.blocks)
    live = replace(load, force=turn @ load.force, point=point, blocks=blocks)
    return problem_of(
        [solids[at] for at in order], problem.mu, gravity=turn @ problem.gravity, live=(live,)
    )


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**6), scale=st.sampled_from([1e-2, 1.0, 4.0]))
def test_no_answer_changes_as_blocks_are_turned_scaled_mirrored_renumbered(
    seed: int, scale: float
) -> None:
    """Of solids cut by planes, stacks that lean and vaults, friction from 0 to no bound."""
    problem, _, _ = drawn(seed)
    count = len(problem.assembly.blocks) + len(problem.assembly.supports)
    order: list[int] = np.random.default_rng(seed).permutation(count).tolist()
    turn = rotation(seed + 1) @ np.diag([-1, 1, 1])
    one = rebuilt(problem, np.eye(3), 1.0, list(range(count)))
    two = rebuilt(problem, turn, scale, order)
    assert len(one.assembly.joints) == len(two.assembly.joints)
    rests = [can_rest(each) for each in (one, two)]
    assert rests[0].exists is rests[1].exists
    assert rests[0].margin == pytest.approx(rests[1].margin, rel=1e-5, abs=1e-7)
    first, second = (largest_load(each).load_factor for each in (one, two))
    assert (first is None) is (second is None)
    if first is not None:
        assert first == pytest.approx(second, rel=1e-5, abs=1e-7)


def test_thin_slabs_on_a_slope_need_the_friction_of_its_tangent() -> None:
    """Without friction the solver finds forces that leave a tenth of a weight over."""
    slabs = Tower(
        blocks=2,
        length=0.0184,
        width=0.0125,
        height=0.000184,
        offset=0.000368,
        turn_deg=-101.123,
        friction=5.0,
    )
    problem = replace(slabs.problem(), azimuth=math.radians(147.93857629856325))
    found = blocksim.bracket(problem.tilted(math.radians(6.0)), over="mu")
    assert found.limit == pytest.approx(math.tan(math.radians(6.0)), rel=1e-6)
    assert found.confirmed


@pytest.mark.parametrize("azimuth", [0, 25, 90, 200])
@pytest.mark.parametrize("mu", [0.2, 2.0])
def test_a_block_slides_or_topples_on_a_table_tilted_towards_any_azimuth(
    azimuth: float, mu: float
) -> None:
    """Closed form: the friction angle, or half the block over the height of its centre."""
    a, b, h = 0.3, 0.5, 0.7
    solids = [
        Solid(parts=(GROUND,), fixed=True),
        Solid(parts=(box((-a, -b, 0), (a, b, 2 * h)),)),
    ]
    way = math.radians(azimuth)
    problem = replace(problem_of(solids, mu), azimuth=way)
    answer = blocksim.bracket(problem, over="tilt", tol=1e-6)
    over = min(a / max(abs(math.cos(way)), 1e-12), b / max(abs(math.sin(way)), 1e-12)) / h
    assert answer.limit == pytest.approx(math.degrees(math.atan(min(mu, over))), rel=1e-7)
    assert answer.low < answer.limit < answer.high
    assert blocksim.check(problem.tilted(math.radians(answer.low))).verdict is Verdict.STANDS
    fallen = blocksim.check(problem.tilted(math.radians(answer.high)))
    assert fallen.verdict is Verdict.COLLAPSES


@pytest.mark.parametrize(("slope", "heavy"), [(0.3, 1e-9), (0.5, 1.0), (1.0, 1e9)])
def test_the_least_friction_of_a_block_on_a_ramp_is_its_slope(
    slope: float, heavy: float
) -> None:
    """Beside another block of any weight."""
    ramp = [[x, y, z] for x in (0, 2) for y in (-1, 1) for z in (-1, slope * x)]
    block = [[x, y, slope * x + z] for x in (0.9, 1.1) for y in (-0.1, 0.1) for z in (0, 0.05)]
    solids = [
        Solid(parts=(ramp,), fixed=True, name="ramp"),
        Solid(parts=(block,), name="block"),
        Solid(parts=(box((5, 0, 0), (6, 1, 1)),), name="heavy", weight=heavy),
        Solid(parts=(box((4, -1, -1), (7, 2, 0)),), fixed=True, name="bed"),
    ]
    answer = blocksim.bracket(problem_of(solids, 0.9), over="mu", tol=1e-6)
    assert answer.limit == pytest.approx(slope, rel=1e-8)
    assert answer.stands == "high"


def test_blocks_touch_at_faces_edges_and_corners() -> None:
    """A cube on its face, a roof upside down on its edge, a pyramid on its tip."""
    edge = [[-1, 0, 0], [1, 0, 0], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1]]
    tip = [[0, 0, 0], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1]]
    for shape, points in ((box((0, 0, 0), (1, 1, 1)), 4), (edge, 2), (tip, 1)):
        assembly = problem_of(
            [Solid(parts=(GROUND,), fixed=True), Solid(parts=(shape,))]
        ).assembly
        (joint,) = assembly.joints
        assert joint.points.shape == (points, 3)
        assert joint.normal @ np.array([0, 0, 1]) == pytest.approx(1)


def test_parts_of_a_block_move_as_one() -> None:
    """An L of two boxes: its centroid, and that it stands where one box alone would fall."""
    arm, leg = box((-0.2, 0, 1), (1.4, 1, 1.2)), box((-0.2, 0, 0), (0.2, 1, 1))
    ground = Solid(parts=(GROUND,), fixed=True)
    whole = problem_of([ground, Solid(parts=(arm, leg))])
    (block,) = whole.assembly.blocks
    assert block.weight == pytest.approx(0.32 + 0.4)
    assert block.centre[0] == pytest.approx(0.32 * 0.6 / 0.72)
    assert blocksim.check(whole).verdict is Verdict.COLLAPSES
    held = problem_of([ground, Solid(parts=(box((-0.2, 0, 1), (0.6, 1, 1.2)), leg))])
    assert blocksim.check(held).verdict is Verdict.STANDS


def scene(**changes: Any) -> dict[str, Any]:
    """A block on the ground, with other keys."""
    blocks = [
        {"id": "ground", "vertices": GROUND, "fixed": True},
        {"id": "a", "vertices": box((0, 0, 0), (1, 1, 1))},
    ]
    return {"friction": 0.5, "blocks": blocks, **changes}


@pytest.mark.parametrize("decimals", [3, 4, 6, 9, 12])
def test_a_survey_with_few_decimals_has_the_same_joints(decimals: int) -> None:
    """A skew arch rounded as a file would be."""
    known = case("arch_15_skew_30_crown")
    written: list[dict[str, Any]] = known["scene"]["blocks"]
    blocks = [
        {**block, "vertices": np.round(np.array(block["vertices"]), decimals).tolist()}
        for block in written
    ]
    problem = structure_of({**known["scene"], "blocks": blocks})
    assert len(problem.assembly.joints) == known["faces"]
    factor = blocksim.check(problem).load_factor
    assert factor == pytest.approx(
        known["expected"]["value"], rel=max(200 * 10.0**-decimals, 1e-7)
    )


@pytest.mark.parametrize(
    ("lunes", "courses", "least"), [(8, 5, 0.0373487032422), (12, 7, 0.0410514715596)]
)
def test_the_least_thickness_of_a_dome(lunes: int, courses: int, least: float) -> None:
    """Of a hemisphere with an eye of 8 deg at mu 0.7, by an independent programme."""
    dome = Dome(lunes=lunes, courses=courses, friction=0.7)
    for share, exists in ((1 - 1e-6, False), (1 + 1e-6, True)):
        assert can_rest(dome.but(thickness=share * least).problem()).exists is exists


def test_a_skew_arch_is_that_of_the_case() -> None:
    """Its load factor at the crown, with the loads of the case."""
    known = case("arch_15_skew_30_crown")
    problem = SkewArch(radius=4.45, friction=known["scene"]["friction"]).problem()
    loads = structure_of(known["scene"]).live
    factor = blocksim.check(replace(problem, live=loads)).load_factor
    assert factor == pytest.approx(known["expected"]["value"], rel=1e-6)


def test_a_wall_with_a_return_is_that_of_the_case() -> None:
    """Pushed out of its plane."""
    known = case("wall_6_4_2_0_-1_0")
    problem = ReturnWall(friction=known["scene"]["friction"]).problem()
    assert len(problem.assembly.joints) == known["faces"]
    push = Load(force=np.array([0.0, -1, 0]), blocks=tuple(range(42)), per_weight=True)
    factor = blocksim.check(replace(problem, live=(push,))).load_factor
    assert factor == pytest.approx(known["expected"]["value"], rel=1e-6)


@pytest.mark.parametrize("rings", [1, 3])
@pytest.mark.parametrize("bond", ["none", "half"])
def test_a_barrel_vault_is_as_thick_as_the_arch_it_is_made_of(rings: int, bond: str) -> None:
    """Its least thickness is that of the plane arch of as many voussoirs of flat faces."""
    arch = blocksim.CircularArch(voussoirs=15, weight="chord", friction=0.7)
    least = blocksim.bracket(arch, over="thickness", method="limit").limit
    vault = BarrelVault(radius=1.0, length=0.8, rings=rings, bond=bond, friction=0.7)
    for share, exists in ((1 - 1e-7, False), (1 + 1e-7, True)):
        assert can_rest(vault.but(thickness=share * least).problem()).exists is exists


@pytest.mark.parametrize("blocks", [2, 5])
def test_a_tower_reaches_out_by_its_length_over_the_number_of_boxes(blocks: int) -> None:
    """Closed form of equal offsets; boxes that are not turned."""
    tower = Tower(blocks=blocks, length=1.5, turn_deg=0.0, friction=0.7)
    assert blocksim.bracket(tower.problem(), over="offset").limit == pytest.approx(
        1.5 / blocks, rel=1e-7
    )


def test_a_groin_vault_weighs_and_thrusts_as_its_section_says() -> None:
    """Weight and centre of its quarters in closed form; thrust by moments."""
    vault = GroinVault(courses=4, stone=1.2, thickness=0.3, friction=0.7)
    problem, (low, high), step = vault.problem(), vault.radii, math.pi / 8
    turns = (np.arange(4) + 0.5) * step
    # Trapezoids between two chords: their area, and its first and second moment about x = 0.
    area = np.full(4, (high**2 - low**2) / 2 * math.sin(step))
    first = (high**3 - low**3) / 3 * math.sin(step) * math.cos(step / 2) * np.sin(turns)
    volume = 8 * (vault.end * area - first).sum()
    weights, centres = problem.assembly.weights, problem.assembly.centres
    assert weights.sum() == pytest.approx(volume, rel=1e-12)
    assert weights @ centres[:, :2] == pytest.approx([0, 0], abs=1e-12)
    right = centres[:, 0] > 0
    half, out = (
        float(weights[right].sum()),
        float(np.average(centres[right, 0], weights=weights[right])),
    )
    assert half == pytest.approx(volume / 2, rel=1e-12)
    carried = can_rest(problem).resultants
    assert carried is not None
    bears = [at for at, joint in enumerate(problem.assembly.joints) if joint.before < 0]
    thrust = -sum(float(carried.force[at, 0]) for at in bears if carried.point[at, 0] > 0)
    # At the crown it acts within the thickness, at the springing likewise.
    assert half * (low - out) / high < thrust < half * (high - out) / low


def test_a_groin_vault_that_is_pushed_lies_between_two_linear_programmes() -> None:
    push = Load(force=[1.0, 0.3, 0.0], blocks=tuple(range(8)), per_weight=True)
    vault = GroinVault(courses=2, stone=1.5, thickness=0.3, friction=0.6).problem()
    problem = replace(vault, live=(push,))
    below, above = enclosed(problem, sides=32)
    found = largest_load(problem).load_factor
    assert 0 < below <= found * (1 + 1e-6)
    assert found <= above * (1 + 1e-6) < below * 1.02


@pytest.mark.parametrize("name", SOLID_KINDS)
def test_each_kind_in_space_stands_as_it_comes_at_any_size(name: str) -> None:
    """And its joints are as many when it is ten times as large."""
    kind = SOLID_KINDS[name](friction=0.7)
    problem = kind.problem()
    assert blocksim.check(problem).verdict is Verdict.STANDS
    larger = {
        each: 10 * getattr(kind, each)
        for each, known in fields_of(type(kind)).items()
        if known.unit == "m"
    }
    scaled = kind.but(**larger).problem()
    assert len(scaled.assembly.joints) == len(problem.assembly.joints)
    assert can_rest(scaled).margin == pytest.approx(can_rest(problem).margin, rel=1e-5)


def test_voussoirs_a_millionth_as_wide_as_long_have_their_faces_and_joints() -> None:
    """Their planes are those of narrow triangles, which rounding turns."""
    assembly = blocksim.SkewArch(width=1e-6, friction=0.7).problem().assembly
    assert [len(block.hulls[0].faces) for block in assembly.blocks] == [6] * 15
    assert [len(joint.points) for joint in assembly.joints] == [4] * 16


PLANE = [name for name in plane_names() if plane_case(name)["question"] == "load_factor"][::4]


@pytest.mark.parametrize("name", PLANE)
def test_prisms_have_the_same_load_factor_in_the_plane_and_in_space(name: str) -> None:
    """Of ten structures, to 1e-8."""
    (scene, *_) = scenes(name)
    problem = blocksim.structure_of(scene)
    plane = blocksim.bracket(problem, over="load", method="limit").limit
    assert largest_load(extruded(problem)).load_factor == pytest.approx(plane, rel=1e-8)


@pytest.mark.parametrize("lean", [5.0, 20.0])
def test_a_column_that_leans_falls_where_it_would_turn_over_its_edge(lean: float) -> None:
    """Out of the plane: half its depth over the height of its centre."""
    half = math.tan(math.radians(lean)) * 1.5
    for share, verdict in ((1 + 1e-6, "STANDS"), (1 - 1e-6, "COLLAPSES")):
        depth = f"depth={2 * half * share:.12g}"
        asked = f"check column --mu 0.9 --with {depth} --with drum_height=0.5"
        tilted = (f"--tilt {lean} --azimuth {way} --spatial" for way in (90, -90))
        for acts in (f"--lean {lean}", f"--lean {lean} --spatial", *tilted):
            assert inside(*asked.split(), *acts.split()).stdout.startswith(verdict), acts


@pytest.mark.parametrize(
    "azimuth", [*(pytest.param(each, marks=pytest.mark.long) for each in (0, 90)), -143]
)
@pytest.mark.parametrize("structure", ["tower", "skew-arch"])
def test_a_push_is_borne_up_to_the_tangent_of_the_tilt(structure: str, azimuth: int) -> None:
    """Gravity and a level push of all blocks are gravity on a tilted table, but stronger."""
    limits: dict[str, float] = {}
    for over in ("push", "tilt"):
        asked = ("bracket", structure, "--mu", "0.7", "--over", over, "--azimuth", azimuth)
        answer = json.loads(inside(*map(str, asked), "--json").stdout)
        assert answer["proved"]
        limits[over] = answer["limit"]
    assert limits["push"] == pytest.approx(math.tan(math.radians(limits["tilt"])), rel=1e-7)
    push = limits["push"]
    for share, code in ((0.999, 0), (1.001, 1)):
        asked = ("check", structure, "--mu", "0.7", "--azimuth", azimuth, "--push")
        assert inside(*map(str, asked), str(share * push)).returncode == code


@pytest.mark.parametrize("tilt", [pytest.param(0.0, marks=pytest.mark.long), -8.0])
def test_a_lean_is_asked_in_space(tilt: float) -> None:
    """A column of 3 m, 0.4 m deep: tan(lean) = cos(tilt) 0.4 / 3, as it tilts in its plane."""
    given = {"depth": 0.4, "drums": 6, "drum_height": 0.5, "width": 1.0}
    column = blocksim.Column(**given, friction=0.9).problem().tilted(math.radians(tilt))
    found = blocksim.bracket(column, over="lean")
    expected = math.degrees(math.atan(math.cos(math.radians(tilt)) * 0.4 / 3))
    assert found.method == "limit"
    assert found.confirmed
    assert found.limit == pytest.approx(expected, rel=1e-6)
    assert blocksim.check(column.leaning(math.radians(expected + 0.01))).method == "limit"
    for aside, verdict in ((-1, Verdict.STANDS), (1, Verdict.COLLAPSES)):
        leaning = column.leaning(math.radians(expected + aside))
        for method in ("direct", "pybullet"):
            assert blocksim.check(leaning, method=method).verdict is verdict


def test_a_picture_shows_the_verdict_and_what_joints_do(tmp_path: Path) -> None:
    """In words and colours."""
    out = tmp_path / "dome.svg"
    asked = f"render dome --mu 0.7 --with thickness=0.03 --out {out}"
    assert inside(*asked.split()).returncode == 0
    drawn = out.read_text(encoding="utf-8")
    for words in ("COLLAPSES", "84 blocks, μ = 0.7", "hinge", "as it begins to fall"):
        assert words in drawn or words in "".join(re.findall(r"<!-- (.*?) -->", drawn))
    assert JOINTS[JointState.HINGE_INTRADOS].lower() in drawn.lower()


def test_a_picture_and_a_page_say_a_push_and_towards_where() -> None:
    """By what shares of the weight it is pushed, in their words."""
    wall = with_push(replace(ReturnWall(friction=0.5).problem(), azimuth=math.radians(60)), 0.1)
    answer, said = blocksim.check(wall), "a push of 0.1 of each weight towards 60° from x"
    words = [each.get_text() for each in solid_figure(answer).findobj(Text)]
    assert any(said in each for each in words)
    assert said in turning_page(answer)


def test_an_arch_that_leans_is_drawn_on_its_springings() -> None:
    """Unknown supports are slabs as wide as the joints on them, and wider, beyond the arch."""
    arch = blocksim.CircularArch(half_angle_deg=70, eta=0.2, friction=0.7, voussoirs=9)
    assembly = extruded(arch.problem()).assembly
    slabs = supports_of(assembly, *moving_box(assembly))
    joints = [each for each in assembly.joints if -1 in (each.before, each.after)]
    assert len(slabs) == len(joints) == 2
    for slab, joint in zip(slabs, joints, strict=True):
        out = joint.normal if joint.after == -1 else -joint.normal
        heights = (slab.corners - joint.points[0]) @ out
        assert heights.min() == pytest.approx(0, abs=1e-12)
        assert heights.max() > 0.1 * assembly.size
        low, high = slab.box
        assert (low <= joint.points + 1e-12).all()
        assert (joint.points <= high + 1e-12).all()


FLAT = {"arch_15_skew_0_crown", "block_topples_0", "harmonic_4_in", "harmonic_4_out"}
"""Cases that are the same at any depth."""


@pytest.mark.parametrize("name", NAMES)
def test_what_is_the_same_at_any_depth_is_told(name: str) -> None:
    """The straight arch that is loaded at its crown, a block, and boxes that reach out."""
    problem = structure_of(case(name)["scene"])
    assert (way_of_prisms(problem) is not None) is (name in FLAT)


OPENING = {"left": 0.5, "right": 0.7, "from_course": 1, "to_course": 3}


def test_a_wall_with_an_opening_falls_in_space_as_in_the_plane() -> None:
    """Without a return it is a prism."""
    bricks = {"openings": [OPENING], "courses": 5, "friction": 0.6}
    sizes = {"length": 1.6, "block_length": 0.4, "block_height": 0.15, "depth": 0.2}
    flat = structure_of({"kind": "wall", **bricks, **sizes})
    wall = structure_of({"kind": "return-wall", **bricks, "returned": 0})
    assert len(wall.assembly.blocks) == len(flat.assembly.blocks)
    plane, space = (blocksim.bracket(each, over="tilt").limit for each in (flat, wall))
    assert space == pytest.approx(plane, rel=1e-8)
    with pytest.raises(InputError, match=r"openings\[0\].right = 0.7: must be from left = 0.5"):
        structure_of({"kind": "return-wall", **bricks, "bricks": 1})


def test_prisms_say_that_the_plane_would_do_unless_they_lean_out_of_it() -> None:
    """Also where they are turned in space."""
    arch = blocksim.CircularArch(half_angle_deg=70, eta=0.2, friction=0.7, voussoirs=9)
    push = Load(force=np.array([1.0, 0.0, 0.0]), blocks=(4,), per_weight=True)
    flat = replace(extruded(arch.problem()), live=(push,))
    words = "it is the same at any depth along y: the plane across has the same answer"
    assert words in blocksim.check(flat).reason
    assert words in blocksim.bracket(flat, over="load").reason
    assert words in blocksim.bracket(flat, over="tilt").reason
    leaning = replace(flat, gravity=np.array([0.0, 0.02, -1.0]))
    assert words not in blocksim.bracket(leaning, over="load").reason
    assert way_of_prisms(replace(flat, gravity=np.array([0.1, 0.0, -1.0]))) is not None
    assert way_of_prisms(replace(flat, gravity=np.array([0.0, 0.1, -1.0]))) is None
    wall = replace(extruded(blocksim.Wall(friction=0.5).problem()), live=(push,))
    count = len(wall.assembly.blocks) + len(wall.assembly.supports)
    turned = rebuilt(wall, rotation(3), 2.0, list(range(count)))
    way = way_of_prisms(turned)
    assert abs(way @ rotation(3)[:, 1]) == pytest.approx(1)
    numbers = [float(each) for each in re.findall(r"-?[\d.]+", along(turned))]
    assert numbers == pytest.approx(list(way), abs=5e-3)


def along(problem: Any) -> str:
    """Along what its depth is of no account, as it is told."""
    return re.search(r"same at any depth along (.+?): ", blocksim.check(problem).reason)[1]


@pytest.mark.parametrize(("azimuth", "told"), [(0, "y"), (90, "x")])
def test_it_is_told_along_what_the_depth_is_of_no_account(azimuth: float, told: str) -> None:
    """A column that topples out of its plane hangs on its depth there, not on its width."""
    for width, depth in ((1.0, 0.5), (1.5, 0.5), (1.0, 0.6)):
        made = blocksim.Column(friction=0.9, drums=2, drum_height=1, width=width, depth=depth)
        table = replace(extruded(made.problem()), azimuth=math.radians(azimuth))
        found = blocksim.bracket(table, over="tilt")
        assert f"same at any depth along {told}: " in found.reason
        across = width if told == "y" else depth
        assert math.tan(math.radians(found.limit)) == pytest.approx(across / 2, rel=1e-6)


def test_a_fall_that_is_proved_is_said_without_bound() -> None:
    """Of wedged blocks floating-point numbers rule out forces up to some weights."""
    problem = structure_of(case("dome_12_7_falls")["scene"])
    static = blocksim.equilibrium(problem)
    assert static.gap > 0
    assert static.proof is not None
    assert "times all weight" not in blocksim.check(problem).reason


def test_a_picture_has_every_block_within_its_frame() -> None:
    """Of each kind: the polygons lie within the axes."""
    for name in SOLID_KINDS:
        problem = SOLID_KINDS[name](friction=0.7).problem()
        drawn = solid_figure(blocksim.check(problem)).artists
        # The ground comes first, and fades out beyond the frame; shadows may leave it, too.
        _, polygons, *_ = (each for each in drawn if isinstance(each, PolyCollection))
        assembly = problem.assembly
        parts = sum(len(each.hulls) for each in (*assembly.blocks, *assembly.supports))
        paths = polygons.get_paths()[2 * parts :]
        points = np.concatenate([each.vertices for each in paths])
        low, high = points.min(axis=0), points.max(axis=0)
        assert (low > 0).all()
        assert (high < polygons.get_clip_box().max).all()
        assert len(polygons.get_paths()) >= len(problem.assembly.blocks)


@pytest.mark.parametrize("sunk", [0.3e-5, 0.9e-5, 1.5e-5])
def test_a_block_sunk_by_rounding_rests_on_its_face(sunk: float) -> None:
    """By less than two steps of the fifth decimal, as of corners turned in space."""
    block = box((-0.12345, -0.5, -sunk), (1, 1, 1))
    (joint,) = blocksim.assembly_in_space(
        [Solid(parts=(GROUND,), fixed=True), Solid(parts=(block,))], tolerance=2e-5
    ).joints
    assert joint.points.shape == (4, 3)
    assert joint.gap == pytest.approx(-sunk)


def test_a_smooth_block_rests_on_level_ground_and_bears_no_push(tmp_path: Path) -> None:
    """What it bears is 0, not a last digit below it."""
    file = tmp_path / "smooth.json"
    told = scene(friction=0, live=[{"body": [0.6, 0.8, 0]}])
    file.write_text(json.dumps(told), encoding="utf-8")
    said = inside("check", str(file)).stdout
    assert said.startswith("STANDS")
    assert "factor at collapse 0: it bears none of the live loads" in said
    assert "in balance to 1e-12" in said
    assert inside("check", str(file), "--load", "0.001").stdout.startswith("COLLAPSES")
    assert "LOAD: 0 is the limit" in inside("bracket", str(file), "--over", "load").stdout


@pytest.mark.parametrize(("over", "factor"), [(0.4, math.inf), (0.6, None)])
@pytest.mark.parametrize(("mu", "way"), [(0.5, (0, 0, -1)), (math.inf, (1, 0, 0))])
def test_a_load_that_is_borne_to_any_size_holds_no_other_block(
    over: float, factor: float | None, mu: float, way: tuple[float, ...]
) -> None:
    """A block is pressed down, or along ground too rough to slip; another one leans out."""
    solids = [
        Solid(parts=(GROUND,), fixed=True, name="ground"),
        Solid(parts=(box((0, 0, 0), (1, 1, 1)),), name="pressed"),
        Solid(parts=(box((8 + over, 0, 0), (9 + over, 1, 1)),), name="leans"),
    ]
    load = Load(force=np.array(way, dtype=float), blocks=(0,), point=np.array([0.5, 0.5, 0.0]))
    assert blocksim.collapse(problem_of(solids, mu, live=(load,))).load_factor == factor


def test_a_solution_refutes_that_there_is_none() -> None:
    """As of a stack pushed a thousandth beyond friction, scaled by the solver and not."""
    near = SimpleNamespace(
        status="AlmostSolved", obj_val=0.004, obj_val_dual=0.004, r_prim=7e-11, r_dual=1e-10
    )
    none = SimpleNamespace(
        status="PrimalInfeasible",
        obj_val=math.nan,
        obj_val_dual=math.nan,
        r_prim=2.5,
        r_dual=0.6,
    )
    assert _left_over(near) < _left_over(none)
    assert _left_over(none) < _left_over(SimpleNamespace(**{**vars(near), "r_dual": 1e-3}))


def box_on_table(**joint: Any) -> dict[str, Any]:
    """A cube on a table, by a joint that is given."""
    table, cube = (
        [[x, y, z] for x in (low, high) for y in (low, high) for z in heights]
        for low, high, heights in ((-1.0, 2.0, (-1.0, 0.0)), (0.0, 1.0, (0.0, 1.0)))
    )
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    given = {"a": "table", "b": "cube", "points": points, "normal": [0, 0, 1], **joint}
    blocks = [
        {"id": "table", "vertices": table, "fixed": True},
        {"id": "cube", "vertices": cube},
    ]
    return {"friction": 0.6, "blocks": blocks, "joints": [given], "live": [{"body": [1, 0, 0]}]}


def test_a_joint_that_is_given_lies_on_its_blocks_and_points_from_one_to_the_other() -> None:
    """Half of the bed bears half of the lever; a bed of mortar is as good."""
    assert blocksim.check(structure_of(box_on_table())).load_factor == pytest.approx(0.6)
    for beside in (0.0, 0.01, -0.01):
        points = [[x, y, beside] for x, y in ((0.25, 0), (0.75, 0), (0.75, 1), (0.25, 1))]
        found = blocksim.check(structure_of(box_on_table(points=points))).load_factor
        assert found == pytest.approx(0.25 / (0.5 - beside))
    turned = {"a": "cube", "b": "table", "normal": [0, 0, -1]}
    assert blocksim.check(structure_of(box_on_table(**turned))).load_factor == pytest.approx(
        0.6
    )
    for wrong, said in (
        (
            {"points": [[0, 0, 7], [1, 0, 7], [1, 1, 7]]},
            r"joints\[0\].points = .* it is 6 m off",
        ),
        (
            {"points": [[0, 0, 0], [3, 0, 0], [1, 1, 0]]},
            r"joints\[0\].points = .* it is 1 m off",
        ),
        ({"normal": [0, 0, -1]}, r"joints\[0\].normal = .* it points from cube to table"),
        ({**turned, "normal": [0, 0, 1]}, r"joints\[0\].normal = .* from table to cube"),
    ):
        with pytest.raises(InputError, match=said):
            structure_of(box_on_table(**wrong))


BOX = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
EDGES = [
    (a, b) for a, b in itertools.combinations(range(8), 2) if (BOX[a] != BOX[b]).sum() == 1
]


def test_edges_that_cross_touch_whatever_the_slack() -> None:
    """Boxes nearly level, pushed together until an edge of each meets at a point of both.

    Faces that all but part them hid that point where the slack was more than they overlap.
    """
    random, seen = np.random.default_rng(7), 0
    while seen < 150:
        one = BOX * random.uniform(0.3, 1, 3)
        turn = transform.Rotation.from_euler("xyz", random.normal(0, 0.05, 3))
        other = turn.apply(BOX * random.uniform(0.3, 1, 3))
        (a, b), (c, d) = EDGES[random.integers(12)], EDGES[random.integers(12)]
        across = np.cross(one[b] - one[a], other[d] - other[c])
        if np.linalg.norm(across) < 0.05:
            continue
        normal = across / np.linalg.norm(across) * np.sign(across @ one[a])
        place = one[a] + random.uniform(0.1, 0.9) * (one[b] - one[a])
        other += place - other[c] - random.uniform(0.1, 0.9) * (other[d] - other[c])
        # The plane along both edges has a box on either side.
        if (one @ normal).max() > place @ normal + 1e-9:
            continue
        if (other @ normal).min() < place @ normal - 1e-9:
            continue
        seen += 1
        for slack in (1e-4, 1e-3):
            found = contact(
                Polyhedron(one).with_slack(slack), Polyhedron(other).with_slack(slack), slack
            )
            assert isinstance(found, Contact)
            assert found.gap == pytest.approx(0.0, abs=slack)


@pytest.mark.parametrize("tolerance", [None, 0.002])
def test_rims_that_rounding_crosses_are_no_joint(tolerance: float | None) -> None:
    """A wall turned in space has the joints that it had, whatever its last decimals."""
    wall = ReturnWall(friction=0.7).problem().assembly
    turn = transform.Rotation.from_euler("xyz", [0.3, 0.2, 0.7])
    solids = [
        Solid(
            parts=tuple(
                (2 * turn.apply(np.array(hull.corners))).round(6) for hull in block.hulls
            ),
            fixed=at >= len(wall.blocks),
        )
        for at, block in enumerate((*wall.blocks, *wall.supports))
    ]
    found = blocksim.assembly_in_space(solids, tolerance=tolerance)
    assert len(found.joints) == len(wall.joints)
