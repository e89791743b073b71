"""The map in numbers, over the friction angle, and for the weight of sectors."""

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arches import least
from derivations import PAPER
from running import answered, csv_rows, inside, ran

from blocksim import Mode, theory
from blocksim.view.linemap import line_map_figure
from blocksim.view.mapfigure import map_figure
from blocksim.view.mapshapes import ANGLE

WEIGHTS = pytest.mark.parametrize(
    "weight", ["centreline", pytest.param("sector", marks=[pytest.mark.long])]
)


@cache
def asked(weight: str) -> dict[str, Any]:
    return answered("map", "--weight", weight)


def test_table_1_is_printed() -> None:
    done = inside("map", "--table")
    rows = {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines() if line}
    for symbol in ("eta", "mu", "alpha", "h", "beta_r", "beta_s"):
        for value, name in zip(rows[symbol], "TSJB", strict=True):
            printed = PAPER["table1"][name][symbol]
            assert float(value) == pytest.approx(printed, rel=1e-13)
    constants = PAPER["constants"]
    for name, symbol in (("alpha_s-beta", "alpha_sbeta"), ("alpha_l", "alpha_l"),
                         ("alpha_L", "alpha_L")):  # fmt: skip
        (line,) = [each for each in done.stdout.splitlines() if each.startswith(f"  {name}  ")]
        assert float(line.split()[1]) == pytest.approx(constants[symbol], rel=1e-13)
    assert f"beta_r {str(constants['beta_sbeta'])[:14]}" in done.stdout
    assert "Sliding is associated" in done.stdout


def test_modes_that_coincide_are_all_told() -> None:
    """Figs 18-20, 24: four modes at T, two at B; at J those of Fig. 20, and a line."""
    marks = {each["name"]: each for each in asked("centreline")["landmarks"]}
    assert {name: set(each["modes"]) for name, each in marks.items()} == {
        "T": {"rrr", "srr", "rrs", "ss"}, "S": {"rrs", "rsr", "ss"}, "J": {"rs", "rsr", "ss"},
        "B": {"rs", "ss"},
    }  # fmt: skip
    for name, each in marks.items():
        assert each["half_angle_deg"] == pytest.approx(
            math.degrees(PAPER["table1"][name]["alpha"]), rel=1e-13
        )
        assert math.tan(math.radians(each["friction_angle_deg"])) == pytest.approx(each["mu"])
    told = answered("check", "fig18_triple_point", code=1)["arch"]
    assert set(told["modes_theory"]) == {"rrr", "srr", "rrs", "ss"}
    assert told["modes_theory"][0] == told["mode_theory"]
    words = "bracket --alpha 145 --mu 1.6 --method theory"
    assert answered(*words.split())["arch"]["modes_theory"] == ["rrs"]


def rows_of(
    eta: float, mu: float, alpha: float, places: dict[str, float], lever: float
) -> dict:
    """Strength conditions at crown, inner joints and shoulder: factors of (h, m), and the rest.

    Written out here: the part from the crown to angle x weighs x, at a distance from the
    vertical through the crown of lever (1 - cos x)/x.
    """

    def resultants(x: float) -> dict[str, np.ndarray]:
        normal = np.array([math.cos(x), 0.0, x * math.sin(x)])
        shear = np.array([math.sin(x), 0.0, -x * math.cos(x)])
        # About the centre of the arch: m less the weight's moment; about the section, less N.
        moment = np.array([0.0, 1.0, lever * (1 - math.cos(x))]) - normal
        return {
            "extrados": moment - eta / 2 * normal, "intrados": -moment - eta / 2 * normal,
            "out": shear - mu * normal, "in": -shear - mu * normal,
        }  # fmt: skip

    return {
        "crown_extrados": resultants(0.0)["extrados"],
        "inner_intrados": resultants(places["beta_r"])["intrados"],
        "inner_slides": resultants(places["beta_s"])["in"],
        "shoulder_extrados": resultants(alpha)["extrados"],
        "shoulder_slides": resultants(alpha)["out"],
    }


@WEIGHTS
def test_rates_fit_together_and_do_no_work(weight: str) -> None:
    """At every point and in every mode, by statics written out here (virtual work)."""
    record = asked(weight)
    points = [
        *record["landmarks"],
        *(each for line in record["lines"].values() for each in line),
    ]
    assert len(points) > 150
    for each in points:
        alpha = math.radians(each["half_angle_deg"])
        places = {
            "beta_r": math.radians(each["beta_r_deg"]),
            "beta_s": math.radians(each["beta_s_deg"] or 0.0),
        }
        lever = 1 + each["eta"] ** 2 / 12 if weight == "sector" else 1.0
        rows = rows_of(each["eta"], each["mu"], alpha, places, lever)
        assert set(each["rates"]) == set(each["modes"])
        for mode, rates in each["rates"].items():
            assert min(rates.values()) >= 0
            hinge = 1.0 if places["beta_r"] == 0 else 2.0
            shares = {"crown_extrados": 1.0, "inner_intrados": hinge, "inner_slides": 2.0,
                      "shoulder_extrados": 2.0, "shoulder_slides": 2.0}  # fmt: skip
            assert sum(shares[key] * rate for key, rate in rates.items()) == pytest.approx(1)
            work = sum(shares[key] * rates[key] * rows[key] for key in rates)
            assert np.abs(work).max() < 2e-6 * (1 + each["mu"]), (each["name"], mode)
            slides = {key for key, rate in rates.items() if "slides" in key and rate > 0}
            assert len(slides) == mode.count("s")


