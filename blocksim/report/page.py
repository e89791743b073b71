"""The report of `validate`: one page that needs nothing else."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from blocksim.arch.circular import GRAVITY
from blocksim.arch.modes import Mode
from blocksim.ask.methods import STATIC
from blocksim.blocks.joints import JointState
from blocksim.common.dates import made_at
from blocksim.engines import engine_named
from blocksim.report.answerwords import ratio
from blocksim.report.environment import environment
from blocksim.report.inlinemap import inline_map
from blocksim.report.motion import Drawing, joints_of, recorded_drawing
from blocksim.report.structurepart import shown_structures
from blocksim.report.structurewords import summary_of_structures
from blocksim.simulation.recording import Recording
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Unasked, Validation, disagreements, numbered
from blocksim.studies.questions import NEAR, SLOWLY, StructureRow
from blocksim.studies.validate import ASIDE, ERROR_BOUND
from blocksim.view import style

STATES = {
    JointState.HINGE_INTRADOS: "hinge at the intrados",
    JointState.HINGE_EXTRADOS: "hinge at the extrados",
    JointState.SLIDES: "slides",
    JointState.HINGE_AND_SLIDES: "hinge and slides",
    JointState.OPEN: "open",
}


@dataclass(frozen=True, kw_only=True)
class Result:
    """A row as the page shows it; `thickest` where nothing thinner than eta = 2 was tried."""

    row: Validation
    anchor: str
    thickest: bool
    found: str
    bracket: str
    error: str
    drawing: Drawing | None
    caption: str
    words: str


@dataclass(frozen=True, kw_only=True)
class Shown:
    """A scenario and what every engine showed of it."""

    number: int
    anchor: str
    results: tuple[Result, ...]

    @property
    def row(self) -> Validation:
        """What all engines were given."""
        return self.results[0].row


def report_page(
    rows: Sequence[Validation],
    map_svg: bytes,
    machine: Mapping[str, str],
    unasked: Sequence[Unasked] = (),
    structures: Sequence[StructureRow] = (),
    structures_unasked: Sequence[Unasked] = (),
) -> str:
    """Write the page.

    Parameters
    ----------
    rows : sequence of Validation
        Of one engine or several.
    map_svg : bytes
        The map with the results.
    machine : mapping
        What the figures were measured on.
    unasked : sequence of Unasked
    structures : sequence of StructureRow
        Of the second part; left out of the page where there are none.
    structures_unasked : sequence of Unasked

    Returns
    -------
    str
        HTML that loads nothing.
    """
    pages = environment()
    pages.filters |= {
        "degrees": _degrees,
        "friction": _friction,
        "capitalised": _capitalised,
    }
    template = pages.get_template("report.html")
    engines = list(dict.fromkeys(row.engine for row in rows))
    drawn_map, dark = inline_map(map_svg, {n: name for name, n in numbered(rows).items()})
    shown = shown_structures(structures)
    return template.render(
        cases=_cases(rows),
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
        tol=" and ".join(
            f"{_percent(engine_named(engine).validated_to)} ({engine})" for engine in engines
        ),
        aside=_percent(ASIDE),
        bound=_percent(ERROR_BOUND),
        states=STATES,
        structures=shown,
        structure_sentence=summary_of_structures(structures),
        structure_misses=[row for row in structures if row.miss],
        structure_anchors={each.row.structure: each.anchor for each in shown},
        structure_unasked=structures_unasked,
        structure_near=f"{NEAR:g}",
        structure_asides=_asides(structures),
        structure_slowly=_percent(SLOWLY),
        mode_styles=style.MODES,
        modes=list(Mode),
    )


def summary(rows: Sequence[Validation]) -> str:
    """Say in a sentence or two how simulation and limit analysis agree."""
    agree = sum(not row.miss for row in rows)
    share = f"All {len(rows)}" if agree == len(rows) else f"{agree} of {len(rows)}"
    parts = [f"{share} simulated arches agree with the exact answer in every respect"]
    errors = [abs(row.error) for row in rows if row.error is not None]
    if errors:
        worst = _percent(max(errors), ".3f")
        parts.append(f"the least thickness found is off by {worst} at most")
    false = sum(row.below is Verdict.STANDS or row.above is Verdict.COLLAPSES for row in rows)
    undecided = sum(Verdict.UNDECIDED in {row.below, row.above} for row in rows)
    asked = sum((row.below is not None) + (row.above is not None) for row in rows)
    parts.append(
        f"of {asked} verdicts {_percent(ASIDE)} to either side of it "
        f"{false or 'none'} {'is' if false <= 1 else 'are'} false and "
        f"{undecided or 'none'} {'is' if undecided <= 1 else 'are'} undecided"
    )
    return "; ".join(parts) + "."


def _asides(rows: Sequence[StructureRow]) -> str:
    """Say how far inside and beyond each engine was asked."""
    engines = dict.fromkeys(row.method for row in rows if row.method not in STATIC)
    return ", ".join(
        f"{_percent(engine_named(engine).aside)} by {engine}" for engine in engines
    )


def _cases(rows: Sequence[Validation]) -> list[Shown]:
    return [
        Shown(
            number=number,
            anchor=f"case-{number}",
            results=tuple(
                _result(row, f"case-{number}-{place}")
                for place, row in enumerate(r for r in rows if r.scenario == name)
            ),
        )
        for name, number in numbered(rows).items()
    ]


def _result(row: Validation, anchor: str) -> Result:
    low, high = row.eta_low, row.eta_high
    if row.verdict is not None:
        bracket = "-"
    elif high is None:
        bracket = "none up to 2"
    elif low is None:
        bracket = f"below {ratio(high)}"
    else:
        bracket = f"{low:.6g} to {high:.6g}"
    ends = [eta for eta in (low, high) if eta is not None]
    nothing = not ends or (high is None and row.eta_limit is None)
    # Nothing stands: there is no least thickness to be aside of.
    thickest = low is not None and high is None
    caption, words = ("", "") if row.recording is None else _told(row.recording, thickest)
    return Result(
        row=row,
        anchor=anchor,
        thickest=thickest,
        found=bracket if row.verdict else "none" if nothing else ratio(fmean(ends)),
        bracket=bracket,
        error="-" if row.error is None else _percent(row.error, "+.3f"),
        drawing=None if row.recording is None else recorded_drawing(row.recording),
        caption=caption,
        words=words,
    )


def _told(recording: Recording, thickest: bool) -> tuple[str, str]:
    """Say what is drawn: a caption, and words for those who do not see it."""
    drawn, seconds = recorded_drawing(recording), float(recording.seconds(GRAVITY)[-1])
    where = "the thickest arch there is" if thickest else (
        f"{_percent(ASIDE)} below the bracket's centre"
    )  # fmt: skip
    moved = f"nothing moved in {seconds:.2f} s" if drawn.enlarged is None else (
        f"motion enlarged {drawn.enlarged:.0f} times; it took {seconds:.2f} s"
    )  # fmt: skip
    known = "".join(f"{each}, " for each in recording.problem.measures[1:2])
    active = [
        f"{math.degrees(joint.angle):+.1f}° {STATES[joint.state]}"
        for joint in joints_of(recording)
        if joint.state is not JointState.CLOSED
    ]
    words = f"Joints that take part, from the left springing to the right: {', '.join(active)}."
    caption = f"{known}{where}; {moved} (r = {recording.assembly.size:g} m)"
    return caption, words if active else "Nothing moves."


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
