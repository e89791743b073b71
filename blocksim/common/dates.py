"""When something was made, as pages say it."""

from __future__ import annotations

import os
from datetime import UTC, datetime

from blocksim.common.errors import InputError

VARIABLE = "SOURCE_DATE_EPOCH"
LATEST = 253402300799
"""The last second of the year 9999."""


def is_dated() -> bool:
    """Tell whether pages are to be the same whenever they are made, and say no times."""
    return VARIABLE in os.environ


def made_at() -> str:
    """Return the time of `present` in words."""
    return present().strftime("%Y-%m-%d %H:%M UTC")


def present() -> datetime:
    """Return the present time, or that of SOURCE_DATE_EPOCH, so that pages can be made again.

    As https://reproducible-builds.org/specs/source-date-epoch has it.
    """
    given = os.environ.get(VARIABLE)
    if given is None:
        return datetime.now(UTC)
    if given.isascii() and given.isdigit() and len(given) < 16 and int(given) <= LATEST:
        return datetime.fromtimestamp(int(given), UTC)
    raise InputError(VARIABLE, given, "whole seconds since 1970, or unset")
