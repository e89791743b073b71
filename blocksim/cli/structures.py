"""Structures on the command line: files, drawings, shipped ones, kinds by name."""

from __future__ import annotations

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.problem import Problem
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.cli.options import Given, Loading, option_of, parameters_of, require_given
from blocksim.cli.road import loaded
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import read_file, toml_of
from blocksim.kinds import KINDS, SOLID_KINDS, own_kind
from blocksim.kinds.files import (
    changed,
    is_drawing,
    load_any,
    shipped_structures,
    structure_of,
    weighed,
    with_friction,
)

LARGEST_PEEK = 1 << 20
"""Bytes of a TOML file that are looked at to tell a structure from a scenario."""


def is_structure(scene: str | None) -> bool:
    """Tell a structure from a scenario of an arch: by its name, or by what is in the file."""
    if scene in KINDS or scene in SOLID_KINDS or scene in shipped_structures():
        return True
    if scene is None:
        return False
    if _is_place(scene):
        return True
    if is_drawing(scene) or scene.lower().endswith(".json"):
        return True
    if not scene.endswith(".toml"):
        return False
    try:
        table = toml_of(read_file(scene, "structure", "a file", LARGEST_PEEK))
    except ValueError:
        return False  # the reader of scenarios says what is wrong with it
    return "blocks" in table or "kind" in table


def structure(scene: str, given: Given, loading: Loading) -> Problem | SpatialProblem:
    """Read or make a structure and put on it what the options say.

    Raises
    ------
    InputError
        If the file cannot be used, or an option is one of arches only.
    """
    for name, value in given.of_arches.items():
        allowed = "left out: the file or --with says what is built"
        require(value is None, option_of(name), value, allowed)
    changes = parameters_of(given.parameters)
    heavy = given.unit_weight
    if heavy is not None:
        require_unit_weight("--unit-weight", heavy)
    density = None if heavy is None else 1000 * heavy
    try:
        if scene in SOLID_KINDS:
            require_given(mu=given.friction)
            allowed = "left out: a kind of structure has no gaps"
            require(given.tolerance is None, "--tolerance", given.tolerance, allowed)
            maker = SOLID_KINDS[scene](friction=given.friction, density=density)
            built = maker.but(**changes).problem()
        elif scene in KINDS or _is_place(scene):
            own = () if scene in KINDS else (own_kind(scene),)
            name = own[0].name if own else scene
            allowed = "left out: a kind of structure has no gaps"
            require(given.tolerance is None, "--tolerance", given.tolerance, allowed)
            require_given(mu=given.friction)
            table = changed(with_friction({"kind": name}, given.friction or 0.0), changes)
            built = structure_of(table if density is None else weighed(table, density), *own)
        else:
            if is_drawing(scene):
                require_given(mu=given.friction)
            built = load_any(
                scene, changes, density, friction=given.friction, tolerance=given.tolerance
            )
    except InputError as error:
        name = error.field.partition("[")[0]
        if name not in changes:
            raise
        raise InputError("--with", f"{error.field}={error.value}", error.allowed) from None
    if isinstance(built, Problem):
        return loaded(built, given, loading)
    from blocksim.cli.space import loaded_in_space

    return loaded_in_space(built, given, loading)


def _is_place(scene: str) -> bool:
    """Tell the place of a kind of one's own, ``module:CLASS``, from a file's name."""
    module, colon, name = scene.partition(":")
    named = all(part.isidentifier() for part in module.split("."))
    return bool(colon) and named and name.isidentifier()
