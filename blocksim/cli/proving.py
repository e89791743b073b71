"""The command verify, and the proofs of answers."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from blocksim.cli.arguments import NEEDED, argument
from blocksim.cli.output import say, write
from blocksim.common.errors import InputError
from blocksim.common.files import read_file

if TYPE_CHECKING:
    from blocksim.limit.proof import Proof

LARGEST = 1 << 28
"""Bytes of proofs that are read."""


def verify(
    file: str = argument("Proof that check --proof has written.", default=NEEDED),
) -> None:
    """Check a proof that blocks stand or fall, in rational arithmetic."""
    from blocksim.verify import checked

    text = read_file(file, "proof", "a file", LARGEST).decode("utf-8", "replace")
    try:
        found = checked(text)
    except ValueError as error:
        raise InputError("proof", str(error), "one that holds", where=file) from None
    say(*found.splitlines())


def write_proof(method: str, proofs: Sequence[Proof], path: Path | None) -> None:
    """Write the proofs of an answer, where they are asked for."""
    if path is None:
        return
    from blocksim.limit.proof import proof_record

    if method != "limit":
        raise InputError("--proof", str(path), f"left out for {method}: limit proves")
    if not proofs:
        raise InputError("--proof", str(path), "left out: no proof of this answer was found")
    records = [proof_record(each) for each in proofs]
    text = json.dumps(records[0] if len(records) == 1 else records)
    write(path, text.encode(), silent=True)
