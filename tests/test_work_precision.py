"""The speed-accuracy chart: its fronts, and errors and work that are true."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from arches import least as known
from matplotlib.figure import Figure
from worlds import Simulation

from blocksim import Arch, CircularArch, Verdict
from blocksim.ask.methods import METHODS
from blocksim.cli.studies import chart_table
from blocksim.common.files import json_text
from blocksim.engines import ENGINES
from blocksim.report import tables
from blocksim.report.tables import read_points, write_chart
from blocksim.simulation.motion import QUIET
from blocksim.studies import refinement
from blocksim.studies.chart import Point, front, measure
from blocksim.studies.refinement import REFINEMENTS, let_go, look

SMALL = Arch(half_angle=math.pi / 2, eta=1.0, voussoirs=9), 0.7
SLIDING = Arch(half_angle=math.radians(125), eta=1.0, voussoirs=10), 0.9


def point(method: str, error: float, *seconds: float, knob: str = "tolerance") -> Point:
    return Point(
        case="an arch",
        method=method,
        knob=knob,
        value=1e-3,
        error=error,
        low=None,
        high=None,
        undecided=0,
        work=1 / seconds[0],
        processor_s=seconds,
        wall_s=seconds,
    )


def least(case: tuple[Arch, float], voussoirs: int) -> float:
    return known(case[0].half_angle, case[1], voussoirs).eta_limit


def arch(case: tuple[Arch, float], ratio: float) -> Arch:
    return replace(case[0], eta=ratio * least(case, case[0].voussoirs))


def off_theory(case: tuple[Arch, float], voussoirs: int) -> float:
    continuous = known(case[0].half_angle, case[1]).eta_theory
    return abs(least(case, voussoirs) / continuous - 1)


POINTS = [
    point("pymunk", 1e-2, 1.0),
    point("pymunk", 2e-5, 5.0, 4.0, 90.0),
    point("direct", 1e-7, 4.0),
    point("direct", 1e-9, 9.0),
    point("pybullet", math.inf, 0.1),
]


def test_the_front_is_what_nothing_beats() -> None:
    assert front(POINTS) == [POINTS[0], POINTS[2], POINTS[3]]
    # What took longest has least work.
    assert front(POINTS, "work") == [POINTS[3]]


def fewer(monkeypatch: pytest.MonkeyPatch, knob: str, **values: tuple[float, ...]) -> None:
    """Chart these settings only."""
    chosen = {name: replace(ENGINES[name], chart={knob: each}) for name, each in values.items()}
    monkeypatch.setattr(refinement, "METHODS", {**METHODS, **chosen})


def test_brackets_hold_the_exact_value_and_narrow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fewer(monkeypatch, "tolerance", direct=(1e-2, 1e-7), pymunk=(1e-2, 1e-3))
    points = measure({"small": SMALL}, ["direct", "pymunk"], ["tolerance"])
    assert len(points) == 4
    for each in points:
        # The farther end of a bracket that holds the exact value.
        assert each.value / 8 < each.error <= each.value
        assert len(each.processor_s) == len(each.wall_s) == 3
        assert each.undecided == 0
    made = write_chart(points, tmp_path)
    assert {path.name for path in made} == {"chart.json", "chart.png", "chart.svg"}
    document = json.loads((tmp_path / "chart.json").read_text(), parse_constant=pytest.fail)
    assert len(document["points"]) == len(points)
    assert document["machine"]["python"]
    assert read_points(tmp_path / "chart.json") == points


def test_an_arch_of_n_voussoirs_nears_the_continuous_one_like_one_over_n_squared() -> None:
    """How near depends on where joints fall, too: the worst of neighbouring n is looked at."""
    for case in (SMALL, SLIDING):
        worst = [
            max(off_theory(case, n) for n in range(low, 3 * low // 2)) for low in (20, 40, 80)
        ]
        for coarse, fine in itertools.pairwise(worst):
            assert coarse / fine == pytest.approx(4, rel=0.3)
    points = measure({"small": SMALL}, ["limit"], ["voussoirs"], quick=True)
    assert [p.value for p in points] == [7, 27, 101]
    assert [p.error for p in points] == [off_theory(SMALL, n) for n in (7, 27, 101)]


@pytest.mark.parametrize("method", ["direct", "pymunk"])
def test_work_is_contacts_times_sweeps_times_steps(method: str) -> None:
    """What stands is watched to the end."""
    simulation = Simulation.of(
        CircularArch.of(arch(SMALL, 1.5), SMALL[1]).problem(),
        method,
        settings={"step": 1 / 480, "sweeps": 20},
    )
    seen = let_go(simulation)
    assert seen.verdict is Verdict.STANDS
    assert seen.work == ENGINES[method].contacts * 10 * 20 * QUIET * 480
    held = look(arch(SMALL, 1.5), SMALL[1], method, "tolerance", 1e-2)
    assert held.work % (ENGINES[method].contacts * 10) == 0


@pytest.fixture
def laid_out_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are drawn, but not as pictures, which take long and have been tested above."""

    def laid_out(name: str, figure: Figure) -> dict[str, bytes]:
        figure.draw_without_rendering()
        return {f"{name}.png": b""}

    monkeypatch.setattr(tables, "pictures", laid_out)


@pytest.mark.usefixtures("laid_out_only")
def test_each_knob_is_drawn_and_what_has_no_bracket_too(tmp_path: Path) -> None:
    points = [
        point("pymunk", error, 1.0, 2.0, 3.0, knob=knob)
        for knob in REFINEMENTS
        for error in (math.inf, 1e-2)
    ]
    made = write_chart(points, tmp_path)
    others = {"chart_let_go", "chart_cut_short", "chart_voussoirs"}
    assert {path.stem for path in made} == {"chart", *others}
    document = json.loads((tmp_path / "chart.json").read_text())
    assert [record["error"] for record in document["points"][:2]] == ["inf", 0.01]
    assert set(document["knobs"]) == set(REFINEMENTS)
    assert list(chart_table(points).columns[4].cells) == ["none", "1.0e-02"] * len(REFINEMENTS)


@pytest.mark.usefixtures("laid_out_only")
def test_points_of_another_program_are_drawn_beside(tmp_path: Path) -> None:
    foreign = [point("elsewhere", 1e-3, 2.0), point("elsewhere", math.inf, 1.0)]
    path = tmp_path / "points.json"
    path.write_text(json_text({"points": foreign}))
    assert read_points(path) == foreign
    write_chart([*POINTS, *read_points(path)], tmp_path)
    assert "elsewhere" in (tmp_path / "chart.json").read_text()
