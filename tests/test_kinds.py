"""Kinds of structures: blocks and answers of the corpus, exact weights, invariances."""

import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kind_cases import CATENARY, FACTORS, KINDS, LEAST, PIERS, PLANAR, STACKS
from running import answered, refused
from scipy.special import ellipe
from structure_cases import case, of_each_kind, scenes

import blocksim
from blocksim import (
    Arch,
    Block,
    CircularArch,
    InputError,
    Maker,
    Problem,
    assembly_of_polygons,
    collapse,
    equilibrium,
    load_recording,
    simulate,
    structure_of,
)

LOOSER = {
    "pointed": 2e-7,
    "ellipse": 1e-7,
    "parabola": 1e-7,
    "catenary": 2e-7,
    "semicircle_vertical_joints": 2e-6,
}
"""Where the corpus summed weights step by step; rings and boxes agree to 1e-9.

That ours are exact is held to closed forms below."""
CURVED = [name for name, kind in KINDS.items() if hasattr(kind, "curve")]
ARCHES = [*CURVED, "flat-arch"]


def in_order(problem: Problem) -> list[Block]:
    def place(block: Block) -> tuple[float, float]:
        x, y = block.centre
        return round(float(y), 6), round(float(x), 6)

    return sorted(problem.assembly.blocks, key=place)


def assert_same_blocks(made: Problem, read: Problem, name: str, *, moved: bool = False) -> None:
    """The same corners, weights, centres, and as many joints."""
    near = LOOSER.get(name, LOOSER.get(name.split("_")[0], 1e-9))
    mine, known = in_order(made), in_order(read)
    assert len(mine) == len(known)
    shift = known[0].vertices[0] - mine[0].vertices[0] if moved else np.zeros(2)
    for one, other in zip(mine, known, strict=True):
        apart = np.abs(one.vertices[:, None] + shift - other.vertices[None]).max(axis=2)
        assert apart.min(axis=1).max() < near
        assert np.abs(one.centre + shift - other.centre).max() < near
        assert one.mass == pytest.approx(other.mass, rel=near)
    assert len(made.assembly.joints) == len(read.assembly.joints)


@pytest.mark.parametrize("name", of_each_kind({**LEAST, **PIERS}))
def test_structures_whose_least_size_is_known(name: str) -> None:
    """The corpus has each arch a little thicker and thinner than that, each pier wider."""
    least = case(name)["expected"]["value"]
    size = "pier_width" if name in PIERS else "thickness"
    for told, scene in zip(case(name)["scenes"], scenes(name), strict=True):
        read = structure_of(scene)
        foot = float(np.ptp(in_order(read)[0].vertices[:, 0]))
        own = foot if name in PIERS else read.assembly.joints[0].length
        table = {**LEAST, **PIERS}[name]
        made = structure_of({**table, "friction": scene["friction"], size: own})
        assert_same_blocks(made, read, name)
        assert equilibrium(made).exists == told["expected"]
    for share, stands in ((1 + 1e-6, True), (1 - 1e-6, False)):
        assert equilibrium(made.but(**{size: share * least})).exists == stands


def test_a_catenary_stands_however_thin() -> None:
    for thickness, scene in zip((0.005, 0.05), scenes("catenary"), strict=True):
        table = {**CATENARY, "friction": scene["friction"], "thickness": thickness}
        assert_same_blocks(structure_of(table), structure_of(scene), "catenary")
        assert equilibrium(structure_of(table)).exists


@pytest.mark.parametrize("name", of_each_kind(FACTORS))
def test_structures_whose_load_factor_is_known(name: str) -> None:
    (scene,) = scenes(name)
    made = structure_of({**FACTORS[name], "friction": scene["friction"]})
    assert_same_blocks(made, structure_of(scene), name)
    expected = case(name)["expected"]["value"]
    assert collapse(made).load_factor == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("name", of_each_kind(STACKS))
