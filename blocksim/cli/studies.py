"""The studies: published answers held against their sources, the chart, the suite of scenes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import click

from blocksim.cli.arguments import NEEDED, argument, option
from blocksim.cli.options import JSON, require_given
from blocksim.cli.output import answer_with, progress, say
from blocksim.cli.terminal import Table, show
from blocksim.common.checks import Range, require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.files import make_folder
from blocksim.common.words import counted
from blocksim.engines import NAMES, engine_named
from blocksim.report.answerwords import signed
from blocksim.report.referee import known_scores, read_score, score_lines, write_score
from blocksim.report.rowwords import found_of, known_of, summary
from blocksim.studies.agreement import Row, disagreements, parted
from blocksim.studies.chart import Point, cases, measure, on_front
from blocksim.studies.validate import LIMIT, structures, unasked
from blocksim.studies.validate import validate as run_validation
from blocksim.suite.answers import read_answers, recording_of
from blocksim.suite.export import chosen, questions
from blocksim.suite.export import export as export_scenes
from blocksim.suite.families import Question
from blocksim.suite.scene import Bodies
from blocksim.suite.score import scored, worse


def validate(
    quick: bool = option(
        "Structures marked quick, or all of them.", default=False, name="--quick/--full"
    ),
    out: Path = option("Folder for the results.", default=Path("out/validate"), folder=True),
    methods: str | None = option(
        f"Engines, with commas: {', '.join(NAMES)}, or your own as module:ENGINE; "
        "those usual if left out."
    ),
    workers: int = option("Processes.", default=2, range=Range(low=1, high=64, whole=True)),
) -> None:
    """Simulate published arches and structures; compare with the map and their sources.

    Exit code 0 where all agrees, 1 where something does not.
    """
    from blocksim.report.tables import write_results

    engines = None if methods is None else [each.strip() for each in methods.split(",")]
    for each in engines or ():
        engine_named(each, "--methods")
    make_folder(out)
    chosen = structures(quick=quick)
    left_out = unasked(chosen, engines)
    with progress() as report:
        found = run_validation(chosen, engines, workers=workers, progress=report)
    paths = write_results(found, out, left_out)
    show(answer_table(found))
    say(*answer_lines(found), *(f"not asked of {each.words}" for each in left_out))
    say("wrote " + ", ".join(str(path) for path in paths))
    raise click.exceptions.Exit(int(any(row.miss for row in found)))


def chart(
    quick: bool = option("Two small arches, or five.", default=False, name="--quick/--full"),
    out: Path = option("Folder for the results.", default=Path("out/chart"), folder=True),
    beside: Path | None = option("Points of another program: JSON like chart.json."),
) -> None:
    """Chart the error of every method, from coarse to fine, against time and work."""
    from blocksim.report.tables import read_points, write_chart

    foreign = read_points(beside) if beside else []
    make_folder(out)
    with progress() as report:
        points = measure(cases(quick=quick), quick=quick, progress=report) + foreign
    paths = write_chart(points, out)
    show(chart_table(points))
    say("wrote " + ", ".join(str(path) for path in paths))


def answer_table(rows: Sequence[Row]) -> Table:
    """Lay out answers for a terminal: a line a question, a column a method."""
    told = [_told(row) for row in rows]
    # The exact answers come first.
    methods = sorted(dict.fromkeys(method for _, method, _ in told), key=LIMIT.__ne__)
    headings = ("structure", "over", "known", "published", *methods)
    table = Table(*headings, right={"known", "published"}, wrap=False, below=len(methods))
    asked: dict[tuple[str, ...], dict[str, str]] = {}
    for question, method, answer in told:
        asked.setdefault(question, {})[method] = answer
    for question, answers in asked.items():
        table.add_row(*question, *(answers.get(method, "") for method in methods))
    return table


def _told(row: Row) -> tuple[tuple[str, ...], str, str]:
    """Return a question with what is known of it, the method asked, and its answer."""
    known, published, answer = known_of(row), row.published or "-", found_of(row)
    if row.modes_published:
        known = f"{row.mode_limit or ''} {known}".strip()
        published = f"{'/'.join(row.modes_published)} {published}"
        error = "" if row.error is None else f" {signed(100 * row.error, 3)}%"
        answer = f"{row.mode or '-'}{error}"
    question = (row.structure, row.question, known, published)
    return question, row.method, f"{answer} !" if row.miss else answer


def answer_lines(rows: Sequence[Row]) -> list[str]:
    """Return how many answers agree, what does not, and where engines differ, in words."""
    arches, built = parted(rows)
    right = sum(not row.miss for row in arches)
    lines = [
        "thickness of arches: modes, and the least thickness as a share of the radius",
        "  known: of the voussoirs as built, by limit; published: of the continuous arch",
        "  engines: the mode that is seen, and how far their least thickness is from known",
        f"{right} of {len(arches)} answers of engines agree with limit: thickness, mode "
        "and verdict",
        *([summary(built).removesuffix(".")] if built else []),
    ]
    lines += [
        f"  {name}, {over}, {method}: {row.miss} ({row.note})"
        for row in rows
        if row.miss
        for (name, over, *_), method, _ in [_told(row)]
    ]
    if len({row.method for row in arches}) > 1:
        apart = disagreements(arches)
        places = counted(len(apart), "place") if apart else "no place"
        lines.append(f"engines contradict each other in {places}")
        lines += [f"  {each}" for each in apart]
    return lines


def chart_table(points: list[Point]) -> Table:
    """Lay out what was measured for the chart, one line a bracket."""
    numbers = ("value", "error", "s", "contact solves")
    table = Table("arch", "method", "knob", *numbers, "", right=numbers, wrap=False)
    best = on_front(points)
    for point in points:
        error = f"{point.error:.1e}" if math.isfinite(point.error) else "none"
        table.add_row(
            point.case,
            point.method,
            point.knob,
            f"{point.value:.4g}",
            error,
            f"{point.time:.3g}",
            f"{point.work:.1e}",
            "on the front" if point in best else "",
        )
    return table


def export(
    folder: Path = argument("Folder for the scenes.", folder=True, default=NEEDED),
    level: list[float] | None = option(
        "Only scenes so far from their limit, in %; repeatable."
    ),
    group: list[str] | None = option("Only scenes of a group; repeatable."),
) -> None:
    """Write scenes of which the answer is proved, for engines of any language."""
    scenes = chosen(level or (), group or ())
    count = export_scenes(folder, scenes)
    say(f"wrote {', '.join(f'{many} {name}' for name, many in count.items())} to {folder}")


def score(
    answers: str = argument("What an engine said: a file of JSON lines.", default=NEEDED),
    out: Path | None = option("Folder for a page, its rows and JSON.", folder=True),
    expect: str | None = option(
        "A score.json of before: exit code 1 where a level has become worse."
    ),
    as_json: bool = JSON,
) -> None:
    """Hold what an engine said of these scenes to the truth."""
    before = None if expect is None else read_score(expect)
    asked = questions()
    head, said = read_answers(answers, asked)
    found = scored(head, said, asked)
    record = found.record()
    paths = [] if out is None else write_score(found, out)
    answer_with(lambda: record, lambda: score_lines(record, known_scores()), as_json=as_json)
    if paths and not as_json:
        say("wrote " + ", ".join(map(str, paths)))
    lost = () if before is None else worse(record, before)
    for sentence in lost:
        click.echo(f"blocksim: {sentence}", err=True)
    raise click.exceptions.Exit(int(bool(lost)))


def replay(
    answers: str = argument("What an engine said: a file of JSON lines.", default=NEEDED),
    scene: str = argument("A scene that it answered by poses.", default=NEEDED),
    out: Path | None = option("Recording to write, .npz; required."),
) -> None:
    """Make a recording of what an engine said of a scene.

    `blocksim render` films it, alone or beside the motion by another engine.
    """
    require_given(out=out)
    out = out or Path()
    require(out.suffix == ".npz", "--out", str(out), "a file that ends in .npz")
    asked = questions()
    head, said = read_answers(answers, asked)
    require(scene in said, "SCENE", scene, f"one that is answered{perhaps(scene, said)}")
    question = asked[scene]
    if not isinstance(question, Question):
        raise InputError("SCENE", scene, "a scene that asks whether blocks stand")
    poses = said[scene].poses
    if poses is None:
        allowed = "a scene answered by poses: a verdict alone shows no motion"
        raise InputError("scene", scene, allowed)
    recording_of(head, poses, question).save(out)
    truth = "stands" if question.stands else "falls"
    way = float(Bodies(question.scene).ways(poses[-1]).max())
    say(
        f"wrote {out}: {scene} {truth}; by {head.engine} a corner has moved {way:.3g} m at the "
        f"end, {question.scene.bound:.3g} m count as standing"
    )
