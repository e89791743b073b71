"""The report of `validate`: one page that needs nothing else."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Any

from blocksim.arch.circular import GRAVITY
from blocksim.arch.modes import Mode
from blocksim.ask.methods import STATIC
from blocksim.blocks.joints import JointState
from blocksim.common.dates import made_at
from blocksim.engines import engine_named
from blocksim.report.answerwords import ratio
from blocksim.report.environment import environment
from blocksim.report.inlinemap import inline_map
from blocksim.report.motion import joints_of, recorded_drawing
from blocksim.report.structurepart import (
    error_of,
    found_of,
    shown_structures,
    summary_of_structures,
)
from blocksim.simulation.recording import Recording
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Row, Unasked, disagreements, numbered, parted
from blocksim.studies.questions import NEAR, SLOWLY
from blocksim.studies.thickness import ASIDE, ERROR_BOUND
from blocksim.view import style


def report_page(
    found: Sequence[Row],
    map_svg: bytes,
    machine: Mapping[str, str],
    unasked: Sequence[Unasked] = (),
) -> str:
    """Write the page, of one engine or several: HTML that loads nothing."""
    rows, structures = parted(found)
    pages = environment()
    pages.filters |= {"degrees": _degrees, "friction": _friction, "capitalised": _capitalised}
    pages.filters |= {"found": found_of, "error": error_of}
    template = pages.get_template("report.html")
    engines = list(dict.fromkeys(row.method for row in rows))
    drawn_map, dark = inline_map(map_svg, {n: name for name, n in numbered(rows).items()})
    return template.render(
        cases=[
            _case(number, [row for row in rows if row.structure == name])
            for name, number in numbered(rows).items()
        ],
        unasked=unasked,
        misses=[row for row in rows if row.miss],
        notes=[row for row in rows if row.note and not row.miss],
        engines=engines,
        apart=disagreements(rows) if len(engines) > 1 else None,
        sentence=summary(rows),
        numbers=numbered(rows),
        map=drawn_map,
        map_colours=dark,
        machine=machine,
        made=made_at(),
        seconds=sum(row.wall_s for row in rows),
        tol=" and ".join(map(_width_of, engines)),
        aside=_percent(ASIDE),
        bound=_percent(ERROR_BOUND),
        states=[state for state in JointState if state is not JointState.CLOSED],
        structure_misses=[row for row in structures if row.miss],
        **_structures(structures),
        mode_styles=style.MODES,
        modes=list(Mode),
    )


def _width_of(engine: str) -> str:
    return f"{_percent(engine_named(engine).validated_to)} ({engine})"


def _structures(rows: Sequence[Row]) -> dict[str, object]:
    """Return what the second part of the page says."""
    shown = shown_structures(rows)
    return {
        "structures": shown,
        "structure_sentence": summary_of_structures(rows),
        "structure_anchors": {each["row"].structure: each["anchor"] for each in shown},
        "structure_near": f"{NEAR:g}",
        "structure_asides": _asides(rows),
        "structure_slowly": _percent(SLOWLY),
    }


def summary(rows: Sequence[Row]) -> str:
    """Say in a sentence or two how simulation and limit analysis agree."""
    agree = sum(not row.miss for row in rows)
    share = f"All {len(rows)}" if agree == len(rows) else f"{agree} of {len(rows)}"
    parts = [f"{share} simulated arches agree with the exact answer in every respect"]
    errors = [abs(row.error) for row in rows if row.error is not None]
    if errors:
        worst = _percent(max(errors), ".3f")
        parts.append(f"the least thickness found is off by {worst} at most")
    ends = [(row.at_low, row.at_high) for row in rows]
    false = sum(low is Verdict.STANDS or high is Verdict.COLLAPSES for low, high in ends)
    undecided = sum(Verdict.UNDECIDED in each for each in ends)
    asked = sum(said is not None for each in ends for said in each)
    parts.append(
        f"of {asked} verdicts {_percent(ASIDE)} to either side of it "
        f"{false or 'none'} {'is' if false <= 1 else 'are'} false and "
        f"{undecided or 'none'} {'is' if undecided <= 1 else 'are'} undecided"
    )
    return "; ".join(parts) + "."


def _asides(rows: Sequence[Row]) -> str:
    """Say how far inside and beyond each engine was asked."""
    engines = dict.fromkeys(row.method for row in rows if row.method not in STATIC)
    return ", ".join(
        f"{_percent(engine_named(engine).aside)} by {engine}" for engine in engines
    )


def _case(number: int, rows: Sequence[Row]) -> dict[str, Any]:
    """Return an arch as the page shows it, with what every engine showed of it."""
    anchor = f"case-{number}"
    results = [_result(row, f"{anchor}-{place}") for place, row in enumerate(rows)]
    return {"number": number, "anchor": anchor, "row": rows[0], "results": results}


def _result(row: Row, anchor: str) -> dict[str, Any]:
    """Return a row as the page shows it."""
    low, high = row.low, row.high
    if high is None:
        bracket = "none up to 2"
    elif low is None:
        bracket = f"below {ratio(high)}"
    else:
        bracket = f"{low:.6g} to {high:.6g}"
    ends = [eta for eta in (low, high) if eta is not None]
    nothing = not ends or (high is None and row.expected is None)
    # Nothing thinner than eta = 2 stands: there is no least thickness to be aside of.
    thickest = low is not None and high is None
    shown: dict[str, Any] = {"drawing": None}
    if row.recording is not None:
        shown = _shown(row.recording, thickest=thickest)
    return {
        "row": row,
        "anchor": anchor,
        "thickest": thickest,
        "found": "none" if nothing else ratio(fmean(ends)),
        "bracket": bracket,
        "error": "-" if row.error is None else _percent(row.error, "+.3f"),
        **shown,
    }


def _shown(recording: Recording, *, thickest: bool) -> dict[str, Any]:
    """Draw a recording, with a caption, and words for those who do not see it."""
    drawn, seconds = recorded_drawing(recording), float(recording.seconds(GRAVITY)[-1])
    where = "the thickest arch there is" if thickest else (
        f"{_percent(ASIDE)} below the bracket's centre"
    )  # fmt: skip
    moved = f"nothing moved in {seconds:.2f} s" if drawn.enlarged is None else (
        f"motion enlarged {drawn.enlarged:.0f} times; it took {seconds:.2f} s"
    )  # fmt: skip
    known = "".join(f"{each}, " for each in recording.problem.measures[1:2])
    active = [
        f"{math.degrees(joint.angle):+.1f}° {joint.state.words}"
        for joint in joints_of(recording)
        if joint.state is not JointState.CLOSED
    ]
    words = f"Joints that take part, from the left springing to the right: {', '.join(active)}."
    caption = f"{known}{where}; {moved} (r = {recording.assembly.size:g} m)"
    words = words if active else "Nothing moves."
    return {"drawing": drawn, "caption": caption, "words": words}


def _percent(share: float, digits: str = "g") -> str:
    said = f"{share * 100:{digits}}"
    # What rounds to nothing has no sign.
    said = said if float(said) else said.lstrip("+-")
    return f"{said}\N{NO-BREAK SPACE}%"


def _capitalised(words: str) -> str:
    return words[:1].upper() + words[1:]


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.4g}"


def _friction(mu: float) -> str:
    return "∞" if math.isinf(mu) else f"{mu:.4g}"