def test_stacks_that_are_known_to_stand_or_to_fall(name: str) -> None:
    for told, scene in zip(case(name)["scenes"], scenes(name), strict=True):
        read = structure_of(scene)
        table = {**STACKS[name], "friction": scene["friction"]}
        if name.startswith("harmonic"):
            corners = np.concatenate([block.vertices for block in read.assembly.blocks])
            table["overhang"] = float(corners[:, 0].max())
        made = structure_of(table)
        assert_same_blocks(made, read, name)
        assert equilibrium(made).exists == told["expected"]


def test_a_column_overturns_about_its_base() -> None:
    (scene,) = scenes("column_six_drums")
    column = structure_of({"kind": "column", "friction": scene["friction"]})
    assert_same_blocks(column, structure_of(scene), "column", moved=True)
    tilt = math.radians(case("column_six_drums")["expected"]["value"])
    assert equilibrium(column.tilted(tilt * (1 - 1e-6))).exists
    assert not equilibrium(column.tilted(tilt * (1 + 1e-6))).exists
    tapered = structure_of({"kind": "column", "friction": 0.7, "top_width": 0.6})
    masses = np.array([block.mass for block in tapered.assembly.blocks])
    assert masses.sum() * 9.81 == pytest.approx(0.8 * 3.6, rel=1e-12)
    # Its middle is at (w + 2 v) / (w + v) h / 3.
    height = (masses @ tapered.assembly.centres[:, 1]) / masses.sum()
    assert height == pytest.approx((1 + 1.2) / 1.6 * 3.6 / 3, rel=1e-12)


@pytest.mark.parametrize("eta", [0.02, 0.3, 1.5])
@pytest.mark.parametrize("voussoirs", [3, 28])
def test_a_ring_is_that_of_the_paper(eta: float, voussoirs: int) -> None:
    """Closed forms of mass, centroid and inertia of annular sectors."""
    for half, weight, kind in (
        (75.0, "sector", "curved"),
        (150.0, "sector", "curved"),
        (60.0, "centreline", "centreline"),
    ):
        arch = Arch(
            half_angle=math.radians(half),
            eta=eta,
            voussoirs=voussoirs,
            weight=weight,  # type: ignore[arg-type]
            radius=2.0,
            depth=1.5,
            specific_weight=3.0,
        ).assembly()
        table = {
            "kind": "circular-arch", "friction": 1.0, "density": 3.0, "depth": 1.5,
            "radius": 2.0, "thickness": 2.0 * eta, "voussoirs": voussoirs, "weight": kind,
            "left_deg": half, "right_deg": half,
        }  # fmt: skip
        made = structure_of(table).assembly
        assert made.centres == pytest.approx(arch.centres, abs=1e-13)
        for one, other in zip(made.blocks, arch.blocks, strict=True):
            assert one.mass == pytest.approx(other.mass, rel=1e-13)
            assert one.inertia == pytest.approx(other.inertia, rel=1e-11)
            assert one.vertices == pytest.approx(other.vertices, abs=1e-13)
        for one, other in zip(made.joints, arch.joints, strict=True):
            assert (one.before, one.after) == (other.before, other.after)
            assert one.outer == pytest.approx(other.outer, abs=1e-13)


LENGTHS: dict[str, tuple[dict[str, float], float]] = {
    "circular-arch": ({"left_deg": 100.0, "right_deg": 20.0}, math.radians(120)),
    "pointed-arch": ({"radius": 1.5}, 3.0 * math.acos(1 / 3)),
    "elliptic-arch": ({"rise": 0.4}, 2 * ellipe(1 - 0.4**2)),
    "parabolic-arch": ({"rise": 0.7}, math.hypot(1, 1.4) + math.asinh(1.4) / 1.4),
    "catenary-arch": ({"rise": 0.5 * (math.cosh(2) - 1)}, math.sinh(2.0)),
}
"""Lengths of centrelines with a half-span (or radius) of 1, in closed form."""


