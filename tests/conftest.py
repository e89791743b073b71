"""One profile for all properties: the same examples in every run, time not asserted."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("blocksim", deadline=None, derandomize=True, database=None)
settings.load_profile("blocksim")
