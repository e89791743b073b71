"""Sweeps ask what they are told to, answer as the single questions do, and lose no row."""

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from pathlib import Path

import pytest
from running import answered, csv_rows, ran, refused
from sweeps import GRID, SIMULATED, Rows, design_of, rows_of, swept, written

from blocksim import (
    CircularArch,
    InputError,
    MissingPart,
    Problem,
    bracket,
    check,
    check_many,
    read_rows,
    sweep,
    to_pandas,
    write_csv,
    write_parquet,
)  # fmt: skip
from blocksim.sweeps import answers, run
from blocksim.sweeps import table as tables
from blocksim.sweeps.answers import Answered, Asked, answer
from blocksim.sweeps.case import Case

DIRECT = 'half_angle_deg = 90\nmu = 0.7\nratio = 0.999\nmethod = "direct"\n[settings]\n'
PYMUNK = DIRECT.replace("direct", "pymunk")


def test_a_random_design_is_the_same_again_and_can_grow(tmp_path: Path) -> None:
    few = list(design_of(tmp_path, SIMULATED).cases())
    assert few == list(design_of(tmp_path, SIMULATED).cases())
    more = list(design_of(tmp_path, SIMULATED.replace("count = 20", "count = 5000")).cases())
    assert more[: len(few)] == few
    assert len(more) == 10_000
    assert few != list(design_of(tmp_path, SIMULATED.replace("seed = 7", "seed = 8")).cases())
    given = [dict(case.given) for case in more]
    assert all(60 <= each["half_angle_deg"] <= 150 and 0.4 <= each["mu"] <= 2 for each in given)
    # Even over the whole numbers, ends included: 833 of each in 5000, +-5 standard errors.
    counts = Counter(each["voussoirs"] for each in given)
    assert sorted(counts) == [7, 8, 9, 10, 11, 12]
    assert all(abs(count / 2 - 833) < 132 for count in counts.values())
    # Log-uniform: half of the draws lie below the geometric mean.
    below = sum(each["mu"] < math.sqrt(0.8) for each in given) / len(more)
    assert abs(below - 0.5) < 0.036


@pytest.mark.usefixtures("wide_window")
@pytest.mark.usefixtures("in_this_process")
def test_the_command_keeps_the_contract(tmp_path: Path) -> None:
    refused(*written(tmp_path, GRID.replace("0.1]", "3]")))
    assert not (tmp_path / "out").exists()
    asked = written(tmp_path, GRID)
    done = refused(*asked, "--scheduler", "nonsense")
    assert "--scheduler = 'nonsense': must be the address of a dask scheduler" in done
    summary = answered(*asked, "--workers", "1")
    assert (summary["cases"], summary["rows"], summary["failed"]) == (192, 192, 0)
    done = ran(*asked, "--workers", "1")
    assert "has a row for each of 192 cases; 192 were there before" in done


def maker_of(row: dict[str, object], **more: object) -> CircularArch:
    """The arch that a row is of."""
    given = {name: row[name] for name in ("half_angle_deg", "voussoirs", "weight")}
    return CircularArch(**given, friction=float(str(row["mu"])), **more)


def test_statics_in_bulk_answer_as_single_questions_do(tmp_path: Path) -> None:
    swept(GRID, tmp_path)
    rows = rows_of(tmp_path).values()
    assert {row["verdict"] for row in rows} == {"stands", "collapses"}
    for row in rows:
        single = check(maker_of(row, eta=row["eta"]), method=str(row["asked"]))
        assert row["verdict"] == single.verdict
        least = row["eta_theory"]
        assert (least is None) == (single.arch.eta_theory is None)
        assert least is None or math.isclose(least, single.arch.eta_theory, rel_tol=1e-12)
        if row["asked"] == "theory":
            assert row["mode"] == single.arch.mode


def test_without_a_thickness_the_least_one_is_asked_for(tmp_path: Path) -> None:
    text = GRID.replace("eta = [0.05, 0.1]", "").replace('"limit"', '"limit", "auto"')
    swept(text, tmp_path)
    for row in rows_of(tmp_path).values():
        single = bracket(maker_of(row), method=str(row["asked"])).arch
        for end, exact in (("eta_low", single.eta_low), ("eta_high", single.eta_high)):
            assert (row[end] is None) == (exact is None)
            assert exact is None or math.isclose(float(str(row[end])), exact, rel_tol=1e-9)