@pytest.mark.parametrize("name", LENGTHS)
def test_weights_are_exact(name: str) -> None:
    """Between offsets of a curve lie its length times the thickness, in equal parts."""
    given_, long = LENGTHS[name]
    stones = KINDS[name](**given_, voussoirs=14, thickness=0.15).stones  # type: ignore
    if name == "pointed-arch":
        # Its joint at the crown is not square: outer rings reach beyond the centreline.
        rings = [1.5 + side * 0.075 for side in (-1, 1)]
        ends = [math.acos(0.5 / ring) for ring in rings]
        low, high = (
            r * r * a / 2 - 0.25 * math.sqrt(r * r - 0.25)
            for r, a in zip(rings, ends, strict=True)
        )
        assert stones.area.sum() == pytest.approx(2 * (high - low), rel=1e-13)
        assert stones.area[:6] == pytest.approx(0.15 * long / 14, rel=1e-13)
    else:
        assert stones.area == pytest.approx(0.15 * long / 14, rel=1e-12)


def test_three_arcs_of_a_basket_handle() -> None:
    """Rise, span and length follow from the radii; tangents meet where arcs do."""
    kind = KINDS["basket-handle-arch"](rise=0.55, side_deg=50.0, voussoirs=31)  # type: ignore
    small, large = kind.radii  # type: ignore[attr-defined]
    side = math.radians(50)
    # The middle arc's centre is as far below as its radius is above the rise.
    centre = 0.55 - large
    assert math.hypot(1 - small, centre) == pytest.approx(large - small, rel=1e-12)
    assert math.atan2(-centre, 1 - small) == pytest.approx(side, rel=1e-12)
    long = 2 * small * side + large * (math.pi - 2 * side)
    assert kind.stones.area.sum() == pytest.approx(0.2 * long, rel=1e-13)  # type: ignore
    joints = kind.stones.faces.mean(axis=1)  # type: ignore[attr-defined]
    assert joints[0] == pytest.approx([-1, 0], abs=1e-12)
    assert np.abs(kind.curve().point(np.zeros(1))[0] - [0, 0.55]).max() < 1e-12  # type: ignore


@pytest.mark.parametrize("name", CURVED)
def test_joints_change_no_moment_of_the_whole(name: str) -> None:
    """However an arch is cut: area, first and second moments, and the fill's weight."""

    def moments(joints: str, voussoirs: int) -> list[float]:
        kind = KINDS[name](joints=joints, voussoirs=voussoirs, fill=0.2)  # type: ignore
        stones, fills = kind.stones, kind.fills(1.0, 0)  # type: ignore[attr-defined]
        second = stones.polar + stones.area * (stones.centre**2).sum(axis=1)
        pressing = np.array([[each.weight, each.weight * each.point[0]] for each in fills])
        first = (stones.area[:, None] * stones.centre).sum(axis=0)
        return [stones.area.sum(), *first, second.sum(), *pressing.sum(axis=0)]

    want = moments("normal", 40)
    for joints, voussoirs in (("normal", 12), ("radial", 12), ("vertical", 12)):
        assert moments(joints, voussoirs) == pytest.approx(want, rel=1e-12, abs=1e-13)


def test_fill_over_a_semicircle() -> None:
    """A rectangle less half a disc; over piers it goes on to their edges."""
    table = {"kind": "circular-arch", "friction": 0.7, "fill": 0.3, "fill_density": 0.5}
    disc = math.pi * 1.1**2 / 2
    over = structure_of(table)
    pressing = [-load.force[1] for load in over.dead]
    assert sum(pressing) == pytest.approx(0.5 * (2.2 * 1.4 - disc), rel=1e-13)
    assert pressing == pytest.approx(pressing[::-1], rel=1e-12)
    del table["friction"]
    portal = {"kind": "portal", "friction": 0.7, "arch": table, "pier_width": 0.5}
    whole = -sum(load.force[1] for load in structure_of(portal).dead)
    assert whole == pytest.approx(0.5 * (2.8 * 1.4 - disc), rel=1e-13)
    arcade = {"kind": "arcade", "friction": 0.7, "arch": table, "pier_width": 0.5, "spans": 2}
    whole = -sum(load.force[1] for load in structure_of(arcade).dead)
    assert whole == pytest.approx(0.5 * ((2 * 2.2 + 0.1) * 1.4 - 2 * disc), rel=1e-12)
    # Not multiplied: what the file says comes after it.
    more = structure_of(
        {**portal, "dead": [{"body": [0, -2]}, {"block": "3", "force": [1, 0]}]}
    )
    assert more.gravity[1] == -2
    assert len(more.dead) == len(structure_of(portal).dead) + 1


