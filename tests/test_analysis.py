"""Every study runs, and its headline numbers hold."""

import csv
import gzip
import itertools
import json
import math
import re
from collections import Counter
from importlib import import_module
from pathlib import Path
from types import ModuleType

import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest
from arches import least
from running import csv_rows
from scipy.spatial.transform import Rotation
from worlds import Quality, Simulation

import blocksim
from blocksim import Arch, CircularArch

STUDIES = Path(__file__).parent.parent / "analysis"


def study(name: str) -> ModuleType:
    """Import a study from the checkout; studies are no part of the package."""
    return import_module(f"analysis.{name}")


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.py")), ids=lambda path: path.stem)
def test_every_study_finds_what_it_takes_from_blocksim(path: Path) -> None:
    """Those that are long are run with `-m long`; a name that has gone is seen at once."""
    assert study(path.stem)


@pytest.mark.long
def test_pictures_of_pages_are_drawn_again_by_one_command(tmp_path: Path) -> None:
    """Each goes to its own place; the drawing by a command is the one that is committed."""
    made = study("pictures").main(tmp_path, quick=True)
    assert made[:2] == ["docs/sketch.svg", "docs/arch.svg"]
    assert made[2].startswith("docs/examples/")
    assert made[3] == "analysis/figures/onset_modes_direct.png"
    root = STUDIES.parent
    for each in made:
        assert (root / each).exists()
        assert (tmp_path / each).stat().st_size > 1000
    # What is drawn, by name: places may differ in their last digits.
    drawn = [(place / made[1]).read_text(encoding="utf-8") for place in (root, tmp_path)]
    words = [re.findall(r'id="([a-z]+-[a-z0-9-]+)"', each) for each in drawn]
    assert words[0]
    assert words[0] == words[1]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        *((f"rows{end} --quick", "rows True None") for end in ("", "/", "//")),
        ("rows --engines direct --engines pymunk", "rows False ['direct', 'pymunk']"),
    ],
)
def test_what_a_study_takes_are_its_options(
    given: str, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def main(out: Path, *, quick: bool = False, engines: list[str] | None = None) -> list:
        """Tell what was asked."""
        return [out, quick, engines]

    monkeypatch.setattr("sys.argv", ["study", *given.split()])
    with pytest.raises(SystemExit) as ended:
        study("command").run(main, lambda told: " ".join(map(str, told)))
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"{said}\n"


@pytest.mark.long
def test_streams_are_answered_as_other_programmes_say(tmp_path: Path) -> None:
    rows = study("streams").main(tmp_path, quick=True)
    assert [row["kind"] for row in rows] == ["stacks", "towers"]
    for row in rows:
        assert row["scenes"] == row["stands"] + row["collapses"] == 60
        assert (row["held"], row["false"]) == (20, 0)
        assert min(row["stands"], row["collapses"]) > 10


def test_cases_in_space_are_asked_once(tmp_path: Path) -> None:
    """Two small ones, by limit analysis; what is on disk is not asked again."""
    for _ in range(2):
        told = study("space_cases").main(tmp_path, quick=True, method="limit")
        assert "| limit | 1.0% | 3 | 0 | 0 |" in told
    with gzip.open(tmp_path / "space_cases.csv.gz", "rt", newline="") as file:
        assert len(list(csv.DictReader(file))) == 5


def test_an_arch_is_asked_beside_another_program(tmp_path: Path) -> None:
    told = study("beside_cra").main(tmp_path, quick=True)
    assert "| arch, 15 | +1% | limit | stands |" in told
    assert "| arch, 15 | -1% | limit | collapses |" in told


@pytest.mark.long
def test_random_assemblies_are_enclosed(tmp_path: Path) -> None:
    """One of each family: cut, leaning, a vault."""
    told = study("random_space").main(tmp_path, quick=True)
    assert "| factor | 3 | 0 | 0 |" in told
    assert "| above | 3 | 0 | 0 |" in told
    assert "| area | 2 | 0 | 0 |" in told


@pytest.mark.long
def test_domes_are_bracketed_and_drawn(tmp_path: Path) -> None:
    """Where it turns a lune of any width carries itself; where it slides it needs more."""
    rows = {
        (each["lunes"], each["mu"]): each["least"]
        for each in study("dome_map").main(tmp_path, quick=True)
    }
    assert rows[4, 0.7] == pytest.approx(rows[8, 0.7], rel=1e-6)
    assert rows[4, 0.25] > rows[4, 0.7]
    assert (tmp_path / "dome_map.png").stat().st_size > 0


@pytest.mark.long
def test_pulses_overturn_a_block_where_housner_says(tmp_path: Path) -> None:
    module = study("shaking")
    result = module.main(tmp_path, quick=True)
    assert result.worst < 0.01
    for row in result.maps["block"]:
        falls = row["amplitude_g"] > module.overturning(row["duration_s"])
        assert row["verdict"] == ("collapses" if falls else "stands"), row
    arch = {(row["amplitude_g"], row["duration_s"]): row for row in result.maps["arch"]}
    assert [arch[each]["verdict"] for each in ((0.2, 1.0), (2.0, 1.0))] == [
        "stands",
        "collapses",
    ]
    told = csv_rows(tmp_path / "shaking_map.csv")
    assert [row["structure"] for row in told] == ["block"] * 4 + ["arch"] * 4
    assert {len(row["code"]) for row in told} == {12}
    # Below the acceleration of its static limit the arch does not move.
    assert all(arch[0.2, long]["largest_rotation_deg"] < 1e-9 for long in (0.1, 1.0))


@pytest.mark.long
def test_random_problems_are_answered_as_is_proved(tmp_path: Path) -> None:
    module = study("random_truth")
    result = module.main(tmp_path, quick=True)
    assert result.problems == len(module.QUICK) == 7
    assert result.unproved == result.unexpected == 0
    for method in ("limit", "direct", "pymunk"):
        told = result.told[method]
        assert (told["right"], told["false"], told["open"]) == (7, 0, 0)
    ways = ["after others", "mirrored", "renumbered", "hash seed 1, threads 1", "fresh process"]
    assert list(result.same) == ways
    assert all(same == of > 0 for same, of in result.same.values())
    with gzip.open(tmp_path / "random_truth.csv.gz", "rt", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["proved"] for row in rows} == {"stands", "collapses"}
    kinds = {row["kind"] for row in rows}
    assert {"arch of the map", "rubble"} < kinds
    assert any(kind.startswith("random") for kind in kinds)


@pytest.mark.long
def test_arches_on_spreading_supports(tmp_path: Path) -> None:
    module = study("spreading")
    result = module.main(tmp_path, quick=True)
    assert result.worst_known < 1e-6
    assert result.worst_direct < 0.01
    assert [row.arch for row in result.rows] == ["t/r 0.12", "friction 0.5"]
    assert all(
        row.low < row.limit * 1.005 and row.high > row.limit * 0.995 for row in result.rows
    )
    values = [value for _, value in result.curve]
    assert values == sorted(values)
    assert len(values) == 3
    assert [row["known"] for row in csv_rows(tmp_path / "spreading.csv")][1] == ""


def test_every_study_is_listed_with_its_claim() -> None:
    listed = (STUDIES / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in STUDIES.glob("*.py") if path.name not in listed] == []


@pytest.mark.long
def test_modes_at_the_onset_are_those_of_limit_analysis(tmp_path: Path) -> None:
    assert len(study("onset_modes").main(tmp_path, quick=True)) == 14
    rows = csv_rows(tmp_path / "onset_modes_direct.csv")
    assert [row["mode"] for row in rows] == [row["mode_limit"] for row in rows]
    assert "rsr" in {row["mode"] for row in rows}
    assert {row["verdict"] for row in rows} == {"collapses"}
    assert Counter(row["drawn"] for row in rows) == {"map": 10, "rsr": 2, "S": 1, "J": 1}


def test_arches_of_the_map_are_drawn_the_same_again_and_near_critical() -> None:
    draw = study("onset_modes").draw
    drawn = list(itertools.islice(draw(), 40))
    assert drawn[:20] == list(itertools.islice(draw(), 20))
    critical = [each for each in drawn if each.eta is None]
    modes = Counter(least(math.radians(each.alpha_deg), each.mu).mode for each in critical)
    assert min(modes[mode] for mode in ("srr", "rrs", "rsr", "rs")) >= 4
    assert len(drawn) - len(critical) == 4
    for each in drawn:
        half_angle = math.radians(each.alpha_deg)
        if each.eta is None:
            assert least(half_angle, each.mu).eta_theory is not None
        else:
            arch = Arch(half_angle=half_angle, eta=each.eta, voussoirs=each.voussoirs)
            for share, verdict in ((1.001, "stands"), (0.999, "collapses")):
                asked = CircularArch.of(arch, share * each.mu)
                assert blocksim.check(asked, method="limit").verdict == verdict


@pytest.mark.long
def test_costs_are_measured_and_answers_right(tmp_path: Path) -> None:
    costs = study("costs").main(tmp_path, quick=True)
    assert [cost.method for cost in costs] == ["theory"] * 2 + ["limit"] * 2 + ["direct"] * 3
    for cost in costs:
        assert 0 <= cost.median_s <= cost.longest_s
        assert cost.error <= 5e-4
    assert costs[-1].error <= 5e-9
    rows = csv_rows(tmp_path / "costs.csv")
    assert [row["method"] for row in rows] == [cost.method for cost in costs]
    assert {len(row["code"]) for row in rows} == {12}
    assert {row["version"] for row in rows} == {blocksim.__version__}
    assert all(row["date"] and row["machine"] for row in rows)


def test_structures_with_known_answers_are_answered_right(tmp_path: Path) -> None:
    study_of = study("structure_cases")
    found = study_of.main(tmp_path, quick=True)
    assert len(found) == 11
    assert max(row["error"] for row in found) < 1e-6
    assert study_of.counted(found) == {"right": 19}
    rows = csv_rows(tmp_path / "structure_cases.csv")
    assert [row["case"] for row in rows] == [row["case"] for row in found]
    assert "0 false, 0 undecided" in study_of.table(found)


def test_overlap_of_rubble_would_be_seen() -> None:
    """Two cubes, one pushed into the other by a tenth, turned in space together."""
    module = study("rubble")
    square = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    cube = module.Prism.of(square, 1.0)
    for push, deep in ((0.9, 0.1), (1.1, 0.0)):
        one, other = np.zeros(6), np.zeros(6)
        one[[4, 5, 2]] = other[[4, 5, 2]] = 0.3, -0.5, 0.7
        turned = Rotation.from_rotvec([0.3, -0.5, 0.7]).apply([push, 0.1, 0.2])
        other[[0, 1, 3]] = turned
        found = module.overlap_of(cube.at(one), cube.at(other), 0.0)
        assert found == pytest.approx(deep, abs=1e-12)
        reach = module.reach(cube.at(one), cube.at(other))
        assert reach == pytest.approx(1 - push, abs=1e-12)


def test_what_is_thrown_would_be_seen() -> None:
    """The uppermost block of a stack flies up by v^2/2, and no energy is there for it.

    What it carries with it is not thrown. The energy is seen for both.
    """
    module = study("rubble")
    problem = module.drawn(module.cases(5)[4])
    centres = problem.assembly.centres / problem.assembly.size
    start = np.column_stack([centres, np.zeros(len(centres))])
    order, speed, sinks = np.argsort(-centres[:, 1]), 0.5, 0.1
    times = np.linspace(0.0, 2 * speed, 101)
    masses = problem.assembly.masses[:, 0]
    for blocks, thrown in ((order[:1], speed**2 / 2), (order[:2], 0.0)):
        poses = np.repeat(start[None], len(times), axis=0)
        poses[:, blocks, 1] += (speed * times - times**2 / 2)[:, None]
        # Something has to fall: the lowest sinks into what it stands on.
        poses[:, order[-1], 1] -= sinks * times
        recording = Simulation.of(problem, "direct").record(times.tolist(), [*poses], Quality())
        found = module.measured(recording)
        assert found["thrown"] == pytest.approx(thrown, rel=0.02)
        assert found["rise"] == pytest.approx(speed**2 / 2, rel=1e-3)
        low = masses[order[-1]]
        given = (masses[blocks].sum() * speed**2 + low * sinks**2) / 2
        assert found["gain"] == pytest.approx(given / (low * sinks * times[-1]), rel=0.02)


@pytest.mark.long
def test_the_gallery_shows_what_stands_and_falls(tmp_path: Path) -> None:
    module = study("gallery")
    seen = module.main(tmp_path, quick=True)
    assert [each.name for each in seen] == ["oppenheim_7", "gable"]
    for each in seen:
        assert each.verdicts == ("stands", "collapses")
        assert each.fall.displacement.max() > 0.3
        assert (each.fall.quality.penetration or 0) < 0.01
        assert (each.fall.quality.gain or 0) < 1e-3
    assert (tmp_path / "gallery.png").stat().st_size > 0


@pytest.mark.long
def test_one_arch_falls_alike_side_by_side(tmp_path: Path) -> None:
    module = study("four_engines")
    runs = module.main(tmp_path, quick=True)
    assert list(runs) == ["direct", "pymunk"]
    fallen = []
    for run in runs.values():
        assert run.times[-1] < 15
        # Before blocks hit the ground: the crown is lower, and one half mirrors the other.
        way = run.poses[int(np.searchsorted(run.times, 2.0))] - run.poses[0]
        fallen.append(-way[7, 1])
        assert np.abs(way[:, :2] - way[::-1, :2] * (-1, 1)).max() < 3e-3
    assert fallen[0] == pytest.approx(fallen[1], rel=0.05)
    assert 0.5 < fallen[0] < 1
    assert (tmp_path / "engines.png").stat().st_size > 0


def test_engines_are_filmed_where_they_are_wrong(tmp_path: Path) -> None:
    found = study("referee_films").main(tmp_path, quick=True)
    page = (STUDIES.parent / "docs" / "guide" / "suite.md").read_text("utf-8")
    assert all((each["bounds_moved"] > 1) == (each["truth"] == "stands") for each in found)
    assert [each["film"] for each in found if f"figures/{each['film']}" not in page] == []
    assert (tmp_path / found[0]["film"]).with_suffix(".png").stat().st_size > 0


def test_referee_makes_its_table_of_the_rows_that_are_kept(tmp_path: Path) -> None:
    study("referee").main(tmp_path, quick=True)
    kept = STUDIES.parent / "scenarios" / "suite" / "known.json"
    assert json.loads((tmp_path / "known.json").read_text()) == json.loads(kept.read_text())
    assert matplotlib.image.imread(tmp_path / "referee.png").shape[1] > 1000
