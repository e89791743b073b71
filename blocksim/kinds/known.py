"""Shipped structures of which the answer is known, each with its source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

from blocksim.blocks.entries import AROUND, ExpectEntry, around_of
from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.kinds.files import named_file, structure_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Known:
    """A structure, and what its source says of it.

    Parameters
    ----------
    name : str
    problem : Problem
    expect : tuple of ExpectEntry
    quick : bool
        Whether `validate --quick` takes it.
    """

    name: str
    problem: Problem
    expect: tuple[ExpectEntry, ...]
    quick: bool


def load_known(name: str) -> Known:
    """Read a shipped structure with what is expected of it.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.
    """
    with named_file(name) as data:
        problem = structure_of(data)
        table = cast("dict[str, Any]", data)
        around = around_of({key: table[key] for key in table if key in AROUND})
        for at, each in enumerate(around.expect):
            valued = each.over is not None and each.value is not None
            field = f"expect[{at}]"
            judged = each.verdict is not None
            require(valued != judged, field, each.over, "either over and value, or verdict")
        return Known(name=name, problem=problem, expect=around.expect, quick=around.quick)
