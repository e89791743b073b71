"""How long work reports how far it is, without knowing who listens."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and what is going on."""


def silent(share: float, what: str) -> None:
    """Ignore progress."""
