"""Ctrl-C and the request to end, at any moment: one line, and the exit code of a shell.

Python itself says them as tracebacks, and imports take a second in which they are likely. So
the program's first import is this module, which imports next to nothing.
"""

from __future__ import annotations

import os
import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from sys import UnraisableHookArgs
    from types import TracebackType

SIGINT, SIGTERM = 2, 15
CODES = {SIGINT: 130, SIGTERM: 143}
"""As a shell says it."""
TWICE = 1.0
"""Seconds in which the same wish counts once: `timeout` sends its signal twice."""
AGAIN = 0.01
"""Seconds after which it is told again what Python could not raise."""


class _State:
    """What the handler goes by."""

    working = False
    """There is work that has to be told: files half-written, processes, a progress bar."""
    waiting = False
    """Not now: it is told when this ends."""
    code = 0
    """Exit code of the signal that came."""
    program = 0
    """Process that says so: none of its workers does."""
    since = 0.0


def is_program() -> bool:
    """Tell whether blocksim is the program that runs, and no part of another."""
    name = os.path.basename(sys.argv[0]) if getattr(sys, "argv", None) else ""  # noqa: PTH119
    # While Python looks for the module to run, -m stands for its name.
    return name.partition(".")[0] == "blocksim" or (
        name == "-m" and "blocksim" in sys.orig_argv
    )


def install() -> None:
    """Take both signals; before there is any work they end the process at once."""
    # The import of signals takes a while, too.
    sys.excepthook, sys.unraisablehook = _say_unless_interrupted, _tell_again
    if not any("multiprocessing" in word for word in sys.orig_argv):
        _State.program = os.getpid()
    import signal

    for number in CODES:
        signal.signal(number, _handle)


def done() -> None:
    """Take no more signals: nothing is left that they would end, but Python at its end."""
    if os.getpid() == _State.program:
        import signal

        for number in (*CODES, signal.SIGALRM):
            signal.signal(number, signal.SIG_IGN)


class Told:
    """Work inside is told by `KeyboardInterrupt` that it has to end, so that it cleans up."""

    def __enter__(self) -> None:
        _State.working, _State.code = True, 0

    def __exit__(self, *_: object) -> None:
        _State.working = False


class KeptBack:
    """Nothing is told inside, where half of something would be left, but after it."""

    def __enter__(self) -> None:
        self._inside, _State.waiting = _State.waiting, True

    def __exit__(self, *_: object) -> None:
        _State.waiting = self._inside
        if _State.code and _State.working and not _State.waiting:
            raise KeyboardInterrupt


class AtOnce:
    """The process may end at once inside, as before there was any work."""

    def __enter__(self) -> None:
        self._outside, _State.working = _State.working, False

    def __exit__(self, *_: object) -> None:
        _State.working = self._outside


def code() -> int:
    """Return the exit code of the signal that came, 0 where none did."""
    return _State.code


def say() -> None:
    """Say in one line that the program was interrupted."""
    if os.getpid() == _State.program:
        try:  # noqa: SIM105 - contextlib is an import more
            os.write(2, b"blocksim: interrupted\n")
        except OSError:
            pass


def _end(known: int) -> None:
    say()
    os._exit(known)


def _handle(number: int, _: object) -> None:
    known = CODES[number]
    if not _State.working:
        _end(known)
    if _State.code:
        if time.monotonic() - _State.since > TWICE:
            _end(known)
        return
    _State.code, _State.since = known, time.monotonic()
    if not _State.waiting:
        raise KeyboardInterrupt


def _say_unless_interrupted(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    if issubclass(kind, KeyboardInterrupt):
        _end(_State.code or CODES[SIGINT])
    sys.__excepthook__(kind, error, trace)


def _tell_again(lost: UnraisableHookArgs) -> None:
    """Tell it once more, a moment later, where it came in a callback: Python drops it there."""
    if not issubclass(lost.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    import signal

    signal.signal(signal.SIGALRM, _again)
    signal.setitimer(signal.ITIMER_REAL, AGAIN)


def _again(*_: object) -> None:
    if not _State.working:
        _end(_State.code)
    if not _State.waiting:
        raise KeyboardInterrupt
