"""Engines by name: each has a file with an `ENGINE`, which says all there is to say of it."""

from __future__ import annotations

from functools import partial
from importlib import import_module

from blocksim.common.errors import MissingPart
from blocksim.common.later import Later
from blocksim.engines.base import Engine


def _engine(name: str) -> Engine:
    """Load the file of an engine, which has its name."""
    return import_module(f"blocksim.engines.{name}").ENGINE


NAMES = ("direct", "pymunk", "pybullet", "mujoco")
"""From the cheapest to the dearest, as `method` takes them."""
ENGINES = Later({name: partial(_engine, name) for name in NAMES})


def get_engine(name: str) -> Engine:
    """Return an engine by name.

    Raises
    ------
    MissingPart
        If its library is not installed.
    """
    engine = ENGINES[name]
    if engine.missing:
        raise MissingPart(name, engine.missing)
    return engine
