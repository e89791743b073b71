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
    """Return the present time, or that of SOURCE_DATE_EPOCH, so that pages can be made again.

    As https://reproducible-builds.org/specs/source-date-epoch has it.
    """
    given = os.environ.get(VARIABLE)
    if given is None:
        when = datetime.now(UTC)
    elif given.isascii() and given.isdigit() and len(given) < 16 and int(given) <= LATEST:
        when = datetime.fromtimestamp(int(given), UTC)
    else:
        raise InputError(VARIABLE, given, "whole seconds since 1970, or unset")
    return when.strftime("%Y-%m-%d %H:%M UTC")