def test_engines_simulate_within_the_band_only_or_wherever_asked(tmp_path: Path) -> None:
    near = "half_angle_deg = 90\nmu = 0.7\nvoussoirs = 9\n"
    near += "ratio = [0.5, 0.97, 0.995, 1.005, 1.03]\n"
    widths = {"band = 0.01": 2, "band = 0.04": 4, "band = inf": 5, "": 5}
    for text, simulated in widths.items():
        folder = tmp_path / (text or "none")
        folder.mkdir()
        done = swept(f'{near}{text}\nmethod = "direct"', folder)
        assert done.tally.simulated == simulated
        assert done.tally.spared == 5 - simulated
        assert (done.saved_s or 0) == pytest.approx(
            done.tally.spared * done.tally.simulated_s / simulated
        )
        for row in rows_of(folder).values():
            stands = float(str(row["ratio"])) > 1
            assert row["verdict"] == ("stands" if stands else "collapses")
    done = swept(near.replace("[", "[0.9995, "), tmp_path)
    assert (done.tally.simulated, done.tally.spared) == (1, 5)
    methods = {row["ratio"]: row["method"] for row in read_rows(tmp_path)}
    assert [each for each, method in methods.items() if method == "direct"] == [0.9995]


def test_settings_are_axes_like_any_other_and_part_of_the_question(tmp_path: Path) -> None:
    text = PYMUNK.replace('"pymunk"', '["limit", "pymunk", "direct"]')
    text += "hold_sweeps = [100, 1_000_000]\nstep = 0.005\n"
    done = swept(text, tmp_path)
    # `limit` is run with none of them, and `direct` with no sweeps: asked once each.
    assert (done.cases, done.tally.rows) == (4, 4)
    rows = rows_of(tmp_path).values()
    seen = {(row["asked"], json.dumps(row["settings"])): row["verdict"] for row in rows}
    assert seen == {
        ("limit", "null"): "collapses",
        ("direct", '{"step": 0.005}'): "collapses",
        ("pymunk", '{"step": 0.005, "hold_sweeps": 100}'): "undecided",
        ("pymunk", '{"step": 0.005, "hold_sweeps": 1000000}'): "collapses",
    }
    drawn = f"{PYMUNK}sweeps = {{ low = 10, high = 12 }}\n[random]\ncount = 200\nseed = 1"
    given = Counter(case.settings for case in design_of(tmp_path, drawn).cases())
    assert set(given) == {(("sweeps", sweeps),) for sweeps in (10, 11, 12)}
    assert min(given.values()) > 40


def test_an_arch_is_a_kind_like_any_other(tmp_path: Path) -> None:
    """By angle, by what is measured, on a slope, over any parameter: as a single question."""
    arch = {"voussoirs": 9, "mu": 0.7, "method": "limit"}
    sized = {"span": 8, "rise": [2, 3], "thickness": 0.25, "at": "intrados"}
    ring = {"half_angle_deg": [60, 90], "eta": 0.12}
    designs = (
        {"kind": "circular-arch", **sized, **arch},
        {**ring, "tilt_deg": [0, 4], **arch},
        {**ring, "over": "tilt", **arch},
        {"half_angle_deg": 90, "over": "thickness", **arch},
    )
    for design in designs:
        swept(design, tmp_path)
    rows = list(rows_of(tmp_path).values())
    assert len(rows) == 2 + 4 + 2 + 1
    for row in rows:
        assert row["error"] is None
        names = ("half_angle_deg", "eta") if row["parameters"] is None else ()
        given = {name: row[name] for name in names if row[name]} | (row["parameters"] or {})
        weight = "centreline" if names else "curved"
        maker = CircularArch(**given, voussoirs=9, friction=0.7, weight=weight)
        problem = maker.problem().tilted(math.radians(row["tilt_deg"] or 0.0))
        if row["over"] is None:
            seen = check(problem, method="limit")
            assert (row["verdict"], row["load_factor"]) == (seen.verdict, seen.load_factor)
            assert row["half_angle_deg"] == pytest.approx(math.degrees(maker.half_angle))
            if seen.arch is not None:
                assert row["eta"] == seen.arch.shape.eta
        else:
            found = bracket(problem, over=row["over"], method="limit")
            assert row["unit"] == found.unit
            assert row["limit"] == pytest.approx(found.limit, rel=1e-9)
            assert row["low"] == pytest.approx(found.low, rel=1e-9)
    assert {row["verdict"] for row in rows if row["tilt_deg"]} == {"stands", "collapses"}


