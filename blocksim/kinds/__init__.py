"""Kinds of structures by name: parameters in, blocks and joints out."""

from __future__ import annotations

from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from blocksim.common.errors import InputError
from blocksim.common.later import Installed, Later, loaded_here

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind


def _kind(place: str) -> Any:
    """Load a kind, given as file and class."""
    file, _, name = place.partition(".")
    return getattr(import_module(f"blocksim.kinds.{file}"), name)


PLACES = {
    "circular-arch": "circular.CircularArch",
    "pointed-arch": "pointed.PointedArch",
    "elliptic-arch": "elliptic.EllipticArch",
    "parabolic-arch": "parabolic.ParabolicArch",
    "catenary-arch": "catenary.CatenaryArch",
    "basket-handle-arch": "basket.BasketHandleArch",
    "flat-arch": "flat.FlatArch",
    "portal": "portal.Portal",
    "arcade": "arcade.Arcade",
    "wall": "wall.Wall",
    "column": "column.Column",
    "stack": "stack.Stack",
    "rubble": "rubble.Rubble",
    "dome": "dome.Dome",
    "barrel-vault": "skewarch.BarrelVault",
    "skew-arch": "skewarch.SkewArch",
    "groin-vault": "groinvault.GroinVault",
    "tower": "tower.Tower",
    "return-wall": "returnwall.ReturnWall",
    "corbel-dome": "corbeldome.CorbelDome",
}
"""File and class of each, by its name."""
KINDS: Later[type[Kind[Any]]] = Later(
    {name: partial(_kind, place) for name, place in PLACES.items()},
    beyond=Installed("blocksim.kinds"),
)
"""All there are, of the plane and in space.

Packages offer theirs under the entry point group `blocksim.kinds`.
"""


def own_kind(place: str) -> type[Kind[Any]]:
    """Return a kind of one's own by its place, ``module:CLASS``."""
    from blocksim.blocks.maker import Kind

    found = loaded_here("kind", place)
    if not (isinstance(found, type) and issubclass(found, Kind)):
        raise InputError("kind", place, "a Maker or SolidMaker of blocksim, as module:CLASS")
    return cast("type[Kind[Any]]", found)
