"""Design files: axes for the parameters of a kind of structure, as a TOML file says."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from blocksim.arch.circular import WEIGHTS
from blocksim.ask.families import FAMILIES, IN_SPACE
from blocksim.ask.methods import CHOICES, METHODS
from blocksim.blocks.maker import Kind
from blocksim.blocks.shaking import SHAPES
from blocksim.common.checks import FRICTION, SMOOTH_OR_ROUGH, VOUSSOIRS, WIDTH, Range, require
from blocksim.common.errors import MISSING, InputError
from blocksim.common.fields import Field, fields_of
from blocksim.common.files import AnyPath, read_toml
from blocksim.common.tables import as_said
from blocksim.engines import ENGINES
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch
from blocksim.simulation.simulated import SETTINGS, require_setting
from blocksim.sweeps.case import ACTING, PLAIN, Value
from blocksim.sweeps.design import Axis, AxisField, Design, How, Values, Words, require_axis

BAND = Range(low=0, high=math.inf, above=True, infinite=True)
LARGEST_DESIGN = 20_000_000
"""Cases of one sweep: their identities are held in memory, about 0.1 kB each."""
COMMON = ("live", "dead", "move", "density", "shake")
"""Keys of structure files that all cases have in common."""
BY_ANGLE: dict[str, Field] = {
    "voussoirs": Field(about="how many", range=VOUSSOIRS),
    "weight": Field(about="where a voussoir's weight acts", choices=WEIGHTS),
}
"""Parameters that arches by their half-angle have otherwise than others."""
USUAL_ARCH = {"voussoirs": 27, "weight": "centreline"}


HOW = tuple(each.name for each in fields(How))


def load_design(path: AnyPath) -> Design:
    """Read a design.

    Parameters
    ----------
    path : Path
        TOML file with the fields of `How`, and an axis for `mu`, for any parameter of its
        `kind` and for what acts. One without `kind` is of circular arches.

    Returns
    -------
    Design

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    table = read_toml(path, "design", "an existing .toml file")
    try:
        return design_of(table)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=str(path)) from None


def design_of(table: Mapping[str, Any]) -> Design:
    """Make a design of what its file says."""
    kind = _kind({"kind": CircularArch.name, **table}, "kind")
    parameters = dict(fields_of(kind))
    by_angle = kind is CircularArch and ("half_angle_deg" in table or "kind" not in table)
    if by_angle:
        parameters = parameters | BY_ANGLE
    parameters["mu"] = Field(range=FRICTION if by_angle else SMOOTH_OR_ROUGH)
    parameters |= ACTING
    _require_known(table, ("kind", *HOW, *COMMON, *parameters), "")
    if by_angle:
        require("half_angle_deg" in table, "half_angle_deg", MISSING, "given (or kind)")
        table = USUAL_ARCH | dict(table)
        if not {"eta", "ratio", "thickness", "over"} & {*table}:
            table["over"] = "thickness"
    require("mu" in table, "mu", MISSING, "given")
    how = as_said(How, {key: table[key] for key in HOW if key in table})
    said: Any = table.get("settings", {})
    _require_known(said, tuple(SETTINGS), "settings.")
    axes, known, rest = _axes(parameters, table)
    if by_angle:
        axes = {name: axes[name] for name in sorted(axes, key=_place)}
    settings = {name: how.settings[name] for name in SETTINGS if name in how.settings}
    design = Design(
        **vars(replace(how, settings=settings)),
        kind=kind.name,
        axes=axes,
        known=known,
        rest=rest | {key: table[key] for key in COMMON if key in table},
    )
    _require_ranges(design)
    _require_acting(design)
    for key in ("move", "shake") if kind.in_space else ():
        require(key not in design.rest, key, "given", f"left out: a {kind.name} is in space")
    towards = kind.in_space or "azimuth_deg" not in axes
    require(towards, "azimuth_deg", "given", f"left out: a {kind.name} is in the plane")
    _require_asked(design, kind)
    return design


def _place(name: str) -> int:
    """Return the place in which arches have always been drawn: a seed draws the same again."""
    order = "half_angle_deg", "mu", "voussoirs", "weight", "eta", "ratio"
    return order.index(name) if name in order else len(order)


def _kind(table: Mapping[str, Any], name: str) -> type[Kind[Any]]:
    named = table.get("kind")
    arches = [each.name for each in KINDS.values() if each.is_arch]
    known = [*KINDS] if name == "kind" else arches
    if not isinstance(named, str) or named not in known:
        raise InputError(name, named, f"one of {', '.join(known)}")
    return KINDS[named]


def _require_known(table: Mapping[str, Any], keys: Sequence[str], path: str) -> None:
    for name in table:
        allowed = "left out: there is no such key"
        require(name in keys, f"{path}{name}", table[name], allowed)


