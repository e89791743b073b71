"""The report on one structure: a page to print, that needs nothing else."""

from __future__ import annotations

import io
from dataclasses import dataclass

from blocksim.arch.modes import Mode
from blocksim.ask.check import Check, check
from blocksim.blocks.joints import JointState, joint_names
from blocksim.blocks.problem import Problem
from blocksim.common.dates import is_dated, made_at
from blocksim.common.version import __version__
from blocksim.kinds.offers import offers_of
from blocksim.limit import equilibrium
from blocksim.report.answerwords import ASIDE, proof_words
from blocksim.report.environment import environment
from blocksim.report.inlinemap import inline_picture
from blocksim.report.motion import Drawing, mechanism_drawing
from blocksim.report.sheetfacts import (
    MOST,
    Fact,
    assumptions,
    built_facts,
    factor_facts,
    force_words,
    given_facts,
    joint_rows,
    reaction_table,
    road_facts,
    thrust_facts,
)
from blocksim.simulation.verdict import Verdict, reason_of
from blocksim.studies.questions import Drawn
from blocksim.view import style
from blocksim.view.drawing import save_figure, state_of_any, words_of
from blocksim.view.sheet import Sheet, Titles, answer_sheet
from blocksim.view.sheetfigure import sheet_figure

COLUMN = (182.0, 128.0)
"""Width and most height of the drawing on the page [mm]."""
FEW = 8
"""Joints up to which their table is not halved."""
BELOW = 0.999
"""Share of its least thickness at which it is shown how an arch would fall."""


@dataclass(frozen=True, kw_only=True)
class Fall:
    """How it falls, or would fall: a drawing that moves, and its words."""

    drawing: Drawing
    caption: str
    words: str
    states: tuple[JointState, ...]


def structure_page(
    answer: Check,
    *,
    mode: Mode | None = None,
    command: str = "",
    settings: str = "",
    titles: Titles | None = None,
) -> str:
    """Write the report on one structure.

    Parameters
    ----------
    answer : Check
    mode : Mode or None
        In which an arch falls.
    command, settings : str
        The command line and the settings it was made with, to be printed.
    titles : Titles, optional
        What the title block says.

    Returns
    -------
    str
        HTML that loads nothing.
    """
    problem = answer.problem
    sheet = answer_sheet(answer, titles)
    file = io.BytesIO()
    save_figure(sheet_figure(sheet, column=COLUMN, bare=True), file, "svg")
    picture, dark = inline_picture(file.getvalue(), "sheet", "img")
    headings, reactions = reaction_table(sheet)
    rows = joint_rows(sheet)
    half = (len(rows) + 1) // 2
    return (
        environment()
        .get_template("sheet.html")
        .render(
            title=sheet.title,
            source=problem.source,
            answer=answer,
            mode=mode,
            verdicts=_verdicts(answer, sheet),
            titles=dict(sheet.titles.said),
            proof=proof_words(answer) if answer.method == "limit" else "",
            built=built_facts(sheet),
            given=given_facts(problem),
            road=road_facts(problem),
            assumptions=assumptions(problem),
            factors=factor_facts(answer, sheet),
            thrusts=thrust_facts(sheet),
            states=headings,
            reactions=reactions,
            forces=force_words(sheet.unit),
            unit=sheet.unit.name,
            joints=(rows[:half], rows[half:]) if len(rows) > FEW else (rows,),
            joint_count=len(problem.assembly.joints),
            most=MOST,
            active=_active(answer),
            picture=picture,
            described=", ".join(line.words for line in sheet.lines),
            colours=dark,
            fall=_fall(answer),
            state_words={
                each.value: words_of(each, is_arch=False)[0]
                for each in JointState
                if each in style.JOINTS
            },
            notes=problem.notes,
            version=__version__,
            made=made_at(),
            took="" if is_dated() else f", in {answer.wall_s:.2g} s",
            command=command,
            settings=settings,
        )
    )


def _verdicts(answer: Check, sheet: Sheet) -> list[tuple[str, Verdict, str]]:
    """Return method, verdict and reason: by limit analysis, and by the method asked for."""
    words = "limit analysis"
    method = words if answer.method == "limit" else answer.method
    why = reason_of([each for each in answer.evidence if each.test not in ASIDE])
    asked = (method, answer.verdict, why)
    if answer.method == "limit" or sheet.carried is None:
        return [asked]
    static = answer.forces is not None
    reason = "forces of equilibrium exist" if static else "no forces of equilibrium exist"
    return [(words, Verdict.STANDS if static else Verdict.COLLAPSES, reason), asked]


def _active(answer: Check) -> list[Fact]:
    """Joints that take part as it falls."""
    problem = answer.problem
    names = joint_names(problem.assembly)
    return [
        Fact(names[index], words_of(joint.state, is_arch=problem.is_arch)[0], str(index))
        for index, joint in enumerate(answer.joints)
        if joint.state is not JointState.CLOSED
    ]


def _fall(answer: Check) -> Fall | None:
    """Show how it falls; what stands, beyond its load factor or below its least thickness."""
    problem = answer.problem
    if answer.mechanism is not None:
        states = tuple(joint.state for joint in answer.joints)
        drawn = Drawn(
            problem=problem, rates=answer.mechanism, states=states, method=answer.method
        )
        return _shown(drawn, f"how it starts to fall, by {answer.method}")
    factor = answer.load_factor
    if factor is not None and 0 < factor < float("inf") and not problem.shaking:
        over = problem.with_load(factor * (1 + 1e-3))
        return _asked(over, f"how it would start to fall at load factor {factor:.4g}")
    offers = offers_of(problem) if problem.is_planar else None
    least = None if offers is None else offers.threshold("thickness")
    if least is None or not least.exact:
        return None
    words = "how it would start to fall at its least thickness as built"
    return _asked(
        least.problem(BELOW * least.exact), f"{words}, {least.value(least.exact):.3f} m"
    )


def _asked(problem: Problem, words: str) -> Fall | None:
    if equilibrium(problem).exists:
        return None
    found = check(problem, method="limit")
    states = tuple(joint.state for joint in found.joints)
    drawn = Drawn(problem=problem, rates=found.mechanism, states=states, method="limit")
    return None if found.mechanism is None else _shown(drawn, f"{words}, by limit analysis")


def _shown(drawn: Drawn, caption: str) -> Fall:
    names = joint_names(drawn.problem.assembly)
    active = [
        f"{names[index]} {words_of(state, is_arch=drawn.problem.is_arch)[0]}"
        for index, state in enumerate(drawn.states)
        if state is not JointState.CLOSED
    ]
    seen = {state_of_any(state) for state in drawn.states} - {JointState.CLOSED}
    words = f"Joints that take part: {', '.join(active)}." if active else "Blocks move."
    return Fall(
        drawing=mechanism_drawing(drawn),
        caption=f"{caption}, enlarged",
        words=words,
        states=tuple(sorted(seen)),
    )
