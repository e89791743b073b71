"""Span, rise and thickness in, both forms out; nonsense refused in one line."""

import math
from pathlib import Path

import numpy as np
import pytest
from arches import least
from drawn import written
from hypothesis import assume, example, given
from hypothesis import strategies as st
from running import answered, inside

from blocksim import Arch, CircularArch, load

EXACT = 1e-14
SIZE = ("--span", "8", "--rise", "3", "--thickness", "0.45")
ASKED = (*SIZE, "--voussoirs", "31", "--friction-angle", "35")
ALPHA = math.acos(7 / 25)
"""Half-angle of a line of 8 by 3 m: its radius is 25/6 m, and 25/6 - 3 = 7/6."""

OUTWARDS = {"intrados": -0.5, "centreline": 0.0, "extrados": 0.5}
"""How far each line is outside the centreline [thickness]."""
angles = st.floats(math.radians(0.5), math.radians(126))
"""Up to a rise as high as the span: beyond it is given by its angle."""


@given(angles, st.floats(1e-4, 0.999), st.floats(1e-2, 300.0), st.sampled_from([*OUTWARDS]))
@example(2.2, 0.999999, 1.0, "extrados")
@example(2e-3, 0.999999, 7.0, "intrados")
def test_an_arch_is_made_of_what_was_measured(
    half_angle: float, eta: float, radius: float, at: str
) -> None:
    """Span 2 R sin alpha and rise R (1 - cos alpha) of the line of radius R."""
    thickness = eta * radius
    line = radius + OUTWARDS[at] * thickness
    span, rise = 2 * line * math.sin(half_angle), 2 * line * math.sin(half_angle / 2) ** 2
    assume(max(span, rise) < 1000 and min(span, rise, thickness) > 1e-5)
    arch = CircularArch(span=span, rise=rise, thickness=thickness, at=at, friction=1.0).shape
    assert arch.half_angle == pytest.approx(half_angle, rel=EXACT)
    # A small radius is the difference of two lengths.
    assert arch.radius == pytest.approx(radius, rel=EXACT * (1 + thickness / radius))


@pytest.mark.parametrize("degrees", [5, 60, 90, 125, 170])
def test_a_tape_on_the_voussoirs_measures_the_same(degrees: float) -> None:
    """Clear span and rise of the corners that the generator puts there."""
    arch = Arch(half_angle=math.radians(degrees), eta=0.3, voussoirs=8, radius=5.0)
    left, crown, right = (arch.assembly().joints[k].inner for k in (0, 4, 8))
    told = arch.to_dict()
    assert told["span_m"] == pytest.approx(float(np.hypot(*(right - left))), rel=1e-13)
    assert told["rise_m"] == pytest.approx(float(crown[1] - left[1]), rel=1e-13)


def test_an_engineers_arch_in_one_command() -> None:
    told = answered("check", *ASKED)
    radius = 25 / 6 + 0.45 / 2
    expected = {
        "span_m": 8.0,
        "rise_m": 3.0,
        "thickness_m": 0.45,
        "radius_m": radius,
        "half_angle_deg": math.degrees(ALPHA),
        "eta": 0.45 / radius,
        "mu": math.tan(math.radians(35)),
        "friction_angle_deg": 35.0,
        "unit_weight_kN_per_m3": 20.0,
        "depth_m": 1.0,
    }
    arch = told["arch"]
    found = {**arch, **told["problem"]}
    assert {key: found[key] for key in expected} == pytest.approx(expected, rel=EXACT)
    assert (arch["voussoirs"], arch["weight"]) == (31, "sector")
    eta = least(ALPHA, expected["mu"], 31, "sector").eta_limit
    assert arch["eta_limit"] == pytest.approx(eta, rel=1e-12)


@pytest.mark.usefixtures("wide_window")
def test_words_give_both_forms() -> None:
    said = " ".join(inside("check", *ASKED, "--unit-weight", "22").stdout.split())
    assert "alpha 73.7398 deg, eta 0.102467, mu 0.700208, 31 voussoirs" in said
    assert "span 8 m, rise 3 m (intrados), thickness 0.45 m, r 4.39167 m" in said
    assert "unit weight 22 kN/m3, friction angle 35 deg" in said
    outside = inside("check", *ASKED, "--at", "extrados").stdout
    assert "span 8 m, rise 3 m (extrados)" in outside
    # Where nothing was measured there are no metres.
    said = inside("check", "--alpha", "90", "--eta", "0.2", "--mu", "1").stdout
    assert "span 1.8 r, rise 0.9 r (intrados), thickness 0.2 r, friction angle 45 deg" in said


@pytest.mark.parametrize("at", ["intrados", "centreline", "extrados"])
def test_json_has_the_line_that_was_measured(at: str) -> None:
    """Whatever the line was, span and rise were those of the intrados, and did not say so."""
    for asked in (("check", *ASKED), ("bracket", *ASKED)):
        told = answered(*asked, "--at", at)["problem"]
        assert told["at"] == at
        assert [told["span_m"], told["rise_m"]] == pytest.approx([8, 3], rel=EXACT)


