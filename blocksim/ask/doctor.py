"""What is installed, and what each method can do here."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim.ask.methods import METHODS, missing


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One method on this machine.

    Parameters
    ----------
    method : str
    sees : str
    finest : float
        Smallest relative width of a bracket it can answer for.
    remedy : str or None
        How to get what is missing; None where it can run.
    """

    method: str
    sees: str
    finest: float
    remedy: str | None


def examine() -> list[Finding]:
    """Look at every method of the ladder."""
    return [
        Finding(
            method=method.name, sees=method.sees, finest=method.finest, remedy=missing(method)
        )
        for method in METHODS.values()
    ]
