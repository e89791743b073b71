"""Least thickness, and other values at which a kind of structure begins to stand."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from kind_cases import CATENARY, KINDS, LEAST, PIERS
from running import inside as blocksim
from structure_cases import case

from blocksim import (
    InputError,
    Problem,
    Verdict,
    bracket,
    check,
    equilibrium,
    load_recording,
    structure_of,
)


def exact(problem: Problem, over: str) -> float | None:
    return bracket(problem, over=over, method="limit").limit


@pytest.mark.parametrize(
    ("half", "mu", "voussoirs"),
    [
        (90.0, math.inf, 13),
        (90.0, 0.35, 16),
        pytest.param(60.0, 0.9, 10, marks=pytest.mark.long),
        pytest.param(125.0, 0.9, 12, marks=pytest.mark.long),
        (145.0, 1.6, 13),
    ],
)
def test_least_thickness_of_rings_is_exact(half: float, mu: float, voussoirs: int) -> None:
    """The arch's own statics, beside the linear programme, of which they know nothing."""
    friction = "inf" if math.isinf(mu) else mu
    table = {"kind": "circular-arch", "friction": friction, "voussoirs": voussoirs}
    ring = structure_of({**table, "left_deg": half, "right_deg": half, "thickness": 0.3})
    least = exact(ring, "thickness")
    for share, rests in ((1 - 1e-9, False), (1 + 1e-9, True)):
        assert equilibrium(ring.but(thickness=share * least)).exists is rests


def test_vertical_joints_and_the_catenary() -> None:
    """0.1095 (as published), and nothing at all."""
    vertical = structure_of({**LEAST["semicircle_vertical_joints"], "friction": "inf"})
    assert exact(vertical, "thickness") == pytest.approx(0.1095, abs=5e-5)
    chain = bracket(structure_of({**CATENARY, "friction": "inf"}), over="thickness")
    assert chain.limit == 0
    assert chain.low is None
    assert chain.high < 1e-2


def test_other_parameters() -> None:
    """Piers, an overhang (half of the harmonic sum), a column's width on a slope."""
    piers = structure_of({**PIERS["piers_h1_c1"], "friction": 0.7})
    want = case("piers_h1_c1")["expected"]["value"]
    assert exact(piers, "pier_width") == pytest.approx(want, rel=1e-6)
    stack = structure_of({"kind": "stack", "friction": 0.5, "rows": 4, "length": 0.8})
    assert exact(stack, "overhang") == pytest.approx(
        0.4 * (1 + 1 / 2 + 1 / 3 + 1 / 4), rel=1e-9
    )
    assert bracket(stack, over="overhang").stands == "low"
    column = structure_of({"kind": "column", "friction": 0.7}).tilted(math.radians(10))
    assert exact(column, "width") == pytest.approx(3.6 * math.tan(math.radians(10)), rel=1e-9)
    ring = {"kind": "circular-arch", "voussoirs": 9}
    portal = structure_of({"kind": "portal", "friction": 0.7, "pier_width": 1.0, "arch": ring})
    thin = exact(portal, "arch.thickness")
    for share, verdict in ((0.9999, Verdict.COLLAPSES), (1.0001, Verdict.STANDS)):
        built = portal.but(**{"arch.thickness": share * thin})
        assert check(built, method="limit").verdict is verdict


def test_an_island_is_told() -> None:
    """On slender piers a thin arch falls, a thicker one stands, the next pushes them over."""
    arch = {"kind": "circular-arch", "voussoirs": 12}
    portal = structure_of(
        {
            "kind": "portal",
            "friction": 0.7,
            "pier_width": 0.38,
            "pier_height": 4.0,
            "arch": arch,
        }
    )
    stood = [
        check(portal.but(**{"arch.thickness": value}), method="limit").verdict is Verdict.STANDS
        for value in (0.1, 0.15, 0.25, 0.33)
    ]
    assert stood == [False, True, False, True]
    found = bracket(portal, over="arch.thickness")
    assert 0.1 < found.limit < 0.13  # type: ignore[operator]
    assert found.confirmed
    assert "3 changes, as far as 20 values" in found.reason
    assert found.intervals is not None
    first, second = found.intervals
    assert second.high is None
    assert 0.1 < first.low.limit < 0.15 < first.high.limit < 0.25 < second.low.limit < 0.33
    assert first.low.limit == found.limit
    assert first.high.confirmed
    assert second.low.confirmed
    alone = structure_of({"kind": "pointed-arch", "friction": 0.7, "voussoirs": 12})
    assert "the only change, as far as" in bracket(alone, over="thickness").reason


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        ("circular", "normal"),
        ("pointed", "vertical"),
        ("basket-handle", "vertical"),
        *(
            pytest.param(name, joints, marks=pytest.mark.long)
            for name, joints in (
                ("pointed", "normal"),
                ("elliptic", "normal"),
                ("elliptic", "vertical"),
                ("parabolic", "normal"),
                ("parabolic", "vertical"),
                ("basket-handle", "normal"),
            )
        ),
    ],
)
def test_direct_finds_it_again(name: str, joints: str) -> None:
    """On both sides of 0.1 %, by letting them go."""
    table = {"kind": f"{name}-arch", "friction": 1.2, "voussoirs": 12, "joints": joints}
    arch = structure_of(table)
    least = exact(arch, "thickness")
    assert least
    for share, verdict in ((0.999, Verdict.COLLAPSES), (1.001, Verdict.STANDS)):
        built = arch.but(thickness=share * least)
        assert check(built, method="direct").verdict is verdict


