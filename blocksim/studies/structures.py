"""The second part of `validate`: shipped structures held against their sources."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

from blocksim.ask.methods import choose
from blocksim.blocks.entries import ExpectEntry
from blocksim.common.errors import InputError
from blocksim.common.progress import Progress, silent
from blocksim.engines import engine_named
from blocksim.kinds.files import shipped_structures
from blocksim.kinds.loading import Known, load_known
from blocksim.studies.agreement import Unasked, answered
from blocksim.studies.questions import StructureRow, answer
from blocksim.studies.validate import usual

SPREAD = "spread"


def structures(*, quick: bool) -> list[Known]:
    """Return the shipped structures, or those marked quick."""
    every = [load_known(name) for name in shipped_structures()]
    return [known for known in every if known.quick or not quick]


def unasked_structures(
    chosen: Sequence[Known], engines: Iterable[str] | None = None
) -> list[Unasked]:
    """Tell what `validate_structures` does not ask, and why; arguments as there."""
    found: list[Unasked] = []
    for engine in usual("structures") if engines is None else engines:
        reasons: dict[str, list[str]] = {}
        for known in chosen:
            for expected in known.expect:
                why = _refused(known, expected, engine)
                if why and known.name not in reasons.setdefault(why, []):
                    reasons[why].append(known.name)
        found += [
            Unasked(engine=engine, scenarios=tuple(names), why=why)
            for why, names in reasons.items()
        ]
    return found


def validate_structures(
    chosen: Sequence[Known],
    engines: Iterable[str] | None = None,
    *,
    workers: int = 2,
    progress: Progress = silent,
) -> list[StructureRow]:
    """Ask limit analysis and engines about structures and compare.

    `engines`: Those usual for structures, as far as they are installed, if left out.
        `unasked_structures` tells what each is not asked.
    `workers`: Processes; 1 runs in this one.
    Returns: In the order of structures, what is known of them, then methods, `limit` first.
    """
    names = tuple(dict.fromkeys(usual("structures") if engines is None else engines))
    for name in names:
        engine_named(name, "methods")
    jobs = [(known.name, known) for known in chosen]
    found = answered(partial(answers, engines=names), jobs, workers, progress)
    return [row for rows in found for row in rows]


def answers(known: Known, engines: Sequence[str]) -> list[StructureRow]:
    """Answer all that is asked of one structure."""
    return [
        answer(known, expected, method)
        for expected in known.expect
        for method in ("limit", *engines)
        if not _refused(known, expected, method)
    ]


def _refused(known: Known, expected: ExpectEntry, method: str) -> str:
    """Say why a method is not asked; nothing where it is."""
    if method == "limit":
        return "" if known.problem.shaking is None else _beyond(known, method)
    engine = engine_named(method)
    remedy = engine.missing
    if remedy:
        return f"not here: {remedy}"
    if expected.over == SPREAD and not engine.moves_supports:
        return "it moves no supports"
    blocks = len(known.problem.assembly.blocks)
    if blocks > engine.most_blocks:
        return f"more than {engine.most_blocks} blocks"
    return _beyond(known, method)


def _beyond(known: Known, method: str) -> str:
    """Say why a method cannot answer what is asked; nothing where it can."""
    try:
        choose(method, problem=known.problem)
    except InputError as error:
        return error.allowed
    return ""
