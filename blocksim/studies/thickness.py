"""How thin an arch whose modes are known can be, and how it falls, by one engine."""

from __future__ import annotations

from dataclasses import replace

from blocksim.arch import limit
from blocksim.arch.circular import ETA_MAX, Arch
from blocksim.arch.limit.mechanism import mechanism
from blocksim.arch.modes import Mode, observed_mode
from blocksim.ask.bracket import bracket
from blocksim.blocks.entries import ExpectEntry
from blocksim.engines import engine_named, get_engine
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.loading import Known
from blocksim.simulation.observation import observe
from blocksim.simulation.verdict import Verdict
from blocksim.studies.agreement import Row, agree

ERROR_BOUND = 0.002
"""A bracket whose centre is farther than this from `limit` is a miss."""
ASIDE = 0.01
"""How far below and above the bracket arches are let go."""


def thinnest(row: Row, known: Known, expected: ExpectEntry, tol: float | None = None) -> Row:
    """Ask an engine how thin an arch can be and how it falls, and compare.

    `tol`: Relative width of the bracket; by default what the engine says (`validated_to`).
    """
    maker, engine = known.problem.maker, row.method
    assert isinstance(maker, CircularArch)  # noqa: S101 - of which modes are known
    thick = maker.but(eta=1.0)
    asked = bracket(
        thick,
        over="thickness",
        method=engine,
        tol=tol or engine_named(engine).validated_to,
        confirm=False,
        reduce=False,
    )
    found, shape = asked.arch, _shape(thick)
    assert found is not None  # noqa: S101
    below = None
    if found.eta_low is not None:
        thin = maker.but(eta=found.centre * (1 - ASIDE) if found.centre else found.eta_low)
        below = observe(thin.problem(), engine)
        row = replace(
            row,
            at_low=below.verdict,
            mode_in_motion=observed_mode(below.joints_in_motion, _shape(thin)),
            recording=below.motion.recording if below.motion else None,
        )
    # Thicker than eta = 2 there is no arch to try.
    if found.centre is not None and found.centre * (1 + ASIDE) <= ETA_MAX:
        above = maker.but(eta=found.centre * (1 + ASIDE)).problem()
        row = replace(row, at_high=observe(above, engine).verdict)
    # Where the limit is the thickest arch there is, nothing above it can be tried.
    middle = found.centre or (None if asked.undecided else found.eta_low)
    error = None if middle is None or not found.eta_limit else middle / found.eta_limit - 1
    row = replace(
        row,
        question="thickness",
        unit="r",
        half_angle=shape.half_angle,
        weight=shape.weight,
        modes_published=tuple(map(Mode, expected.modes or ())),
        modes_theory=found.modes_theory,
        published="" if expected.eta is None else f"{expected.eta:.6g}",
        expected=found.eta_limit,
        mode_limit=found.mode_limit,
        low=found.eta_low,
        high=found.eta_high,
        value=middle,
        error=error,
        mode=found.mode,
    )
    return replace(row, miss="; ".join(_misses(row)), note=_note(row, maker))


def _shape(maker: CircularArch) -> Arch:
    assert maker.shape is not None  # noqa: S101 - of a symmetric arch modes are known
    return maker.shape


def _misses(row: Row) -> list[str]:
    """List what disagrees with limit analysis."""
    misses: list[str] = []
    if row.expected is None:
        if row.high is not None:
            misses.append("stands, where nothing does")
    elif row.error is None:
        fell = "" if row.low is None else f": the thickest that fell is {row.low:.6g}"
        misses.append(f"no bracket{fell}")
    elif abs(row.error) > ERROR_BOUND:
        misses.append(f"error {row.error:+.2%}")
    if not agree(row.mode, row.mode_limit, row.modes_theory):
        misses.append(f"mode {row.mode or 'unnamed'}, limit says {row.mode_limit or 'unnamed'}")
    if row.at_low is not Verdict.COLLAPSES:
        misses.append(f"{row.at_low or 'nothing tried'} 1 % below")
    if row.at_high not in {Verdict.STANDS, None}:
        misses.append(f"{row.at_high} 1 % above")
    return misses


def _note(row: Row, maker: CircularArch) -> str:
    """Say why modes differ, where that is known, and what else to keep in mind."""
    notes: list[str] = []
    if row.mode is not row.mode_limit:
        if agree(row.mode, row.mode_limit, row.modes_theory):
            notes.append("on a line of the map, where both modes coincide")
        elif row.low is not None:
            there = mechanism(_shape(maker.but(eta=row.low)), maker.known_friction).mode
            said = there or "unnamed"
            notes.append(f"at the bracket's lower end limit analysis says {said}")
    if row.mode_in_motion and row.mode_in_motion is not row.mode:
        notes.append(f"in motion, 1 % below, the mode is {row.mode_in_motion}")
    most = get_engine(row.method).most_friction
    if maker.known_friction > most:
        arch = _shape(maker)
        there = limit.least_thickness(arch.half_angle, most, arch.voussoirs, arch.weight)
        least = "nothing stands" if there.eta is None else f"{there.eta:.6g}, {there.mode}"
        notes.append(f"friction is {most:g} in the engine, where limit analysis says {least}")
    return "; ".join(notes)
