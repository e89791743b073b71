"""Structures on the command line: files, drawings, shipped ones, kinds by name."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.problem import Problem
from blocksim.cli.acting import Loading
from blocksim.cli.built import Given
from blocksim.cli.options import (
    named_options,
    option_of,
    parameters_of,
    refuse,
    require_given,
)
from blocksim.cli.road import loaded
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.kinds import KINDS, own_kind
from blocksim.kinds.changes import edited
from blocksim.kinds.files import is_drawing, load_structure, structure_of
from blocksim.reading.asked import ROLES, Reading


def structure(scene: str, given: Given, loading: Loading) -> Problem[Any]:
    """Read or make a structure and put on it what the options say."""
    changes, sizes = parameters_of(given.parameters), given.sizes
    for name, value in sizes.items():
        require(name not in changes, option_of(name), value, f"left out where --with {name} is")
    changes |= sizes
    heavy = given.unit_weight
    if heavy is not None:
        require_unit_weight("--unit-weight", heavy)
    density = None if heavy is None else 1000 * heavy
    if scene in KINDS or _is_place(scene):
        require_given(" (for example --mu 0.7)", mu=given.friction)
        refuse(given.drawn, why="left out: it is of drawings, and this is a kind")
    try:
        if scene in KINDS or _is_place(scene):
            own = () if scene in KINDS else (own_kind(scene),)
            name = own[0].name if own else scene
            table = edited({"kind": name}, changes, density, *own, depth=given.depth)
            built = structure_of(table, *own)
        else:
            if is_drawing(scene):
                require_given(mu=given.friction)
            built = load_structure(
                scene,
                changes,
                density,
                tolerance=given.tolerance,
                depth=given.depth,
                reading=reading_of(given.unit, given.layer, given.snap),
            )
    except InputError as error:
        name = error.field.partition("[")[0]
        if name not in changes:
            raise
        if name in sizes:
            raise InputError(option_of(name), error.value, error.allowed) from None
        raise InputError("--with", f"{error.field}={error.value}", error.allowed) from None
    return loaded(built, given, loading)


def reading_of(unit: str | None, layer: list[str] | None, snap: float | None = None) -> Reading:
    """Read what `--unit`, `--layer` and `--snap` say of a drawing."""
    layers: dict[str, list[str]] = {}
    for each in layer or ():
        role, _, name = each.partition("=")
        ok = bool(name) and role in ROLES
        require(ok, "--layer", each, f"{', '.join(f'{one}=NAME' for one in ROLES)}")
        layers.setdefault(role, []).append(name)
    metres: float | str | None = unit
    with suppress(TypeError, ValueError):
        metres = float(unit)  # type: ignore[arg-type]
    with named_options():
        return Reading(unit=metres, layers=layers, snap=snap)


def _is_place(scene: str) -> bool:
    """Tell the place of a kind of one's own, ``module:CLASS``, from a file's name."""
    module, colon, name = scene.partition(":")
    named = all(part.isidentifier() for part in module.split("."))
    return bool(colon) and named and name.isidentifier()
