"""The command verify, and proofs that check writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

from blocksim.ask.check import Check
from blocksim.cli.arguments import Argument
from blocksim.cli.output import say
from blocksim.common.errors import InputError
from blocksim.common.files import read_file, write_whole

LARGEST = 1 << 28
"""Bytes of a proof that is read."""


def verify(
    file: Annotated[str, Argument(about="Proof that check --proof has written.")],
) -> None:
    """Check a proof that blocks stand or fall, in rational arithmetic."""
    from blocksim.verify import checked

    text = read_file(file, "proof", "a file", LARGEST).decode("utf-8", "replace")
    try:
        say(checked(text))
    except ValueError as error:
        raise InputError("proof", str(error), "one that holds", where=file) from None


def write_proof(answer: Check, path: Path | None) -> None:
    """Write the proof of a verdict, where one is asked for.

    Raises
    ------
    InputError
        If there is none, or it cannot be written.
    """
    if path is None:
        return
    from blocksim.limit.proof import proof_record

    if answer.method != "limit":
        raise InputError("--proof", str(path), f"left out for {answer.method}: limit proves")
    if answer.proof is None:
        raise InputError("--proof", str(path), "left out: no proof of this verdict was found")
    text = json.dumps(proof_record(answer.proof))
    write_whole(path, lambda file: file.write(text.encode()))
