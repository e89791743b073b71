"""The commands of the suite: scenes for engines, and the score of what they say."""

from __future__ import annotations

from pathlib import Path

import click

from blocksim.cli.arguments import NEEDED, argument, option
from blocksim.cli.options import JSON, require_given
from blocksim.cli.output import answer_with, say
from blocksim.common.checks import require
from blocksim.common.errors import InputError, perhaps
from blocksim.report.referee import known_scores, read_score, score_lines, write_score
from blocksim.suite.answers import read_answers, recording_of
from blocksim.suite.export import chosen, questions
from blocksim.suite.export import export as export_scenes
from blocksim.suite.families import Question
from blocksim.suite.scene import Bodies
from blocksim.suite.score import scored, worse


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
    head, said = read_answers(answers, {name: each.scene for name, each in asked.items()})
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
    head, said = read_answers(answers, {name: each.scene for name, each in asked.items()})
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