@pytest.mark.parametrize("name", ARCHES)
def test_an_arch_is_made_as_its_bodies_would_be(name: str) -> None:
    """The short way to an assembly leads where the search for faces does."""
    mine = structure_of({"kind": name, "friction": 1.0, "density": 2.0}).assembly
    bodies = KINDS[name]().made(2.0).bodies
    fixed = [at for at, each in enumerate(bodies) if each.fixed]
    found = assembly_of_polygons([each.polygons[0] for each in bodies], fixed=fixed)
    for one, other in zip(mine.blocks, found.blocks, strict=True):
        assert np.array_equal(one.vertices, other.vertices)
    ends = {frozenset((joint.before, joint.after)): joint for joint in found.joints}
    for joint in mine.joints[1:-1]:
        other = ends[frozenset((joint.before, joint.after))]
        assert {*map(tuple, (joint.inner, joint.outer))} == {
            *map(tuple, (other.inner, other.outer))
        }
    assert len(found.joints) == len(mine.joints)
    assert [each.name for each in mine.supports] == ["left", "right"]


def test_joints_point_where_they_should() -> None:
    ellipse: Any = KINDS["elliptic-arch"]
    for joints in ("radial", "vertical", "normal"):
        faces = ellipse(rise=0.5, joints=joints, voussoirs=9, thickness=0.1).stones.faces[1:-1]
        along = faces[:, 1] - faces[:, 0]
        if joints == "vertical":
            assert np.abs(along[:, 0]).max() < 1e-14
        elif joints == "radial":
            cross = faces[:, 0, 0] * faces[:, 1, 1] - faces[:, 0, 1] * faces[:, 1, 0]
            assert np.abs(cross).max() < 1e-14
            turn = np.diff(np.arctan2(faces[:, 0, 0], faces[:, 0, 1]))
            assert turn == pytest.approx(math.pi / 9, rel=1e-12)
        else:
            x, y = faces.mean(axis=1).T
            slope = np.column_stack([x, y / 0.5**2])
            assert np.abs(along[:, 0] * slope[:, 1] - along[:, 1] * slope[:, 0]).max() < 1e-14
            assert np.hypot(*along.T) == pytest.approx(0.1, rel=1e-13)
    flat: Any = KINDS["flat-arch"]
    faces = flat(joints="inclined", skew_deg=20.0, voussoirs=5).stones.faces
    lean = (faces[:, 1, 0] - faces[:, 0, 0]) / 0.4 / math.tan(math.radians(20))
    assert lean == pytest.approx([-1, -1, -1, 1, 1, 1], rel=1e-12)


sizes = st.floats(0.01, 100.0)
anyarch = st.sampled_from(CURVED)
frictions = st.sampled_from([0.4, 0.8, math.inf])


@settings(max_examples=12)
@given(anyarch, frictions, st.floats(0.03, 0.25), st.floats(0.3, 0.9), sizes)
def test_scaled_is_the_same(
    name: str, mu: float, thick: float, rise: float, size: float
) -> None:
    """In units of its weight nothing depends on its size."""

    def margin(scale: float) -> float:
        table = {"kind": name, "friction": mu, "voussoirs": 12, "density": scale}
        lengths = {"thickness": thick}
        known = {each.name for each in fields(KINDS[name])}
        lengths |= {"span": 2.0} if "span" in known else {"radius": 1.0}
        lengths |= {"rise": rise} if "rise" in known else {}
        lengths |= {"radius": 1.2} if name == "pointed-arch" else {}
        return equilibrium(
            structure_of({**table, **{key: scale * each for key, each in lengths.items()}})
        ).margin

    if name == "basket-handle-arch":
        rise = 0.5 + rise / 2
        thick /= 5
    if name == "elliptic-arch":
        thick = min(thick, rise**2)
    assert margin(size) == pytest.approx(margin(1.0), rel=1e-7, abs=1e-9)