def test_a_bracket_answers_in_metres() -> None:
    told = answered("bracket", *ASKED)
    arch = told["arch"]
    assert arch["fixed_line"] == "intrados"
    # The intrados has this radius, whatever thickness was given.
    radius = 25 / 6 + told["limit"] / 2
    assert told["limit"] == pytest.approx(arch["eta_limit"] * radius, rel=EXACT)
    said = inside("bracket", *ASKED).stdout
    assert f"least thickness {told['high']:.6g} m, the intrados staying" in said


def test_without_a_thickness_the_line_that_was_measured_stays() -> None:
    asked = ("--span", "8", "--rise", "3", "--friction-angle", "35", "--voussoirs", "31")
    told = answered("bracket", *asked)
    assert told["arch"]["fixed_line"] == "intrados"
    thickness = told["limit"]
    # On the same intrados an arch of that thickness has that ratio.
    radius = 25 / 6 + thickness / 2
    assert thickness / radius == pytest.approx(told["arch"]["eta_limit"], rel=1e-13)
    at_ratio = answered("check", *asked, "--ratio", "1.5")
    eta = at_ratio["arch"]["eta"]
    assert eta == pytest.approx(1.5 * told["arch"]["eta_limit"], rel=1e-13)
    assert at_ratio["problem"]["span_m"] == pytest.approx(8, rel=EXACT)
    assert at_ratio["problem"]["rise_m"] == pytest.approx(3, rel=EXACT)


def test_a_file_in_metres(tmp_path: Path) -> None:
    path = tmp_path / "bridge.toml"
    path.write_text(
        f"""
        kind = "circular-arch"
        friction = {math.tan(math.radians(35))!r}
        density = 22_000
        voussoirs = 31
        span = 8.0
        rise = 3.0
        thickness = 0.45
        """
    )
    arch = load(path).maker.shape
    assert arch.half_angle == pytest.approx(ALPHA, rel=EXACT)
    assert (arch.weight, arch.specific_weight) == ("sector", 22_000)
    one = answered("check", path)
    two = answered("check", *ASKED, "--unit-weight", "22")
    assert one.pop("problem") == {**two.pop("problem"), "title": "circular-arch"}
    assert {**one, "wall_s": 0} == {**two, "wall_s": 0}
    # One measure given instead of the file's: the others stay.
    told = answered("check", path, "--thickness", "0.6")
    wanted = {"span_m": 8.0, "rise_m": 3.0, "thickness_m": 0.6}
    assert {key: told["problem"][key] for key in wanted} == pytest.approx(wanted, rel=EXACT)
    told = answered("check", path, "--alpha", "90", code=1)
    assert told["arch"]["half_angle_deg"] == 90
    assert told["problem"]["radius_m"] == arch.radius


def test_structures_take_an_angle_of_friction_and_a_unit_weight(tmp_path: Path) -> None:
    def told(*options: str) -> dict[str, object]:
        return answered("check", *options)

    heavy = told("column", "--friction-angle", "35", "--unit-weight", "25")
    light = told("column", "--mu", "0.5")
    assert heavy["problem"]["mu"] == pytest.approx(math.tan(math.radians(35)), rel=EXACT)  # type: ignore[index]
    pairs = zip(heavy["joints"], light["joints"], strict=True)  # type: ignore[call-overload]
    for one, other in pairs:
        assert one["normal_force"] == pytest.approx(25_000 * other["normal_force"], rel=1e-9)
    # In a file of blocks, unless they have weights of their own.
    block = {"id": "b", "vertices": [[0, 0], [2, 0], [2, 1], [0, 1]], "depth": 0.5}
    floor = {"id": "f", "vertices": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True}
    path = written(tmp_path / "block.json", {"friction": 0.5, "blocks": [floor, block]})
    bed = told(str(path), "--unit-weight", "20")["joints"][0]  # type: ignore[index]
    assert bed["normal_force"] == pytest.approx(20_000 * 2 * 0.5, rel=1e-9)


@pytest.mark.parametrize("more", [(), ("--tilt", "0")])
def test_without_a_size_lengths_are_in_radii_and_forces_say_of_which(
    more: tuple[str, ...],
) -> None:
    """Each side bears half of the weight, gamma t alpha r = 20 kN/m3 * 0.12 m * pi/2 m."""
    asked = ("check", "--alpha", "90", "--mu", "0.7", "--eta", "0.12", *more)
    said = inside(*asked).stdout
    assert "thickness 0.12 r" in said
    assert "L = 1 m" not in said
    assert f"left: {20 * 0.12 * math.pi / 2:.4g} kN/m up" in said
    unit = "  unit    no size was given: forces are those of r = 1 m and "
    assert f"{unit}20 kN/m3\n" in said
    assert f"{unit}25 kN/m3\n" in inside(*asked, "--unit-weight", "25").stdout
    assert "  unit " not in inside("check", *ASKED).stdout
