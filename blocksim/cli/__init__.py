"""The command line: options to questions, answers to text.

What draws or moves blocks takes a second to import, and is imported where it is asked for.
"""

from __future__ import annotations

import io
import os
import sys
import traceback
import warnings
from contextlib import suppress

import click

from blocksim.cli.app import app as app
from blocksim.cli.app import run
from blocksim.common import interrupts
from blocksim.common.errors import BlocksimError, MachineError, in_line

WRONG_INPUT = 2
CRASHED = 70
"""Exit code after a failure of blocksim. Python's own 1 would say that the arch collapses."""
MACHINE = 74
"""A full disk, no permission, no memory; of that number in sysexits.h, too."""
LONGEST = 1000
"""Letters of what is said of wrong input."""
PLAIN = {
    "is not a valid float": "must be a number",
    "is not a valid integer": "must be a whole number",
}
"""Words of click, and those that are said instead."""
CLOSED = 141
"""Exit code that a shell gives for the signal of a closed pipe."""


def main() -> None:
    """Run the command line. Wrong input and failures of the machine are one line."""
    interrupts.install()
    _prepare()
    code = CRASHED
    with suppress(KeyboardInterrupt), interrupts.Told():
        code = _code()
    interrupts.done()
    # An interrupt counts whatever became of it on its way: libraries turn it into others.
    if interrupts.code():
        interrupts.say()
        code = interrupts.code()
        # Where a signal came while Python ran a string, as it does to make a dataclass, `python
        # -m` ends by SIGINT whatever the code is; it forgets this when it runs another string.
        exec("")  # noqa: S102
    sys.exit(code)


def _prepare() -> None:
    """See that what is said can be written, and that no library says anything by itself."""
    for number in (0, 1, 2):
        # What is closed would be the number of the next file, and hear what is said.
        with suppress(OSError):
            os.fstat(number)
            continue
        os.open(os.devnull, os.O_RDWR)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    for stream in (sys.stdout, sys.stderr):
        # Either is None where it was closed.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _code() -> int:
    """Run the command line and return its exit code."""
    try:
        return run()
    except SystemExit as end:
        # With 1 rich leaves where nobody reads on.
        return CLOSED if end.code == 1 else int(end.code or 0)
    except BrokenPipeError:
        # What is left cannot be written; Python would say so at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return CLOSED
    except (MachineError, OSError) as error:
        return _complain(str(error) or type(error).__name__, MACHINE)
    except MemoryError:
        return _complain("there is not enough memory for this", MACHINE)
    except BlocksimError as error:
        return _complain(str(error))
    except click.ClickException as error:
        message = " ".join(error.format_message().split())
        for said, plain in PLAIN.items():
            message = message.replace(said, plain)
        return _complain(message)
    except Exception:
        for line in traceback.format_exc().splitlines():
            _tell(line)
        return CRASHED


def _complain(message: str, code: int = WRONG_INPUT) -> int:
    _tell(f"blocksim: {message}")
    return code


def _tell(line: str) -> None:
    if not interrupts.code():
        with suppress(OSError):
            click.echo(in_line(line, LONGEST), err=True)
