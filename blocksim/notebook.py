"""How things draw, tell and show themselves in a notebook; see `blocksim.common.shown`.

Answers tell what the command line prints of them. Drawing takes a second to import, which
happens when something is drawn first.
"""

from __future__ import annotations

import html
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

from blocksim.arch.answers import ArchBracket
from blocksim.arch.circular import ETA_MAX, Arch
from blocksim.arch.theory import least_thickness
from blocksim.ask.bracket import Bracket
from blocksim.ask.cases import Cases
from blocksim.ask.check import Check, check
from blocksim.ask.crossing import Crossing
from blocksim.blocks.maker import Kind
from blocksim.blocks.problem import Problem
from blocksim.blocks.structure import structure_record
from blocksim.common.fields import same
from blocksim.common.files import AnyPath, json_text
from blocksim.common.words import printable
from blocksim.kinds.circular import CircularArch
from blocksim.report.answers import bracket_record, check_record
from blocksim.report.answerwords import bracket_lines, check_lines
from blocksim.report.cases import cases_lines, cases_record
from blocksim.report.crossing import crossing_lines, crossing_record
from blocksim.report.problems import (
    arch_size_lines,
    described,
    length_lines,
    problem_record,
    size_lines,
    size_record,
)
from blocksim.report.recordings import recording_lines, recording_record
from blocksim.simulation.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from blocksim.view.sheet import Sheet

LABEL = 10
"""Letters of a line of an answer before its words: two blanks and what it is about."""
TALL = 400
"""Height of a frame [pixels]."""
THIN = 0.02
"""Thickness-to-radius ratio drawn of an arch that stands at any."""


def dict_of(shown: object) -> dict[str, Any]:
    """Return a thing as JSON has it.

    Returns: Of an answer what `--json` prints; of a problem its structure file, in space what
        answers say of it; of a recording what it shows, without its poses.
    """
    thing, (record, _, _) = _known(shown)
    return json.loads(json_text(record(thing)))


def lines_of(shown: object) -> list[str]:
    """Return a thing in words, as the command line prints it: a head and labelled lines."""
    thing, (_, lines, _) = _known(shown)
    return lines(thing)


def figure_of(shown: object) -> Figure:
    """Draw a thing.

    Returns: Of a check with its forces or its mechanism; of the least thickness of an arch the
        arch of that thickness; of a recording its last frame.
    """
    thing, (_, _, figure) = _known(shown)
    return figure(thing)


def film_of(shown: object, path: AnyPath, **options: Any) -> None:
    """Write a recording as a film; options are those of `blocksim.view.video.render`."""
    from blocksim.view.video import render

    render([cast("Recording[Any]", shown)], path, **options)


@lru_cache(maxsize=1)
def svg_of(shown: object) -> str:
    """Return the drawing of a thing as one SVG element.

    The last one is kept: a notebook asks for it alone and within the page.
    """
    from blocksim.view.drawing import figure_bytes

    text = figure_bytes(figure_of(shown)).decode()
    # Without the prologue, which has no place within a page.
    return text[text.index("<svg") :]


def html_of(shown: object) -> str:
    """Return the words of a thing as a table, and its drawing below."""
    head, *lines = (html.escape(printable(line)) for line in lines_of(shown))
    rows = "".join(
        f"<tr><th style='text-align:left'>{line[:LABEL].strip()}</th>"
        f"<td style='text-align:left'>{line[LABEL:].strip()}</td></tr>"
        for line in lines
    )
    return f"<div><strong>{head.strip()}</strong><table>{rows}</table>{svg_of(shown)}</div>"


def _problem_lines(problem: Problem[Any]) -> list[str]:
    return [
        problem.title or "Structure",
        f"  what    {described(replace(problem, title=''))}",
        *size_lines(problem),
    ]


def _recording_lines(run: Recording) -> list[str]:
    said = recording_lines(run, run.problem.length_name)
    motion = [f"  motion  {line.strip()}" for line in said]
    what = f"  what    {described(run.problem)}"
    return [f"Recording by {run.engine}", *motion, what, *length_lines(run.problem)]


