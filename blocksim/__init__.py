"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

import importlib as _importlib
import pkgutil as _pkgutil
import re as _re
from functools import cache as _cache

from blocksim.common import interrupts
from blocksim.common import shown as _shown
from blocksim.common.version import __version__ as __version__

if interrupts.is_program():
    # Before the imports that commands make.
    interrupts.install()

# The package is above all its rooms, and names who shows things of theirs in a notebook.
_shown.show_by(lambda: _importlib.import_module("blocksim.notebook"))


@_cache
def _places() -> dict[str, str]:
    """Return the module of each public name, as `__init__.pyi` tells type checkers."""
    stub = (_pkgutil.get_data(__name__, "__init__.pyi") or b"").decode()
    return {name: module for module, name in _re.findall(r"from (\S+) import (\w+)", stub)}


def __getattr__(name: str) -> object:
    """Load a public name; `__all__` is the list of them."""
    if name == "__all__":
        return sorted(_places())
    if name in _places():
        found = getattr(__import__(_places()[name], fromlist=[name]), name)
        globals()[name] = found
        return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return sorted({*globals(), *_places()})