def test_what_slips_may_come_to_rest_again() -> None:
    """A semicircle's upright joints slip first: its middle settles, and that is no collapse."""
    table = {"kind": "circular-arch", "friction": 1.2, "voussoirs": 12, "joints": "vertical"}
    arch = structure_of(table)
    least = exact(arch, "thickness")
    assert least
    seen = check(arch.but(thickness=0.999 * least), method="direct")
    assert seen.verdict is Verdict.UNDECIDED
    assert "gave way and came to rest again" in seen.reason
    thicker = arch.but(thickness=1.001 * least)
    assert check(thicker, method="direct").verdict is Verdict.STANDS


def test_names_of_parameters_are_known() -> None:
    wall = structure_of({"kind": "wall", "friction": 0.7})
    with pytest.raises(InputError, match="must be one of load, tilt, lean, mu, spread, push"):
        bracket(wall, over="thickness")
    portal = structure_of({"kind": "portal", "friction": 0.7})
    with pytest.raises(
        InputError, match=r"lean, mu, spread, push, arch\.thickness, arch\.radius, pier_width"
    ):
        bracket(portal, over="thickness")


def test_a_kind_on_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    path.write_text('kind = "pointed-arch"\nfriction = "inf"\nvoussoirs = 60\nradius = 1.25\n')
    done = blocksim("bracket", str(path), "--json")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    want = case("pointed_e0_25")["expected"]["value"]
    assert (found["over"], found["unit"], found["stands"]) == ("thickness", "m", "high")
    assert found["limit"] == pytest.approx(want, rel=1e-7)
    assert found["low"] < found["limit"] < found["high"]
    assert found["confirmed"]
    path = tmp_path / "arch.json"
    table = {"kind": "pointed-arch", "friction": "inf", "voussoirs": 12, "radius": 1.25}
    path.write_text(json.dumps({**table, "thickness": 0.08}))
    done = blocksim("bracket", str(path), "--method", "direct", "--json")
    found = json.loads(done.stdout)
    assert found["confirmed"]
    assert found["low"] < found["limit"] <= found["high"] * (1 + 1e-6)
    assert found["high"] / found["low"] - 1 < 0.006
    done = blocksim("check", str(path), "--json")
    assert done.returncode == 1
    answer = json.loads(done.stdout)
    assert answer["problem"]["title"] == "pointed-arch"
    assert sum(joint["state"].startswith("hinge") for joint in answer["joints"]) >= 4
    run, picture = tmp_path / "run.npz", tmp_path / "picture.svg"
    assert (
        blocksim("simulate", str(path), "--seconds", "0.1", "--out", str(run)).returncode == 0
    )
    assert load_recording(run).problem.maker.radius == 1.25  # type: ignore[union-attr]
    assert blocksim("render", str(path), "--out", str(picture)).returncode == 0
    assert "Pointed arch" in picture.read_text(encoding="utf-8")
    path.write_text(json.dumps({**table, "thickness": 9}))
    done = blocksim("check", str(path))
    assert done.returncode == 2
    assert done.stderr.startswith(f"blocksim: {path}: thickness = 9: must be 1e-06 to ")
    assert done.stderr.count("\n") == 1


def test_a_kind_by_its_name() -> None:
    """The same as the file that says so; parameters of a file can be changed."""
    done = blocksim(
        "bracket", "pointed-arch", "--mu", "inf", "--with", "voussoirs=60",
        "--with", "radius=1.25", "--json",
    )  # fmt: skip
    want = case("pointed_e0_25")["expected"]["value"]
    assert json.loads(done.stdout)["limit"] == pytest.approx(want, rel=1e-7)
    thin = ("portal", "--mu", "0.7", "--with", "pier_width=1", "--with", "arch.thickness=0.1")
    assert blocksim("check", *thin).returncode == 1
    assert blocksim("check", *thin[:-1], "arch.thickness=0.12").returncode == 0
    pushed = ("column", "--mu", "0.9", "--with", 'live=[{"body": [1, 0]}]', "--json")
    factor = json.loads(blocksim("check", *pushed).stdout)["load_factor"]
    assert factor == pytest.approx(1 / 3.6, rel=1e-9)


def test_kinds_are_listed() -> None:
    """With what they are; and of one its parameters, their defaults and ranges."""
    listed = blocksim("kinds").stdout
    assert all(name in listed for name in KINDS)
    rows = blocksim("kinds", "portal").stdout.splitlines()
    width = next(row for row in rows if row.startswith("pier_width"))
    assert "0.6" in width
    assert "1e-06 to 1e+06 m" in width
    assert width.count("pier_width") == 2, "it may be bracketed over"
    courses = next(row for row in rows if row.startswith("pier_courses"))
    assert courses.count("pier_courses") == 1
