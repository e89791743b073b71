"""The command line: options to questions, answers to text."""

from __future__ import annotations

import sys
from typing import NoReturn

import typer

from blocksim.cli.commands import app
from blocksim.errors import BlocksimError

WRONG_INPUT = 2
INTERRUPTED = 130


def main() -> None:
    """Run the command line; wrong input is one line and exit code 2."""
    try:
        code = app(standalone_mode=False)
    except BlocksimError as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    except Exception as error:
        # Typer's own complaints about options carry a message for people.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        _fail(" ".join(str(message()).split()))
    else:
        sys.exit(code or 0)


def _fail(message: str) -> NoReturn:
    typer.echo(f"blocksim: {message}", err=True)
    sys.exit(WRONG_INPUT)
