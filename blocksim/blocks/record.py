"""A problem as plain data, exact to the last bit, and back: what recordings carry.

Unlike a structure file, which people write, it leaves nothing to be worked out: masses,
inertias and joints are those the engine had.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from blocksim.blocks.assembly import SUPPORT, Array, Assembly, Block, Joint, Support
from blocksim.blocks.dispersal import Dispersal
from blocksim.blocks.problem import Load, Move, Problem
from blocksim.blocks.shaking import Shaking, table_of
from blocksim.blocks.soil import Soil
from blocksim.blocks.space.assembly import FaceJoint, SolidBlock, SpatialAssembly
from blocksim.blocks.space.polyhedron import Polyhedron
from blocksim.common.checks import COORDINATE, SMOOTH_OR_ROUGH, WEIGHT, endless_text, infinite

if TYPE_CHECKING:
    from blocksim.blocks.maker import Kind


NOT_WRITTEN = {"maker", "road"}
"""Fields of a problem that its record says otherwise."""
NO_BLOCKS = "no assembly of blocks"


def to_record(value: object) -> Any:
    """Return a problem, or a part of one, as dicts, lists, strings and numbers.

    Infinity, which JSON has not, is the string ``inf``.
    """
    if isinstance(value, Problem):
        return _problem(cast("Problem[Any]", value))
    if is_dataclass(value):
        return {each.name: to_record(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        named = cast("Mapping[str, object]", value)
        return {key: to_record(each) for key, each in named.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [to_record(each) for each in cast("Sequence[object]", value)]
    return endless_text(value)


def _problem(problem: Problem[Any]) -> dict[str, Any]:
    """Return a problem; of its maker the parameters, and where they stand loads on the road."""
    left_out = NOT_WRITTEN if problem.in_space else {*NOT_WRITTEN, "azimuth"}
    names = [each.name for each in fields(problem) if each.name not in left_out]
    maker = problem.maker
    origin: dict[str, Any] = {} if maker is None else to_record(maker.origin())
    if problem.road:
        origin["road"] = to_record(problem.road)
    return {**{name: to_record(getattr(problem, name)) for name in names}, "origin": origin}


def from_record(
    record: Mapping[str, Any],
    maker_of: Callable[[Mapping[str, object]], Kind[Any] | None] = lambda _: None,
) -> Problem[Any]:
    """Return the problem that `to_record` was given.

    `maker_of`: Parameters and name of a kind to the maker; by default the problem has none.
    """
    given = dict(record)
    built = dict(given.pop("assembly"))
    # In space the size follows from the blocks.
    assembly = _in_plane(built) if "size" in built else _in_space(built)
    dead, live = (
        tuple(Load(**_tupled(each, "blocks")) for each in given.pop(name))
        for name in ("dead", "live")
    )
    moves = tuple(Move(**each) for each in given.pop("moves"))
    on = [each for load in (*dead, *live) for each in load.blocks]
    known = all(_is_place(each, len(assembly.blocks)) for each in on)
    known &= all(_is_place(move.support, len(assembly.supports)) for move in moves)
    words = all(isinstance(given.get(name, ""), str) for name in ("title", "source"))
    origin = _numbers(given.pop("origin"))
    road = tuple(
        (float(low), float(high), float(weight))
        for low, high, weight in cast("list[list[float]]", origin.pop("road", []))
    )
    known &= all(math.isfinite(each) for load in road for each in load)
    if not known or not words:
        raise ValueError("no problem")
    return Problem(
        assembly=assembly,
        mu=float(given.pop("mu")),
        dead=dead,
        live=live,
        moves=moves,
        shaking=_shaking(given.pop("shaking", None)),
        soil=_soil(given.pop("soil", None)),
        dispersal=Dispersal(**spread) if (spread := given.pop("dispersal", None)) else None,
        maker=maker_of(origin),
        road=road,
        notes=tuple(str(each) for each in given.pop("notes")),
        **given,
    )


def _in_plane(built: dict[str, Any]) -> Assembly:
    assembly = Assembly(
        blocks=tuple(Block(**_tupled(each, "parts")) for each in built["blocks"]),
        joints=tuple(Joint(**_numbers(each)) for each in built["joints"]),
        size=float(built["size"]),
        supports=tuple(Support(**each) for each in built["supports"]),
    )
    blocks = assembly.blocks
    points = [block.centre for block in blocks]
    points += [part for each in (*blocks, *assembly.supports) for part in each.polygons]
    for joint in assembly.joints:
        given = (joint.inner, joint.outer, joint.across, joint.faces)
        points += [each for each in given if each is not None]
    _require_sound(assembly, points)
    return assembly


def _in_space(built: dict[str, Any]) -> SpatialAssembly:
    solids = [dict(each) for name in ("blocks", "supports") for each in built[name]]
    corners = [_points(part["corners"]) for each in solids for part in each["hulls"]]
    _require_near(corners)
    made = [_solid(each) for each in solids]
    count = len(built["blocks"])
    assembly = SpatialAssembly(
        blocks=tuple(made[:count]),
        supports=tuple(made[count:]),
        joints=tuple(_face(each) for each in built["joints"]),
    )
    points = [block.centre for block in made]
    for joint in assembly.joints:
        points += [joint.points, joint.normal]
    _require_sound(assembly, points)
    heavy = all(WEIGHT.has(each.weight) for each in assembly.blocks)
    normals = np.array([each.normal for each in assembly.joints]).reshape(-1, 3)
    if not heavy or not np.allclose(np.linalg.norm(normals, axis=1), 1.0):
        raise ValueError(NO_BLOCKS)
    return assembly


def _solid(record: dict[str, Any]) -> SolidBlock:
    hulls = tuple(Polyhedron(each["corners"], float(each["slack"])) for each in record["hulls"])
    name, centre = str(record["name"]), _points([record["centre"]])[0]
    given: dict[str, Any] = {**record, "hulls": hulls, "name": name, "centre": centre}
    return SolidBlock(**given)


def _face(record: dict[str, Any]) -> FaceJoint:
    points, normal = _points(record["points"]), _points([record["normal"]])[0]
    given: dict[str, Any] = {**_numbers(record), "points": points, "normal": normal}
    return FaceJoint(**given)


def _points(record: Any) -> Array:
    """Return points in space, (k, 3), at least one."""
    found = np.array(record, dtype=float)
    if found.ndim != 2 or found.shape[1] != 3 or not len(found):
        raise ValueError("no points")
    return found


def _shaking(record: Mapping[str, Any] | None) -> Shaking | None:
    if record is None:
        return None
    given = dict(record)
    table = np.array(given.pop("table"), dtype=float)
    if table.shape[1:] == (2,):
        # Recordings of before know no motion upwards.
        table = np.column_stack([table, np.zeros(len(table))])
    made = Shaking(table=table.reshape(-1, 3), **given)
    if len(table):
        # A stranger's table is checked as one of a file is.
        table_of(*table.T)
    return made


def _soil(record: Mapping[str, Any] | None) -> Soil | None:
    if record is None:
        return None
    return Soil(**{name: _tuples(each) for name, each in record.items()})


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, cast("list[Any]", value))) if isinstance(value, list) else value


def _tupled(record: Mapping[str, Any], name: str) -> dict[str, Any]:
    return {**record, name: tuple(record[name])}


def _numbers(record: Mapping[str, Any]) -> dict[str, Any]:
    return {key: infinite(value) for key, value in record.items()}


def _is_place(value: object, count: int, least: int = 0) -> bool:
    """Whether a stranger names one of so many things by a whole number; true is none."""
    return type(value) is int and least <= value < count


def _require_sound(assembly: Assembly | SpatialAssembly, points: Sequence[Array]) -> None:
    """Raise `ValueError` where a stranger's record cannot be of blocks.

    `points`: All that is somewhere.
    """
    count, supports = len(assembly.blocks), len(assembly.supports)
    sound = count > 0
    names: list[object] = [each.name for each in (*assembly.blocks, *assembly.supports)]
    sound &= all(isinstance(each, str) for each in names)
    for joint in assembly.joints:
        sound = sound and all(
            _is_place(each, count, SUPPORT) for each in (joint.before, joint.after)
        )
        sound = sound and (joint.support is None or _is_place(joint.support, supports))
        own = joint.friction
        sound = sound and (own is None or SMOOTH_OR_ROUGH.has(own))
        sound = sound and (joint.gap == 0 or COORDINATE.has(joint.gap))
    if not sound:
        raise ValueError(NO_BLOCKS)
    _require_near(points)


def _require_near(points: Sequence[Array]) -> None:
    far = np.abs(np.concatenate([each.ravel() for each in points]))
    # Not a number is not below anything.
    if not bool((far <= COORDINATE.high).all()):
        raise ValueError(NO_BLOCKS)