def test_rows_of_earlier_versions_go_into_the_same_table(tmp_path: Path) -> None:
    old = {"id": "0" * 24, "half_angle_deg": 90.0, "mu": "inf", "verdict": "stands"}
    (tmp_path / "rows-old.jsonl").write_text(json.dumps(old) + "\n")
    swept(KINDS_GRID, tmp_path)
    write_csv(tmp_path, tmp_path / "rows.csv")
    held = {row["id"]: row for row in csv_rows(tmp_path / "rows.csv")}
    assert len(held) == 25
    assert held[str(old["id"])]["half_angle_deg"] == "90.0"
    assert sum(row["pier_width_m"] != "" for row in held.values()) == 24


def test_a_bracket_may_do_without_moving_runs(tmp_path: Path) -> None:
    text = (
        'half_angle_deg = 90\nmu = 0.7\nvoussoirs = 9\nmethod = ["limit", "direct"]\nconfirm = '
    )
    for confirm in ("true", "false"):
        swept(text + confirm, tmp_path)
    rows = rows_of(tmp_path).values()
    assert [row["confirmed"] for row in rows if row["asked"] == "limit"] == [None]
    assert {row["confirmed"] for row in rows if row["asked"] == "direct"} == {True, None}
    assert {row["mode"] for row in rows if row["asked"] == "direct"} == {"rrr"}


def test_a_failing_case_becomes_a_row_that_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(problem: Problem, **_: object) -> None:
        raise RuntimeError(f"out of\nluck with {len(problem.assembly.blocks)}")

    monkeypatch.setattr(answers, "check", fails)
    text = 'half_angle_deg = 90\nmu = [0.1, 0.7]\nratio = [1, 60]\nmethod = ["limit", "direct"]'
    done = swept(text, tmp_path)
    errors = {
        (row["mu"], row["ratio"], row["asked"]): row["error"]
        for row in rows_of(tmp_path).values()
    }
    assert len(errors) == 8
    assert done.tally.failed == 7
    assert errors[0.7, 1.0, "limit"] is None
    assert errors[0.7, 1.0, "direct"] == "RuntimeError: out of luck with 27"
    assert "must be above 0 and at most 2" in str(errors[0.7, 60.0, "limit"])
    assert "no thickness up to eta = 2 stands" in str(errors[0.1, 1.0, "limit"])


class Fragile(Executor):
    """Processes, as far as a sweep can tell, of which a poisonous case breaks all."""

    def __init__(self, poison: Callable[[Case], bool], error: type[Exception]) -> None:
        self._poison = poison
        self._error = error

    def submit(
        self, fn: Callable[..., Answered], /, *args: Sequence[Asked], **_: object
    ) -> Future[Answered]:
        future: Future[Answered] = Future()
        if any(self._poison(each.case) for each in args[0]):
            future.set_exception(self._error("died"))
        else:
            future.set_result(fn(*args))
        return future


@pytest.mark.parametrize("error", [BrokenExecutor, MemoryError])
def test_a_case_that_kills_its_process_becomes_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
) -> None:
    def poison(case: Case) -> bool:
        given = dict(case.given)
        return (given["mu"], given["voussoirs"], given["half_angle_deg"]) == (0.9, 12, 90)

    made: list[Executor] = []

    def processes(*_: object, **_others: object) -> Executor:
        made.append(Fragile(poison, error))
        return made[-1]

    monkeypatch.setattr("blocksim.common.processes.ProcessPoolExecutor", processes)
    done = sweep(design_of(tmp_path, GRID), tmp_path)
    rows = rows_of(tmp_path)
    lost = [row for row in rows.values() if row["error"] is not None]
    assert len(rows) == 192
    assert done.tally.failed == len(lost) == 8
    assert all(
        (row["mu"], row["voussoirs"], row["half_angle_deg"]) == (0.9, 12, 90) for row in lost
    )
    assert (len(made) > 1) == (error is BrokenExecutor)


def test_an_executor_that_breaks_is_not_ours_to_replace(tmp_path: Path) -> None:
    design = design_of(tmp_path, GRID)
    with pytest.raises(BrokenExecutor):
        sweep(
            design,
            tmp_path,
            executor=Fragile(lambda case: dict(case.given)["mu"] > 1, BrokenExecutor),
        )
    assert swept(design, tmp_path).cases == 192