@settings(max_examples=12)
@given(
    frictions,
    st.floats(0.05, 0.4),
    st.floats(20.0, 100.0),
    st.floats(-10.0, 100.0),
    st.sampled_from(["curved", "chord", "centreline"]),
)
def test_mirrored_is_the_same(
    mu: float, thick: float, left: float, right: float, weight: str
) -> None:
    table = {
        "kind": "circular-arch", "friction": mu, "voussoirs": 13, "thickness": thick,
        "weight": weight, "live": [{"body": [1, 0]}],
    }  # fmt: skip
    one = structure_of({**table, "left_deg": left, "right_deg": right})
    other = structure_of({**table, "left_deg": right, "right_deg": left})
    flip = np.array([-1.0, 1.0])
    assert one.assembly.centres == pytest.approx(other.assembly.centres[::-1] * flip, abs=1e-12)
    margins = equilibrium(one).margin, equilibrium(other).margin
    assert margins[0] == pytest.approx(margins[1], rel=1e-7, abs=1e-9)
    pushed = structure_of(
        {**table, "left_deg": right, "right_deg": left, "live": [{"body": [-1, 0]}]}
    )
    factors = collapse(one).load_factor, collapse(pushed).load_factor
    assert (factors[0] is None) == (factors[1] is None)
    if factors[0] is not None:
        assert factors[0] == pytest.approx(factors[1], rel=1e-7, abs=1e-9)


def test_rubble_fills_its_wall_and_follows_its_seed() -> None:
    def stones(seed: int) -> Problem:
        return structure_of({"kind": "rubble", "friction": 0.7, "seed": seed, "stones": 25})

    one, again, other = stones(3), stones(3), stones(4)
    assert one.to_dict() == again.to_dict()
    assert one.assembly.centres[0] != pytest.approx(other.assembly.centres[0])
    for each in (one, other):
        weight = sum(block.mass for block in each.assembly.blocks) * 9.81
        assert weight == pytest.approx(2.0, rel=1e-12)
        corners = np.concatenate([block.vertices for block in each.assembly.blocks])
        assert corners.min(axis=0) == pytest.approx([0, 0], abs=1e-12)
        assert corners.max(axis=0) == pytest.approx([2, 1], abs=1e-12)
        assert max(len(block.polygons) for block in each.assembly.blocks) == 1


def test_a_segmental_portal_has_skewbacks_and_buttresses() -> None:
    arch = {"kind": "circular-arch", "left_deg": 60, "right_deg": 45, "voussoirs": 10}
    table = {
        "kind": "portal", "friction": 0.7, "arch": arch, "pier_width": 0.5,
        "foot_width": 0.9, "pier_courses": 3, "pier_height": 2.0,
    }  # fmt: skip
    portal = structure_of(table)
    names = [block.name for block in portal.assembly.blocks]
    assert names[:4] == ["left pier 1", "left pier 2", "left pier 3", "left skewback"]
    assert names[8:] == [str(index + 1) for index in range(10)]
    # Each stands on the one below: a chain of joints with nothing else.
    assert len(portal.assembly.joints) == len(names) + 1
    low = np.min([block.vertices[:, 1].min() for block in portal.assembly.blocks])
    springs = 0.9 * math.cos(math.radians(60)), 0.9 * math.cos(math.radians(45))
    assert low == pytest.approx(springs[0] - 2.0, rel=1e-12)
    left = portal.assembly.blocks[0].vertices
    assert np.ptp(left[left[:, 1] == left[:, 1].min(), 0]) == pytest.approx(0.9, rel=1e-12)
    top = portal.assembly.blocks[2].vertices
    assert np.ptp(top[top[:, 1] == top[:, 1].max(), 0]) == pytest.approx(0.5, rel=1e-12)


