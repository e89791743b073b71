"""The report on one structure: a page to print, that needs nothing else."""

from __future__ import annotations

import re
from collections import Counter
from typing import Any

from blocksim.arch.modes import Mode
from blocksim.ask.cases import Cases
from blocksim.ask.check import Check, check
from blocksim.blocks.joints import JointState, joint_names
from blocksim.blocks.problem import Problem
from blocksim.common.dates import is_dated, made_at
from blocksim.common.version import __version__
from blocksim.common.words import lasting
from blocksim.kinds.offers import offers_of
from blocksim.report.answerwords import ASIDE, proof_words
from blocksim.report.cases import HEADINGS, case_row
from blocksim.report.inlinemap import inline_picture
from blocksim.report.motion import mechanism_drawing
from blocksim.report.sheetfacts import (
    Fact,
    assumptions,
    built_facts,
    factor_facts,
    force_words,
    given_facts,
    road_facts,
    thrust_facts,
)
from blocksim.report.sheettables import (
    HINGE,
    MOST,
    joint_table,
    reaction_table,
    solid_reactions,
)
from blocksim.simulation.verdict import Verdict, reason_of
from blocksim.view.drawing import figure_bytes, state_of_any, words_of
from blocksim.view.sheet import Sheet, Titles, answer_sheet
from blocksim.view.sheetfigure import sheet_figure
from blocksim.view.solidfigure import solid_figure
from blocksim.view.templates import template_of
from blocksim.view.turning import turning_page

COLUMN = (182.0, 128.0)
"""Width and most height of the drawing on the page [mm]."""
LOWER = (182.0, 90.0)
"""Width and most height of the drawing of pressures [mm]."""
FEW = 8
"""Joints up to which their table is not halved."""
BELOW = 0.999
"""Share of its least thickness at which it is shown how an arch would fall."""


def structure_page(
    answer: Check[Any],
    *,
    mode: Mode | None = None,
    command: str = "",
    settings: str = "",
    titles: Titles | None = None,
    cases: Cases | None = None,
) -> str:
    """Write the report on one structure.

    `mode`: In which an arch falls.
    `command`, `settings`: The command line and the settings it was made with, to be printed.
    `titles`: What the title block says.
    `cases`: Those among which the answer is that of the governing one.
    Returns: HTML that loads nothing.
    """
    sheet = answer_sheet(answer, titles)
    template = template_of("blocksim.report", "sheet.html", "templates")
    fall = _fall(answer)
    return template.render(
        answer=answer,
        mode=mode,
        cases=cases,
        case_rows=[] if cases is None else list(map(case_row, cases.answers)),
        case_headings=HEADINGS,
        fall=fall,
        most=MOST,
        version=__version__,
        made=made_at(),
        took=""
        if is_dated()
        else f", in {lasting(answer.wall_s)}".replace(" s", "\N{NO-BREAK SPACE}s"),
        command=re.findall(r"(?:'[^']*'|[^\s'])+", command),
        settings=settings,
        **_said(answer, sheet),
        **_drawn(sheet, answer, answer if fall is None else fall["answer"]),
    )


def _said(answer: Check[Any], sheet: Sheet) -> dict[str, object]:
    """Return what the page says of a structure and of the answer."""
    problem = answer.problem
    headings, reactions = reaction_table(sheet)
    found = answer.resultants
    if problem.in_space and found is not None:
        headings, reactions = ["force"], solid_reactions(problem, found, sheet.unit)
    heads, rows = joint_table(problem, found, sheet.unit)
    half = (len(rows) + 1) // 2
    return {
        "sheet": sheet,
        "problem": problem,
        "notes": [f"{each[0].upper()}{each[1:]}." for each in problem.notes],
        "verdicts": _verdicts(answer, sheet),
        "titles": dict(sheet.titles.said),
        "proof": proof_words(answer) if answer.method == "limit" else "",
        "built": built_facts(sheet),
        "given": given_facts(problem),
        "road": road_facts(problem),
        "assumptions": assumptions(problem),
        "factors": factor_facts(answer, sheet),
        "thrusts": thrust_facts(sheet),
        "states": headings,
        "reactions": reactions,
        "forces": force_words(sheet.unit),
        "joints": (rows[:half], rows[half:]) if len(rows) > FEW else (rows,),
        "joint_heads": heads,
        "hinged": any(HINGE in cells for _, cells in rows),
        "active": _active(answer),
    }


