"""Engines by name: each has a file with an `ENGINE`, which says all there is to say of it.

An engine of one's own is known where a package offers it under the entry point group
`blocksim.engines`, or where it is named by its place, ``module:ENGINE``.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module

from blocksim.common.checks import require
from blocksim.common.errors import InputError, MissingPart
from blocksim.common.later import Installed, Later, loaded_here
from blocksim.engines.base import Engine, Method

GROUP = "blocksim.engines"
"""Entry points by which packages offer engines."""


def _engine(name: str) -> Engine:
    """Load the file of an engine, which has its name."""
    return import_module(f"blocksim.engines.{name}").ENGINE


class _Own(Installed[Engine]):
    """Engines of other packages, and those that were made known."""

    def __init__(self, group: str) -> None:
        super().__init__(group)
        self.known: dict[str, Engine] = {}

    def __getitem__(self, name: str) -> Engine:
        """Return an engine by its name, or load it."""
        return self.known.get(name) or make_known(super().__getitem__(name), name)

    def __contains__(self, name: object) -> bool:
        """Tell whether an engine is known by that name, without loading it."""
        return name in self.known or super().__contains__(name)


_OWN = _Own(GROUP)
ENGINES = Later(
    {
        name: partial(_engine, name)
        # From the cheapest to the dearest.
        for name in ("direct", "pymunk", "pybullet", "mujoco")
    },
    beyond=_OWN,
)
"""All there are, as `method` takes them."""
NAMES = ENGINES.shipped
"""Of those that are blocksim's own, from the cheapest to the dearest."""


def engine_named(name: str, field: str = "method") -> Engine:
    """Return an engine by its name or its place, whether it can run here or not.

    `name`: A key of `ENGINES`, or ``module:ENGINE``, where modules are looked for in the
        working directory, too.
    `field`: What errors call it.
    """
    if name in ENGINES:
        return ENGINES[name]
    known = f"one of {', '.join(ENGINES)}, or an engine of your own as module:ENGINE"
    require(":" in name, field, name, known)
    return make_known(loaded_here(field, name), name)


def make_known(engine: object, place: str) -> Engine:
    """Make an engine known by its name, to all questions of this process.

    `place`: Where it was found, as errors name it.
    """
    if not isinstance(engine, Engine):
        raise InputError("method", place, "an Engine of blocksim.engines.base")
    shipped = engine.name in NAMES and ENGINES[engine.name] is not engine
    require(not shipped, "method", engine.name, "a name of its own: blocksim has that engine")
    if engine.name not in NAMES:
        _OWN.known[engine.name] = engine
    return engine


def get_engine(asked: str | Method) -> Engine:
    """Return an engine that can run here: itself, or by its name or place."""
    engine = engine_named(asked) if isinstance(asked, str) else asked
    assert isinstance(engine, Engine)  # noqa: S101 - a method that moves blocks was chosen
    if engine.missing:
        raise MissingPart(engine.name, engine.missing)
    return engine
