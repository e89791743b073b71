"""Answers of a long study, kept as they come: a study that was stopped goes on where it was."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from analysis.rows import provenance
from blocksim.common.processes import done

Case = TypeVar("Case")
Row = dict[str, float | int | str | bool | None]


def answers(
    path: Path, cases: Sequence[Case], ask: Callable[[Case], Row], processes: int
) -> list[Row]:
    """Ask about every case that a file has no row of yet.

    `path` has JSON lines, one a case: delete it after a change of what answers. Cases may be
    anything that their `repr` tells apart. `ask` is called in other processes unless
    `processes` is 1. Rows are in the order of the cases, with the keys of `provenance`, too.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    kept = _read(path)
    left = [case for case in cases if repr(case) not in kept]
    made = provenance()
    with path.open("a", encoding="utf-8") as file:
        for at, found in done(ask, left, processes):
            # What answered is said with each answer: a study that goes on may be by other code.
            case, row = repr(left[at]), {**found, **made}
            kept[case] = row
            file.write(json.dumps({"case": case, "row": row}) + "\n")
            file.flush()
            sys.stderr.write(f"{path.stem}: {len(kept)} of {len(cases)}\r")
    return [kept[repr(case)] for case in cases]


def _read(path: Path) -> dict[str, Row]:
    """Read what is there; a line cut short by a kill is left out, and ended."""
    if not path.exists():
        return {}
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole, encoding="utf-8")
    lines = [json.loads(line) for line in whole.splitlines()]
    return {line["case"]: line["row"] for line in lines}