def test_origins_are_kept_and_read_back(tmp_path: Path) -> None:
    """With them a problem from a recording can be built otherwise."""
    portal = structure_of(
        {"kind": "portal", "friction": 0.6, "density": 2.0, "pier_width": 0.4}
    )
    simulate(portal, method="direct", duration=0.01).save(tmp_path / "run.npz")
    back = load_recording(tmp_path / "run.npz").problem
    wider = back.but(pier_width=0.8)
    assert wider.maker.pier_width == 0.8  # type: ignore[union-attr]
    assert wider.assembly.blocks[0].mass == pytest.approx(2 * portal.assembly.blocks[0].mass)
    thick = back.but(**{"arch.thickness": 0.3})
    same = structure_of(
        {"kind": "portal", "friction": 0.6, "density": 2.0, "pier_width": 0.4,
         "arch": {"kind": "circular-arch", "thickness": 0.3}}
    )  # fmt: skip
    assert thick.to_dict() == same.to_dict()
    pushed = structure_of(FACTORS["two_spans_load_b6"] | {"friction": 0.7}).with_load(0.3)
    moved = pushed.but(pier_width=0.7)
    assert moved.load == 0.3
    assert moved.to_dict()["live"] == pushed.to_dict()["live"]
    with pytest.raises(InputError, match="leaves 33 blocks"):
        structure_of({"kind": "wall", "friction": 1.0, "length": 1.9}).but(courses=7)


@pytest.mark.parametrize("name", PLANAR)
def test_every_kind_stands_as_it_comes(name: str) -> None:
    """Its defaults are an example; and a structure file of its blocks is the same."""
    problem = structure_of({"kind": name, "friction": 0.7})
    assert equilibrium(problem).exists
    assert problem.title == name
    own = {each.name for each in fields(KINDS[name])} - {each.name for each in fields(Maker)}
    said = {*problem.to_dict(), "kind", "load", "dead", "live", "move", "shake"}
    assert own & said <= {"joints"}
    assert structure_of({**problem.maker.table(), "friction": 0.7}).maker == problem.maker
    again = structure_of(problem.to_dict())
    assert again.assembly.centres == pytest.approx(problem.assembly.centres, abs=1e-12)
    assert len(again.assembly.joints) == len(problem.assembly.joints)


def pointed(**more: object) -> dict[str, Any]:
    return {"kind": "pointed-arch", "friction": 0.6, **more}


def of(kind: str, **more: object) -> dict[str, Any]:
    return {"kind": kind, "friction": 1, **more}


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_is_asked_by_its_name_alone(name: str) -> None:
    assert answered("check", name, "--mu", "0.7", code=None)["problem"]["title"] == name


@pytest.mark.parametrize("thickness", [0.09, 0.15])
def test_an_arch_between_springings_is_known_as_well_as_one_by_its_half_angle(
    thickness: float,
) -> None:
    """The same voussoirs made in two ways: the same answers by every method, up to rounding."""
    one = CircularArch(left_deg=70, right_deg=70, thickness=thickness, friction=0.7)
    other = CircularArch(half_angle_deg=70, eta=thickness, friction=0.7)
    for method in ("limit", "theory", "direct"):
        first, second = (blocksim.check(each, method=method) for each in (one, other))
        assert (first.verdict, first.blocks) == (second.verdict, second.blocks)
        assert (first.arch.mode, first.arch.eta_limit) == (
            second.arch.mode, second.arch.eta_limit,
        )  # fmt: skip
    least = [blocksim.bracket(each, method="limit").high for each in (one, other)]
    assert least[0] == pytest.approx(least[1], rel=1e-14)


OWN_KIND = """\
from dataclasses import dataclass
from blocksim import Body, Made, Maker, metres

@dataclass(frozen=True, kw_only=True)
class Cube(Maker):
    name = "cube"
    side: float = metres(1.0, "side of the cube")

    def made(self, density):
        a = self.side
        bed = [[-a, -a], [2 * a, -a], [2 * a, 0], [-a, 0]]
        cube = [[0, 0], [a, 0], [a, a], [0, a]]
        return Made(bodies=(Body(polygons=(bed,), fixed=True), Body(polygons=(cube,))))
"""


def test_a_kind_of_ones_own_reaches_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A block on a slope slides where its tangent is the friction."""
    (tmp_path / "cubes_of_mine.py").write_text(OWN_KIND)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    own = ("cubes_of_mine:Cube", "--mu", "0.5", "--with", "side=2")
    told = answered("bracket", *own, "--over", "tilt")
    assert told["limit"] == pytest.approx(math.degrees(math.atan(0.5)), rel=1e-9)
    said = refused("check", "cubes_of_mine:Ball", "--mu", "0.5")
    assert said.startswith("blocksim: kind = 'cubes_of_mine:Ball': must be")
