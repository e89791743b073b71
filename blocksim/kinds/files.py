"""Structure files, JSON or TOML: blocks, or a kind and its parameters; and files of others.

Those are drawings (DXF, SVG) and assemblies of compas (JSON): `blocksim.reading` makes of each
what a structure file says.

Lengths in m, forces in N, angles in degrees, y upwards. The keys besides blocks are those of
`blocks.entries.Around`, with blocks those of `StructureFile`.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from blocksim.blocks import structure
from blocksim.blocks.assembly import SUPPORT, Assembly, Block, Joint, Support
from blocksim.blocks.entries import AROUND, Around, around_of
from blocksim.blocks.given import GivenJoint
from blocksim.blocks.polygons import Body, assembly_of_bodies
from blocksim.blocks.problem import STANDARD_GRAVITY, Load, Problem
from blocksim.blocks.road import on_road
from blocksim.common.checks import LENGTH, require
from blocksim.common.errors import InputError, perhaps
from blocksim.common.files import AnyPath, json_of, read_file, shipped_files, toml_of
from blocksim.kinds import KINDS
from blocksim.kinds.base import Kind, kind_of, parameters_of
from blocksim.reading.compas import is_compas, read_compas
from blocksim.reading.dxf import read_dxf
from blocksim.reading.svg import read_svg

LARGEST_FILES = {".json": 20_000_000, ".toml": 1_000_000}
"""Bytes; a larger file is not read: TOML takes a second for each of these."""
WRITTEN = {".json": "JSON", ".toml": "TOML"}
DRAWN = {".dxf": read_dxf, ".svg": read_svg}
"""Endings of drawings, and who reads them."""


def shipped_structures() -> dict[str, Path]:
    """Structures that come with blocksim, by name."""
    return shipped_files("structures/*.toml")


def is_drawing(path: Path | str) -> bool:
    """Tell a drawing by its ending."""
    return Path(path).suffix.lower() in DRAWN


def load_structure(
    path: AnyPath,
    changes: Mapping[str, object] = MappingProxyType({}),
    density: float | None = None,
    *,
    friction: float | None = None,
    tolerance: float | None = None,
) -> Problem:
    """Read a structure file, a drawing or an assembly of compas.

    Parameters
    ----------
    path : str or path
        Ends in .json, .toml, .dxf or .svg, or the name of a shipped one.
    changes : mapping of str to object
        Parameters of its kind that replace those in the file; `arch.thickness` is one of its
        arch.
    density : float, optional
        Weight per volume instead of what it says [N/m^3].
    friction : float, optional
        Friction coefficient where the file has none; a drawing never has one. inf allowed.
    tolerance : float, optional
        Gaps and overlaps up to this are closed [m], instead of what the file says.

    Raises
    ------
    InputError
        In one line: file, entry, value, and what would be accepted.
    """
    with named_file(path) as said:
        data = said if friction is None else with_friction(said, friction)
        data = data if tolerance is None else within(data, tolerance)
        table = changed(data, changes) if changes else data
        return structure_of(table if density is None else weighed(table, density))


def with_friction(data: object, friction: float) -> object:
    """Return what a file says, with a friction if it says none."""
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    return {"friction": "inf" if friction == math.inf else friction, **table}


def within(data: object, tolerance: float) -> object:
    """Return what a file says, with gaps and overlaps closed up to a distance [m]."""
    require(0 <= tolerance <= LENGTH.high, "tolerance", tolerance, f"0 to {LENGTH.high:g} m")
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    allowed = "left out: it is for blocks, and this is a kind"
    require("kind" not in table, "tolerance", tolerance, allowed)
    return {**table, "tolerance": tolerance}


@contextmanager
def named_file(path: AnyPath, unit: float | None = None) -> Generator[object]:
    """Give what a structure file says; what is wrong with it is said with the file's name.

    Parameters
    ----------
    path : Path or str
        As of `load_structure`.
    unit : float, optional
        Metres that a unit of a drawing is; by default what the drawing says.

    Raises
    ------
    InputError
        In one line, also what is raised while it is used.
    """
    # As it was given: a name that ends in a slash is no file.
    path, near = os.fspath(path), ""
    ending = Path(path).suffix.lower()
    if ending not in WRITTEN and ending not in DRAWN:
        known = shipped_structures()
        near = "" if path in known else perhaps(path, known)
        path = str(known.get(path, path))
        ending = Path(path).suffix
    endings = ".json, .toml, .dxf or .svg"
    allowed = f"an existing structure file, {endings}, or a shipped structure{near}"
    require(ending in WRITTEN or ending in DRAWN, "structure", str(path), allowed)
    text = b""
    if ending in WRITTEN:
        require(unit is None, "--unit", unit, "left out: it is of drawings")
        text = read_file(path, "structure", allowed, LARGEST_FILES[ending])
    data: object = None
    try:
        drawn = DRAWN.get(ending)
        data = drawn(path, unit) if drawn else _written(text, WRITTEN[ending])
        yield data
    except InputError as error:
        field = _by_name(error.field, data)
        raise InputError(field, error.value, error.allowed, where=path) from None
    except (ValueError, RecursionError) as error:
        # Not JSON or TOML, no UTF-8, numbers beyond all bounds, or nested too deeply.
        said = " ".join(str(error).split())
        raise InputError("file", said, f"valid {WRITTEN[ending]}", where=path) from None


def _written(text: bytes, language: str) -> object:
    """Return what a text says, an assembly of compas as a structure file would."""
    if language == "TOML":
        return toml_of(text)
    data: object = json_of(text, _once)
    return read_compas(cast("dict[str, Any]", data)) if is_compas(data) else data


def _by_name(field: str, data: object) -> str:
    """Say which block of another's file is meant, where nobody has numbered them."""
    found = re.match(r"blocks\[(\d+)\]", field)
    table = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
    if found is None or "notes" not in table:
        return field
    with suppress(IndexError, KeyError, TypeError):
        return f"block {table['blocks'][int(found[1])]['id']}{field[found.end() :]}"
    return field


