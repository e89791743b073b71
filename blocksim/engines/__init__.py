"""Engines by name; each library is imported only when its engine is asked for."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import NamedTuple

from blocksim.common.errors import MissingPart
from blocksim.engines.base import Engine


class _Place(NamedTuple):
    library: str
    module: str
    attribute: str
    remedy: str


_PLACES = {
    "direct": _Place("scipy", "blocksim.engines.direct", "Direct", "pip install scipy"),
    "pymunk": _Place(
        "pymunk", "blocksim.engines.pymunk", "Chipmunk", "pip install 'pymunk>=7.3'"
    ),
    "pybullet": _Place(
        "pybullet",
        "blocksim.engines.pybullet",
        "Bullet",
        "pip install pybullet with Python 3.11 or older, for which it has wheels",
    ),
    "mujoco": _Place(
        "mujoco",
        "blocksim.engines.mujoco",
        "MultiJoint",
        "pip install 'mujoco-core>=4.0.1'",
    ),
}

ENGINES: tuple[str, ...] = tuple(_PLACES)
"""Names of the engines, as `method` takes them."""


def remedy(name: str) -> str | None:
    """Tell how to install an engine's library; None where it is there."""
    place = _PLACES[name]
    return None if find_spec(place.library) else place.remedy


def get_engine(name: str) -> Engine:
    """Return an engine by name.

    Raises
    ------
    MissingPart
        If its library is not installed.
    """
    missing = remedy(name)
    if missing:
        raise MissingPart(name, missing)
    place = _PLACES[name]
    engine: Engine = getattr(import_module(place.module), place.attribute)()
    return engine