def test_chunks_change_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, uninterrupted: Rows
) -> None:
    monkeypatch.setattr(run, "LARGEST_CHUNK", 7)
    swept(SIMULATED, tmp_path, in_flight=1)
    assert rows_of(tmp_path) == uninterrupted


def test_what_occurs_twice_is_asked_once_and_a_larger_design_reuses_rows(
    tmp_path: Path,
) -> None:
    done = swept(GRID.replace("0.5, 0.9", "0.5, 0.5, 0.9"), tmp_path)
    assert (done.cases, done.tally.rows) == (192, 192)
    done = swept(GRID.replace("0.5, 0.9", "0.5, 0.7, 0.9"), tmp_path)
    assert (done.cases, done.found, done.tally.rows) == (256, 192, 64)


def test_a_parquet_table_holds_the_same_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(tables, "ROWS_AT_ONCE", 50)
    out = tmp_path / "out"
    given = f"{PYMUNK}hold_sweeps = 1000"
    for text in (GRID, given, GRID.replace("eta = [0.05, 0.1]", "ratio = [0.9, 60.0]")):
        swept(design_of(tmp_path, text), out)
    write_parquet(out, out / "rows.parquet")
    rows = list(read_rows(out))
    table = parquet.read_table(out / "rows.parquet").to_pylist()
    assert len(table) == len(rows) == 192 + 1 + 192
    for row, held in zip(rows, table, strict=True):
        assert row.pop("parameters") is None
        settings = {name: held.pop(name) for name in list(held) if name.startswith("settings.")}
        given = {f"settings.{name}": each for name, each in (row.pop("settings") or {}).items()}
        assert {name: each for name, each in settings.items() if each is not None} == given
        assert list(held) == list(row)
        assert held == {**row, "mu": float(str(row["mu"]))}


KINDS_GRID = """
kind = "portal"
pier_width = { low = 0.3, high = 1, steps = 3 }
arch = { kind = "circular-arch", voussoirs = [6, 8], joints = ["normal", "radial"] }
mu = [0.7, inf]
tilt_deg = 2.5
method = "limit"
"""


def test_tables_of_kinds_have_a_column_and_a_type_for_each_parameter(tmp_path: Path) -> None:
    """CSV is read by the rules of a reader that guesses types, as pandas does."""
    arrow_csv = pytest.importorskip("pyarrow.csv")
    parquet = pytest.importorskip("pyarrow.parquet")
    swept(KINDS_GRID, tmp_path)
    write_csv(tmp_path, tmp_path / "rows.csv")
    write_parquet(tmp_path, tmp_path / "rows.parquet")
    rows = list(read_rows(tmp_path))
    assert len(rows) == 24
    types = {
        "pier_width_m": "double",
        "arch.voussoirs": "int64",
        "arch.joints": "string",
        "mu": "double",
        "tilt_deg": "double",
        "load_factor": "double",
        "verdict": "string",
        "wall_s": "double",
    }
    for table in (
        arrow_csv.read_csv(tmp_path / "rows.csv"),
        parquet.read_table(tmp_path / "rows.parquet"),
    ):
        found = {name: str(table.schema.field(name).type) for name in types}
        empty = {name for name, kind in found.items() if kind == "null"}
        assert empty <= {"load_factor"}
        assert found | dict.fromkeys(empty, "double") == types
        assert "parameters" not in table.schema.names
        for row, held in zip(rows, table.to_pylist(), strict=True):
            asked = row["parameters"]
            assert held["pier_width_m"] == asked["pier_width"]
            assert held["arch.voussoirs"] == asked["arch.voussoirs"]
            assert held["arch.joints"] == asked["arch.joints"]
            assert held["mu"] == float(str(row["mu"]))
            for same in ("id", "method", "verdict", "tilt_deg", "wall_s", "reason"):
                assert held[same] == row[same]