def changed(data: object, changes: Mapping[str, object]) -> dict[str, Any]:
    """Return the table of a kind with other parameters.

    Raises
    ------
    InputError
        If it is of no kind.
    """
    kind = data.get("kind") if isinstance(data, dict) else None  # pyright: ignore
    table = {**cast("dict[str, Any]", data)}
    for name, value in changes.items():
        require(kind is not None, name, value, "left out: the file has blocks, not a kind")
        here, _, rest = name.partition(".")
        inside = table.get(here)
        nested = bool(rest) and isinstance(inside, Mapping | None)
        table[here] = {**(inside or {}), rest: value} if nested else value
    return table


def weighed(data: object, density: float) -> object:
    """Return what a structure file says with another weight per volume [N/m^3].

    Raises
    ------
    InputError
        If a block has a weight of its own.
    """
    if not isinstance(data, dict):
        return data
    table = cast("dict[str, Any]", data)
    blocks: Any = table.get("blocks")
    for at, block in enumerate(cast("list[Any]", blocks) if isinstance(blocks, list) else ()):
        own: Any = (
            cast("dict[str, Any]", block).get("weight") if isinstance(block, dict) else None
        )
        allowed = "left out where a unit weight is given: it is of this block alone"
        require(own is None, f"blocks[{at}].weight", own, allowed)
    return {**table, "density": density}


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse a key that stands twice in a table of JSON."""
    table: dict[str, Any] = {}
    for key, value in pairs:
        require(key not in table, key, "given twice", "given once in a table")
        table[key] = value
    return table


def structure_of(data: object) -> Problem:
    """Make a problem of what a structure file says.

    Parameters
    ----------
    data : object
        A dict: with `blocks`, or with `kind` and its parameters, and the keys of `Around`.

    Raises
    ------
    InputError
        In one line: the first entry that is wrong, its value, and what would be accepted.
    """
    if not isinstance(data, dict) or "kind" not in data:
        return structure.structure_of(cast("object", data))
    table = cast("dict[str, Any]", data)
    require("blocks" not in table, "kind", table["kind"], "left out beside blocks")
    kind = kind_of({key: table[key] for key in table if key not in AROUND}, ALL)
    return problem_of(kind, around_of({key: table[key] for key in table if key in AROUND}))


ALL = tuple(KINDS.values())


def problem_of(kind: Kind, around: Around) -> Problem:
    """Ask about a kind of structure.

    Parameters
    ----------
    kind : Kind
    around : Around
        Friction, loads and the like.

    Returns
    -------
    Problem
        Dead loads begin with the weight of fill; its origin is the kind's table.
    """
    made = kind.made(around.unit_weight)
    if made.joints is None:
        found = assembly_of_bodies(made.bodies, density=around.unit_weight, size=around.size)
    else:
        found = assembly_as_made(made.bodies, made.joints, around.size), ()
    problem = structure.problem_of(around, made.bodies, *found)
    place = np.cumsum([not body.fixed for body in made.bodies]) - 1
    fills = tuple(
        Load(
            force=np.array([0.0, -fill.weight]),
            blocks=(int(place[fill.body]),),
            point=np.array(fill.point),
        )
        for fill in made.fills
    )
    return replace(
        problem,
        dead=(*fills, *problem.dead),
        title=problem.title or kind.name,
        origin={**kind.table(), "density": around.unit_weight},
        # Kinds weigh their blocks, whatever the unit weight.
        weighed=around.density is not None,
    )


def assembly_as_made(
    bodies: Sequence[Body], joints: Sequence[GivenJoint], size: float | None
) -> Assembly:
    """Build an assembly of bodies with weights, whose joints are whole faces of both.

    Nothing is looked for: a search for the least thickness builds dozens of them.
    """
    moving = [body for body in bodies if not body.fixed]
    place = np.cumsum([not body.fixed for body in bodies]) - 1
    bed = np.cumsum([body.fixed for body in bodies]) - 1
    corners = np.concatenate([np.asarray(body.polygons[0]) for body in moving])
    return Assembly(
        blocks=tuple(
            Block(
                vertices=np.asarray(body.polygons[0]),
                centre=np.asarray(body.centre),
                mass=(body.weight or 0.0) / STANDARD_GRAVITY,
                inertia=body.inertia or 0.0,
                depth=body.depth,
                name=body.name,
            )
            for body in moving
        ),
        joints=tuple(
            Joint(
                before=SUPPORT if bodies[joint.a].fixed else int(place[joint.a]),
                after=SUPPORT if bodies[joint.b].fixed else int(place[joint.b]),
                inner=joint.ends[0],
                outer=joint.ends[1],
                support=next(
                    (int(bed[each]) for each in (joint.a, joint.b) if bodies[each].fixed), None
                ),
            )
            for joint in joints
        ),
        size=float(np.ptp(corners, axis=0).max()) / 2 if size is None else size,
        supports=tuple(
            Support((np.asarray(body.polygons[0]),), body.name) for body in bodies if body.fixed
        ),
    )


ASIDE = ("density", "road")
"""What the origin of a problem says beside the table of its kind: its density [N/m^3], and
live loads on its road, each from one x to another [m] and its weight [N]."""


def kind_behind(problem: Problem) -> Kind | None:
    """Return the kind a problem was made from; None where its blocks were given."""
    table = {key: value for key, value in problem.origin.items() if key not in ASIDE}
    try:
        return kind_of(table, ALL)
    except InputError:
        return None


def with_parameter(problem: Problem, name: str, value: float) -> Problem:
    """Return a problem of a kind with another value of one parameter, under the same loads.

    Parameters
    ----------
    problem : Problem
    name : str
        Of the parameter; `arch.thickness` where a kind has an arch.
    value : float

    Raises
    ------
    InputError
        If it is out of range, or changes the number of blocks.
    """
    kind = cast(Kind, kind_behind(problem)).changed(name, value)
    made = _remade(problem, kind)
    blocks = len(problem.assembly.blocks)
    same = len(made.assembly.blocks) == blocks
    require(same, name, value, f"a value that leaves {blocks} blocks, on which loads act")
    return made


def with_fill(problem: Problem, height: float, share: float) -> Problem:
    """Return a problem of an arch or of arches on piers with fill above them.

    Parameters
    ----------
    problem : Problem
        Made from a kind.
    height : float
        Of the fill over the highest point of the extrados [m].
    share : float
        Density of the fill over that of the blocks.

    Raises
    ------
    InputError
        If it is of no arch, or a value is out of range.
    """
    kind = kind_behind(problem)
    known = {} if kind is None else parameters_of(type(kind))
    own = "fill" in known
    require(own or "arch" in known, "fill", height, "left out: it is for arches and portals")
    path = "" if own else "arch."
    kind = cast(Kind, kind).changed(f"{path}fill", height).changed(f"{path}fill_density", share)
    before = cast(Kind, kind_behind(problem)).made(1.0).fills
    return _remade(problem, kind, len(before))


@dataclass(frozen=True, kw_only=True)
class FillAbove:
    """Fill: its height over the highest point of the extrados [m], its weight [N]."""

    height: float
    weight: float


def fill_of(problem: Problem) -> FillAbove | None:
    """Return the fill on a structure; None where it has none."""
    kind = kind_behind(problem)
    height = getattr(getattr(kind, "arch", kind), "fill", None)
    if kind is None or height is None:
        return None
    fills = kind.made(density_of(problem)).fills
    return FillAbove(height=height, weight=sum(each.weight for each in fills))


def _remade(problem: Problem, kind: Kind, fills: int | None = None) -> Problem:
    """Return a problem of another kind, or of other parameters, under the same loads.

    The first of its dead loads are the weight of fill, as many as before unless said.
    """
    made = problem_of(kind, Around(friction=0.0, density=density_of(problem)))
    others = problem.dead[len(made.dead) if fills is None else fills :]
    road = cast(Mapping[str, Any], problem.origin).get("road")
    remade = replace(
        problem, assembly=made.assembly, dead=(*made.dead, *others), origin=made.origin
    )
    return remade if road is None else with_road(remade, road)


def with_road(
    problem: Problem,
    loads: Sequence[tuple[float, float, float]],
    fields: Sequence[str] = (),
) -> Problem:
    """Return a problem with these live loads on the road in place of any others.

    Where it was made from a kind they stay where they are as its parameters change, on
    whatever blocks are uppermost there then.

    Parameters
    ----------
    problem : Problem
    loads : sequence of (float, float, float)
        From one x to another [m], the same at a point, and the weight [N].
    fields : sequence of str
        What to call each in messages.

    Raises
    ------
    InputError
        If one is not above blocks that move.
    """
    names = fields or ["road"] * len(loads)
    live = [
        each
        for (low, high, weight), name in zip(loads, names, strict=True)
        for each in on_road(problem.assembly, weight, low, high, name)
    ]
    kept = {"road": [list(load) for load in loads]} if "kind" in problem.origin else {}
    return replace(problem, live=tuple(live), origin={**problem.origin, **kept})


def density_of(problem: Problem) -> float:
    """Weight per volume of a problem made from a kind [N/m^3]; 1 where none was given."""
    return float(cast(Mapping[str, Any], problem.origin)["density"])