def _axes(
    parameters: Mapping[str, Field], table: Mapping[str, Any], path: str = ""
) -> tuple[dict[str, Values], dict[str, Field], dict[str, Any]]:
    """Tell axes, and what they may be, from what all cases have in common."""
    axes: dict[str, Values] = {}
    known: dict[str, Field] = {}
    rest: dict[str, Any] = {}
    for key, each in parameters.items():
        name = f"{path}{key}"
        if key not in table:
            continue
        value = table[key]
        if each.nested == "table":
            require(isinstance(value, Mapping), name, value, each.allowed)
            inside = fields_of(_kind(value, f"{name}.kind"))
            _require_known(value, ("kind", *inside), f"{name}.")
            more, said, common = _axes(inside, value, f"{name}.")
            axes |= more
            known |= said
            rest[key] = {"kind": value["kind"], **common}
        elif each.nested == "tables":
            rest[key] = value
        else:
            of = dict[str, Words] if each.choices else dict[str, AxisField]
            axes |= as_said(of, {name: value})
            known[name] = each
    return axes, known, rest


def _bracketed(kind: type[Kind[Any]], rest: Mapping[str, Any]) -> list[str]:
    """Names of the parameters that may be bracketed over."""
    names: list[str] = []
    for name, known in fields_of(kind).items():
        if known.nested == "table":
            arch = KINDS[rest.get(name, {}).get("kind", CircularArch.name)]
            names += [f"{name}.{each}" for each in _bracketed(arch, {})]
        elif known.stands is not None:
            names.append(name)
    return names


def _require_ranges(design: Design) -> None:
    """Raise `InputError` where a value is out of range by itself.

    What is so beside other parameters only becomes a row that says so.
    """
    spaced = design.random is None
    for name, axis in design.axes.items():
        values: Sequence[Value] = axis if isinstance(axis, tuple) else axis.ends
        if isinstance(axis, Axis):
            require_axis(name, axis, spaced)
            if spaced and design.is_whole(name):
                values = axis.every()
        for value in values:
            design.known[name].require(name, value)
    for name, axis in design.settings.items():
        require_axis(f"settings.{name}", axis, spaced)
        for value in axis.every() if spaced else axis.ends:
            require_setting(name, value)


def _require_acting(design: Design) -> None:
    """Raise `InputError` where what acts on nothing is given."""
    live, shaken = "live" in design.rest, design.rest.get("shake")
    known = not isinstance(shaken, str) or shaken in SHAPES
    require(known, "shake", shaken, f"one of {', '.join(SHAPES)}, or a table")
    for name, there, why in (
        ("load", live, "no live loads"),
        ("amplitude_g", shaken, "no shake"),
        ("duration_s", shaken, "no shake"),
    ):
        ok = bool(there) or name not in design.axes
        require(ok, name, "given", f"left out: {why}")
        if isinstance(shaken, str) and name != "load" and name not in design.axes:
            raise InputError(name, MISSING, "given with shake")
    require(live or design.over != "load", "over", "load", "another: no live loads")


def _require_asked(design: Design, kind: type[Kind[Any]]) -> None:
    """Raise `InputError` where the question or the method is none, or there are too many."""
    axes, plain, over = design.axes, design.is_plain, design.over
    if over is not None:
        common = IN_SPACE if kind.in_space else FAMILIES
        names = (*common, *_bracketed(kind, design.rest))
        require(over in names, "over", over, f"one of {', '.join(names)}")
    choices = [each for each in CHOICES if kind is CircularArch or each != "theory"]
    if kind.in_space:
        choices = [
            each
            for each in choices
            if each in {"auto", "limit"} or ENGINES[each].build_in_space
        ]
    for word in design.method:
        # A file may name engines that are installed, but no module to be imported.
        own = word in METHODS and word not in METHODS.shipped
        require(word in choices or own, "method", word, f"one of {', '.join(choices)}")
    WIDTH.require("tol", design.tol)
    for name in sorted({*design.method} - {"auto"}) if over is not None else ():
        finest = METHODS[name].finest
        require(design.tol >= finest, "tol", design.tol, f"at least {finest:g} for {name}")
    for name in design.settings:
        taken = any(name in design.taken(method) for method in design.method)
        allowed = "left out: no method asked is run with it"
        require(taken, f"settings.{name}", "given", allowed)
    if "ratio" in axes:
        require("eta" not in axes, "ratio", "given", "left out where eta is given")
        only = f"left out beside other parameters than {', '.join(sorted(PLAIN))}"
        require(plain, "ratio", "given", only)
    if design.band is not None:
        require(over is None, "band", design.band, "left out where brackets are asked")
        require(plain, "band", design.band, "left out: it is of arches by half_angle_deg")
        BAND.require("band", design.band)
    cases = design.size
    ok = 0 < cases <= LARGEST_DESIGN
    require(ok, "design", f"{cases} cases", f"at most {LARGEST_DESIGN} cases")
