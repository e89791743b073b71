"""Engines by name: each has a file with an `ENGINE`, which says all there is to say of it."""

from __future__ import annotations

from blocksim.common.errors import MissingPart
from blocksim.engines import direct, mujoco, pybullet, pymunk
from blocksim.engines.base import Engine

ENGINES: dict[str, Engine] = {
    module.ENGINE.name: module.ENGINE for module in (direct, pymunk, pybullet, mujoco)
}
"""From the cheapest to the dearest, as `method` takes them."""


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