def test_a_table_of_pandas_is_that_of_the_csv(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pandas", None)
        with pytest.raises(MissingPart, match=r"pip install 'blocksim\[pandas\]'"):
            to_pandas(tmp_path)
    pandas = pytest.importorskip("pandas")
    swept(KINDS_GRID, tmp_path)
    write_csv(tmp_path, tmp_path / "rows.csv")
    table, held = to_pandas(tmp_path), pandas.read_csv(tmp_path / "rows.csv")
    assert len(table) == 24
    assert list(table.columns) == list(held.columns)
    for name in ("id", "mu", "tilt_deg", "pier_width_m", "arch.voussoirs", "verdict"):
        assert table[name].tolist() == held[name].tolist(), name
    told = to_pandas(check_many(["{"], workers=1))
    assert told.verdict.tolist() == [None]
    assert "error" in told.columns


@pytest.mark.usefixtures("in_this_process")
def test_a_tower_tilts_least_far_towards_its_shorter_side(tmp_path: Path) -> None:
    """Two boxes overturn over an edge where gravity leaves their base; nothing slides."""
    text = 'kind = "tower"\nblocks = 2\nturn_deg = 0\noffset = 0\nmu = 4\nmethod = "limit"\n'
    asked = design_of(tmp_path, f'{text}over = "tilt"\nazimuth_deg = [0, 30, 60, 90, -135]')
    sweep(asked, tmp_path / "rows")
    write_csv(tmp_path / "rows", tmp_path / "rows.csv")
    told = [float(row["azimuth_deg"]) for row in csv_rows(tmp_path / "rows.csv")]
    assert sorted(told) == [-135, 0, 30, 60, 90]
    for row in read_rows(tmp_path / "rows"):
        towards = math.radians(float(str(row["azimuth_deg"])))
        # Length, width and height of the two are 1, 0.6 and 0.6 m.
        reach = min(0.5 / abs(math.cos(towards)), 0.3 / max(abs(math.sin(towards)), 1e-12))
        assert math.tan(math.radians(float(str(row["limit"])))) == pytest.approx(reach / 0.3)
    with pytest.raises(InputError, match=r"azimuth_deg.*in the plane"):
        design_of(tmp_path, 'kind = "column"\nmu = 0.5\nazimuth_deg = 10')


@pytest.mark.usefixtures("in_this_process")
def test_a_kind_in_space_is_one_like_any_other(tmp_path: Path) -> None:
    """Two boxes stand up to half a length of offset, by statics of the upper one alone."""
    text = 'kind = "tower"\nblocks = 2\nturn_deg = 0\nmu = 0.6\nmethod = ["limit", "direct"]\n'
    towers = design_of(tmp_path, f"{text}offset = [0.49, 0.51]")
    assert sweep(towers, tmp_path / "rows").tally.rows == 4
    assert sweep(towers, tmp_path / "rows").tally.rows == 0
    found = {(row["parameters"]["offset"], row["method"]): row["verdict"]  # type: ignore[index]
             for row in read_rows(tmp_path / "rows")}  # fmt: skip
    assert found == {
        (offset, method): "stands" if offset < 0.5 else "collapses"
        for offset in (0.49, 0.51)
        for method in ("limit", "direct")
    }
    write_csv(tmp_path / "rows", tmp_path / "rows.csv")
    assert ",offset_m,turn_deg," in (tmp_path / "rows.csv").read_text()
    for wrong, said in (
        ('over = "spread"', "over"),
        ('method = "pymunk"', "method"),
        ('shake = "constant"\namplitude_g = 0.1\nduration_s = 1', "shake"),
    ):
        kept = text.replace('method = ["limit", "direct"]\n', "")
        with pytest.raises(InputError, match=said):
            design_of(tmp_path, kept + wrong)


@pytest.mark.usefixtures("in_this_process")
def test_a_table_is_written_where_it_can_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = written(tmp_path, GRID)
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pyarrow", None)
        done = refused(*asked, "--parquet")
    assert done.endswith("not available here: pip install 'blocksim[parquet]'\n")
    assert not (tmp_path / "out").exists()
    pytest.importorskip("pyarrow")
    ran(*asked, "--workers", "1", "--parquet")
    assert (tmp_path / "out/rows.parquet").read_bytes()[:4] == b"PAR1"


def test_what_is_no_row_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rows-x.jsonl").write_text("something else\n")
    with pytest.raises(InputError, match=r"rows-x.jsonl: line 1 = 'something else"):
        sweep(design_of(tmp_path, GRID), tmp_path)


def test_a_worker_of_another_version_is_refused(tmp_path: Path) -> None:
    case = next(case for case in design_of(tmp_path, GRID).cases() if case.method == "limit")
    with pytest.raises(MissingPart, match="install the same"):
        answer([Asked(case.identity("x"), case)], {"limit": "x"})