def _drawn(sheet: Sheet, answer: Check[Any], falling: Check[Any]) -> dict[str, object]:
    """Return the drawing, and what else is known, for the page.

    In the plane pressures along joints; in space how it falls, and a page to turn it around.
    """
    drawn: dict[str, object] = {"pressures": "", "falling": "", "turned": ""}
    if answer.problem.in_space:
        pictures = {"picture": solid_figure(answer)}
        if falling is not answer:
            pictures["falling"] = solid_figure(falling)
        drawn["turned"] = turning_page(falling)
    else:
        pictures = {"picture": sheet_figure(sheet, column=COLUMN, bare=True)}
        if sheet.carried is not None and sheet.carried.resultants is not None:
            lower = sheet_figure(sheet.pressures, column=LOWER, bare=True)
            pictures["pressures"] = lower
    colours: dict[str, str] = {}
    for name, figure in pictures.items():
        anchor = "sheet" if name == "picture" else name
        drawn[name], dark = inline_picture(figure_bytes(figure), "sheet", "img", anchor)
        colours |= dark
    return {**drawn, "colours": colours}


def _verdicts(answer: Check[Any], sheet: Sheet) -> list[tuple[str, Verdict, str]]:
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


def _active(answer: Check[Any]) -> list[Fact]:
    """Return the joints that take part as it falls, in space how many of each state."""
    problem = answer.problem
    if problem.in_space:
        states = map(state_of_any, (joint.state for joint in answer.joints))
        done = Counter(state for state in states if state is not JointState.CLOSED)
        of = len(answer.joints)
        return [
            Fact(f"{done[state]} of {of}", words_of(state, is_arch=False)[0])
            for state in sorted(done)
        ]
    names = joint_names(problem.assembly)
    return [
        Fact(names[index], words_of(joint.state, is_arch=problem.is_arch)[0], str(index))
        for index, joint in enumerate(answer.joints)
        if joint.state is not JointState.CLOSED
    ]


def _fall(answer: Check[Any]) -> dict[str, Any] | None:
    """Show how it falls. What stands is shown beyond its load factor or least thickness."""
    problem = answer.problem
    if answer.mechanism is not None:
        return _shown(answer, f"how it starts to fall, by {answer.method}")
    factor = answer.load_factor
    if factor is not None and 0 < factor < float("inf") and not problem.shaking:
        over = problem.with_load(factor * (1 + 1e-3))
        return _asked(over, f"how it would start to fall at load factor {factor:.4g}")
    offers = None if problem.in_space else offers_of(problem)
    least = None if offers is None else offers.threshold("thickness")
    if least is None or not least.exact:
        return None
    words = "how it would start to fall at its least thickness as built"
    return _asked(
        least.problem(BELOW * least.exact), f"{words}, {least.value(least.exact):.3f} m"
    )


def _asked(problem: Problem[Any], words: str) -> dict[str, Any] | None:
    found = check(problem, method="limit")
    return None if found.mechanism is None else _shown(found, f"{words}, by limit analysis")


def _shown(answer: Check[Any], caption: str) -> dict[str, Any]:
    """Draw how it falls (in space it is turned around), with words and a legend."""
    problem, states = answer.problem, tuple(joint.state for joint in answer.joints)
    is_arch, rates = problem.is_arch, answer.mechanism
    active = [f"{each.name} {each.value}" for each in _active(answer)]
    looks = {state if is_arch else state_of_any(state) for state in states}
    seen = sorted(looks - {JointState.CLOSED})
    words = f"Joints that take part: {', '.join(active)}." if active else "Blocks move."
    return {
        "answer": answer,
        "drawing": None if problem.in_space else mechanism_drawing(problem, rates, states),
        "caption": f"{caption}, enlarged",
        "words": words,
        "states": {state.value: words_of(state, is_arch=is_arch)[0] for state in seen},
    }
