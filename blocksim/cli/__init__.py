"""The command line: options to questions, answers to text."""

from __future__ import annotations

import signal
import sys
import traceback
from contextlib import suppress
from typing import NoReturn

import typer

from blocksim.cli.commands import app
from blocksim.common.errors import BlocksimError

WRONG_INPUT = 2
CRASHED = 70
"""After what should not happen: Python's own 1 would say that the arch collapses."""
INTERRUPTED, CLOSED, TERMINATED = 130, 141, 143
"""As a shell says it of the signals for an interrupt, a closed pipe, an end."""


def main() -> None:
    """Run the command line; wrong input is one line and exit code 2."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        code = app(standalone_mode=False)
    except BlocksimError as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    except SystemExit as end:
        # With 1 typer and rich leave where nobody reads on.
        sys.exit(CLOSED if end.code == 1 else end.code)
    except OSError as error:
        _fail(str(error))
    except Exception as error:
        message = _complaint(error)
        if message is None:
            traceback.print_exc()
            sys.exit(CRASHED)
        _fail(message)
    else:
        sys.exit(code or 0)


def _complaint(error: Exception) -> str | None:
    """Return what typer says of options, in one line with the value it may leave out."""
    message = getattr(error, "format_message", None)
    if message is None:
        return None
    said = " ".join(str(message()).split())
    details = getattr(error.__cause__, "errors", None)
    if details is None:
        return said
    given = repr(details()[0]["input"])
    return said if given in said else f"{said}, not {given}"


def _terminate(*_: object) -> NoReturn:
    """End as an interrupt does: the default would leave the semaphores of processes behind."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # `timeout` sends it twice
    sys.exit(TERMINATED)


def _fail(message: str) -> NoReturn:
    with suppress(OSError):
        typer.echo(f"blocksim: {message}", err=True)
    sys.exit(WRONG_INPUT)
