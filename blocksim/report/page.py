"""The report of `validate`: one page that needs nothing else."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from blocksim.arch.circular import GRAVITY
from blocksim.arch.modes import Mode
from blocksim.ask.methods import STATIC
from blocksim.blocks.joints import JointState
from blocksim.common.dates import made_at
from blocksim.common.words import percent
from blocksim.engines import engine_named
from blocksim.report.inlinemap import inline_map
from blocksim.report.motion import joints_of, mechanism_drawing, recorded_drawing
from blocksim.report.rowwords import (
    QUANTITIES,
    error_of,
    found_of,
    known_of,
    question_of,
    summary,
)
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Row, Unasked, disagreements, numbered, parted
from blocksim.studies.questions import NEAR, SLOWLY
from blocksim.studies.thickness import ASIDE, ERROR_BOUND
from blocksim.view import style
from blocksim.view.templates import template_of


def report_page(
    found: Sequence[Row],
    map_svg: bytes,
    machine: Mapping[str, str],
    unasked: Sequence[Unasked] = (),
) -> str:
    """Write the page, of one engine or several: HTML that loads nothing."""
    arches, others = parted(found)
    template = template_of(
        "blocksim.report", "report.html", "templates",
        degrees=lambda angle: f"{math.degrees(angle):.4g}",
        friction=lambda mu: "∞" if math.isinf(mu) else f"{mu:.4g}",
        capitalised=lambda words: words[:1].upper() + words[1:],
        found=found_of, error=error_of, known=known_of, question=question_of,
    )  # fmt: skip
    engines = list(dict.fromkeys(row.method for row in arches))
    asked = dict.fromkeys(row.method for row in others if row.method not in STATIC)
    # Those on the map come first: its points have the same numbers.
    numbers = numbered([*arches, *others])
    drawn_map, dark = inline_map(map_svg, {n: name for name, n in numbers.items()})
    return template.render(
        cases=[
            _case(number, [row for row in found if row.structure == name])
            for name, number in numbers.items()
        ],
        arches=len(arches),
        others=len(others),
        unasked=unasked,
        misses=[row for row in found if row.miss],
        notes=[row for row in arches if row.note and not row.miss],
        engines=engines,
        apart=disagreements(arches) if len(engines) > 1 else None,
        sentence=summary(found),
        numbers=numbers,
        map=drawn_map,
        map_colours=dark,
        machine=machine,
        made=made_at(),
        seconds=sum(row.wall_s for row in found),
        tol=_by(engines, "validated_to"),
        asides=_by(asked, "aside"),
        aside=percent(ASIDE),
        bound=percent(ERROR_BOUND),
        near=f"{NEAR:g}",
        slowly=percent(SLOWLY),
        states=[state for state in JointState if state is not JointState.CLOSED],
        mode_styles=style.MODES,
        modes=list(Mode),
    )


def _by(engines: Sequence[str] | Mapping[str, object], what: str) -> str:
    """Say a share of each engine."""
    said = (f"{percent(getattr(engine_named(each), what))} by {each}" for each in engines)
    return ", ".join(said)


def _case(number: int, rows: list[Row]) -> dict[str, Any]:
    """Return a structure with all that was asked about it, and how it falls."""
    questions = dict.fromkeys(row.question for row in rows)
    return {
        "number": number,
        "anchor": f"case-{number}",
        "row": rows[0],
        "lines": len(rows),
        "asked": [[row for row in rows if row.question == each] for each in questions],
        "drawings": _recorded(rows) if rows[0].modes_published else _drawn(rows),
    }


def _drawn(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Draw a structure as an engine showed it fall; else as limit analysis says, or at rest."""
    known = [row for row in rows if row.drawn is not None]
    falls = [row for row in known if row.drawn is not None and row.drawn.rates is not None]
    seen = [row for row in falls if row.method != "limit"]
    best = next(iter(seen or falls or known[::-1]), None)
    # Blocks in space are not drawn here yet.
    if best is None or best.drawn is None or best.drawn.problem.in_space:
        return []
    drawn = best.drawn
    # The end of what was asked at which it falls, or stands if it does not.
    at = best.low if best.at_low is Verdict.COLLAPSES else best.high
    name, unit = QUANTITIES.get(best.question, best.question), f" {best.unit}".rstrip()
    place = "" if at is None else f" at {name} {at:.6g}{unit}"
    if drawn.rates is None:
        caption, words = f"at rest{place}, by {best.method}", "Nothing moves."
    else:
        place = " on supports that have moved" if best.question == "spread" else place
        caption = f"how it starts to fall{place}, by {best.method}, enlarged"
        joints = ", ".join(map(str, best.hinges))
        words = f"Joints that take part, numbered from 0: {joints}."
    picture = mechanism_drawing(drawn.problem, drawn.rates, drawn.states)
    return [{"drawing": picture, "by": "", "caption": caption, "words": words}]


def _recorded(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Draw an arch as each engine let it go; None where no moving run was made."""
    found: list[dict[str, Any]] = []
    for row in rows:
        recording = row.recording
        if recording is None:
            found.append({"drawing": None, "by": row.method})
            continue
        drawn, seconds = recorded_drawing(recording), float(recording.seconds(GRAVITY)[-1])
        thickest = row.low is not None and row.high is None
        where = f"{percent(ASIDE)} below the bracket's centre"
        where = "the thickest arch there is" if thickest else where
        moved = f"motion enlarged {drawn.enlarged or 0:.0f} times; it took {seconds:.2f} s"
        moved = f"nothing moved in {seconds:.2f} s" if drawn.enlarged is None else moved
        known = "".join(f"{each}, " for each in recording.problem.measures[1:2])
        active = [
            f"{math.degrees(joint.angle):+.1f}° {joint.state.words}"
            for joint in joints_of(recording)
            if joint.state is not JointState.CLOSED
        ]
        size = f"r = {recording.assembly.size:g} m"
        order = "Joints that take part, from the left springing to the right"
        found.append(
            {
                "drawing": drawn,
                "by": row.method,
                "caption": f"{known}{where}; {moved} ({size}), by {row.method}",
                "words": f"{order}: {', '.join(active)}." if active else "Nothing moves.",
            }
        )
    return found