def _arch_lines(arch: Arch) -> list[str]:
    return [_arch_words(arch), *arch_size_lines(arch)]


def _arch_words(arch: Arch) -> str:
    return (
        f"Arch: alpha {math.degrees(arch.half_angle):g} deg, eta {arch.eta:g}, "
        f"{arch.voussoirs} voussoirs, weight {arch.weight}"
    )


def _arch_record(arch: Arch) -> dict[str, object]:
    angle = {"half_angle_deg": math.degrees(arch.half_angle)}
    return {**angle, **same(arch, "eta", "voussoirs", "weight"), **size_record(arch)}


def _drawn(sheet: Sheet) -> Figure:
    from blocksim.view.sheetfigure import SCREEN, sheet_figure

    return sheet_figure(sheet, column=SCREEN)


def _arch_figure(arch: Arch) -> Figure:
    from blocksim.view.sheet import sheet_of

    # An arch alone has no friction to tell.
    return _drawn(
        sheet_of(CircularArch.of(arch, math.inf).problem(), facts=[_arch_words(arch)])
    )


def _problem_record(problem: Problem[Any]) -> Mapping[str, object]:
    return problem_record(problem) if problem.in_space else structure_record(problem)


def _problem_figure(problem: Problem[Any]) -> Figure:
    if problem.in_space:
        return _check_figure(check(problem))
    from blocksim.view.sheet import sheet_of

    return _drawn(sheet_of(problem))


def _check_figure(answer: Check[Any]) -> Figure:
    if answer.problem.in_space:
        from blocksim.view.solidfigure import solid_figure

        return solid_figure(answer)
    from blocksim.view.sheet import answer_sheet

    return _drawn(answer_sheet(answer))


def _arch_bracket_figure(of: ArchBracket, answer: Bracket) -> Figure:
    """Draw the arch of least thickness."""
    arch, mu = of.shape, answer.problem.mu
    if answer.method == "theory" and of.eta_high is not None:
        from blocksim.view.archfigure import arch_figure, picture_of_theory

        shape = arch.half_angle, mu, arch.weight
        critical = least_thickness(*shape)
        return arch_figure([picture_of_theory(critical, critical.mode, *shape)])
    eta = ETA_MAX if of.eta_high is None else of.eta_high or THIN
    return _check_figure(check(CircularArch.of(replace(arch, eta=eta), mu)))


def _bracket_figure(answer: Bracket) -> Figure:
    if answer.arch is not None:
        return _arch_bracket_figure(answer.arch, answer)
    from blocksim.view.curvefigure import range_figure

    return range_figure(answer)


def _recording_figure(recording: Recording) -> Figure:
    from blocksim.view.film import Film

    return Film([recording], height=TALL).figure()


def _crossing_figure(answer: Crossing) -> Figure:
    from blocksim.view.curvefigure import envelope_figure

    return envelope_figure(answer)


def _cases_figure(answer: Cases) -> Figure:
    return _check_figure(answer.governing.answer)


_Ways = tuple[
    Callable[[Any], Mapping[str, object]], Callable[[Any], list[str]], Callable[[Any], "Figure"]
]


def _known(shown: object) -> tuple[object, _Ways]:
    """Return a thing, a maker as the problem that it makes, and how it is told and drawn."""
    thing = cast("Kind[Any]", shown).problem() if isinstance(shown, Kind) else shown
    return thing, _KNOWN[type(thing)]


_KNOWN: dict[type, _Ways] = {
    Arch: (_arch_record, _arch_lines, _arch_figure),
    Problem: (_problem_record, _problem_lines, _problem_figure),
    Check: (check_record, check_lines, _check_figure),
    Bracket: (bracket_record, bracket_lines, _bracket_figure),
    Crossing: (crossing_record, crossing_lines, _crossing_figure),
    Cases: (cases_record, cases_lines, _cases_figure),
    Recording: (recording_record, _recording_lines, _recording_figure),
}
"""How each thing is told, as JSON and in words, and drawn."""