@WEIGHTS
def test_lines_divide_the_regions(weight: str) -> None:
    """With 400 voussoirs, by exact statics: a thousandth of friction to both sides."""
    lines = asked(weight)["lines"]
    assert list(lines) == ["divide", "first sliding", "equal angles", "crown hinge"]
    sides = {
        "first sliding": ({Mode.RRR}, {Mode.SRR, Mode.RRS}),
        "divide": ({Mode.SRR, Mode.RRS, Mode.RS}, {Mode.SS}),
    }
    for line, (right, left) in sides.items():
        for each in lines[line][8:-6:6]:
            alpha = math.radians(each["half_angle_deg"])
            for share, modes in ((1.01, right), (0.985, left)):
                built = least(alpha, each["mu"] * share, 400, weight)
                assert built.mode_limit in modes, (line, each)
                if modes == {Mode.RRR}:
                    # Without sliding friction is of no account.
                    assert built.eta_limit == pytest.approx(each["eta"], rel=2e-3)
    for line in ("equal angles", "crown hinge"):
        for each in lines[line]:
            close = {"equal angles": each["beta_s_deg"], "crown hinge": 0.0}[line]
            assert each["beta_r_deg"] == pytest.approx(close, abs=1e-3)


@WEIGHTS
def test_the_numbers_are_a_csv_file(weight: str, tmp_path: Path) -> None:
    out = tmp_path / "map.csv"
    ran("map", "--weight", weight, "--out", out)
    rows = csv_rows(out)
    record = asked(weight)
    points = [*record["landmarks"], *record["special_angles"],
              *(each for line in record["lines"].values() for each in line)]  # fmt: skip
    told = [(each["name"], mode, each["eta"]) for each in points for mode in each["modes"]]
    assert [(row["name"], row["mode"], float(row["eta"])) for row in rows] == told
    assert {row["weight"] for row in rows} == {weight}


@WEIGHTS
def test_over_the_friction_angle(weight: str) -> None:
    """Landmarks at arctan mu; unbounded friction, where r is, at 90 degrees."""
    axes = map_figure(weight=weight, friction=ANGLE).axes[0]
    assert axes.get_xlim() == (0, 90)
    assert axes.get_xlabel().startswith("friction angle")
    marks = {text.get_text(): text.xy for text in axes.texts if text.get_text() in set("TSJB")}
    for name, mark in theory.landmarks(weight).items():
        assert marks[name] == pytest.approx((math.degrees(math.atan(mark.mu)), mark.eta))
    if weight == "centreline":
        # The paper's 54.8 and 60.6 degrees.
        assert marks["T"][0] == pytest.approx(54.8, abs=0.05)
        assert marks["J"][0] == pytest.approx(60.6, abs=0.05)
    (end,) = [line for line in axes.lines if line.get_gid() == "region-r"]
    assert set(end.get_xdata()) == {90}
    lowest = {"centreline": 1.0, "sector": 6 * (math.sqrt(4 / 3) - 1)}[weight]
    assert tuple(end.get_ydata()) == pytest.approx((lowest, 2))
    lines = line_map_figure((0.0, 2.0), weight, ANGLE).axes[0]
    drawn = {line.get_gid(): line for line in lines.lines}
    flat = np.asarray(drawn["feasible 90°"].get_xdata())
    assert flat.max() == pytest.approx(90, abs=0.2)
    assert list(drawn["asymptote"].get_ydata()) == pytest.approx([lowest, lowest])


def test_the_sector_map_is_another_one() -> None:
    """T and B where the study of the sector weight has them, and so the regions' corners."""
    axes = map_figure(weight="sector", central=True).axes[0]
    marks = {text.get_text(): text.xy for text in axes.texts if text.get_text() in set("TSJ")}
    assert marks["T"] == pytest.approx((1.27702136, 0.61831824), abs=1e-8)
    assert "sector" in axes.get_title(loc="left")
    fills = {str(each.get_gid()): each.get_paths()[0] for each in axes.collections}
    assert fills["region-rs"].contains_point((1.9, 1.0))
    # The same point for the centreline is in ss | rs at another friction.
    other = {
        str(each.get_gid()): each.get_paths()[0]
        for each in map_figure(central=True).axes[0].collections
    }
    assert other["region-ss"].contains_point((1.7, 1.0))
    assert fills["region-rs"].contains_point((1.7, 1.0))
