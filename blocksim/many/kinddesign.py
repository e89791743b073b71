"""Designs of structures: axes for the parameters of any kind, as a TOML file says."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, make_dataclass
from typing import Any, cast

import numpy as np

from blocksim.arch.scenario import read_table
from blocksim.ask.families import FAMILIES
from blocksim.ask.methods import CHOICES, METHODS
from blocksim.blocks.maker import Maker, Parameter, parameters_of
from blocksim.blocks.shaking import SHAPES
from blocksim.common.checks import is_number, require
from blocksim.common.errors import MISSING, InputError
from blocksim.evidence.simulation import SETTINGS, setting_of
from blocksim.kinds import KINDS
from blocksim.kinds.circular import CircularArch
from blocksim.many.axis import DRAWN_AT_ONCE, Axis, AxisField, Number, require_axis
from blocksim.many.design import RandomTable, SettingsTable, Words, require_asked
from blocksim.many.structurecase import ACTING, StructureCase

COMMON = ("live", "dead", "move", "density", "shake")
"""Keys of structure files that all cases have in common."""
Value = float | str
# What pydantic is given, which is made while the program runs.
_AXIS: Any = cast("Any", AxisField) | None
_WORDS: Any = cast("Any", Words) | None


@dataclass(frozen=True, kw_only=True)
class KindDesign:
    """Every combination of the values given, or a number of structures drawn from them.

    Parameters
    ----------
    kind : str
    axes : mapping of str to Axis or tuple of str
        Of the kind's parameters, by name; `arch.thickness`: of its arch.
    rest : mapping
        Parameters that are tables, and keys of structure files: loads, density.
    mu : Axis
    acting : mapping of str to Axis
        Of `ACTING`, as far as they are given.
    over : str, optional
        Parameter to bracket over; without it the question is whether it stands.
    method : tuple of str
    tol : float
        Relative width of a bracket.
    settings : SettingsTable
    random : RandomTable, optional
    """

    kind: str
    axes: Mapping[str, Axis | tuple[str, ...]]
    rest: Mapping[str, Any]
    mu: Axis
    acting: Mapping[str, Axis]
    over: str | None
    method: tuple[str, ...]
    tol: float
    settings: SettingsTable
    random: RandomTable | None

    @property
    def size(self) -> int:
        """Number of cases, those that occur twice included."""
        if self.random is not None:
            return self.random.count * len(self.method)
        return math.prod(len(_every(axis)) for axis in self._all()) * len(self.method)

    def cases(self) -> Iterator[StructureCase]:
        """Give the cases one after the other, always in the same order."""
        names, common = tuple(self.axes), json.dumps(self.rest, sort_keys=True)
        whole = {name for name in names if _known(self.kind, self.rest, name).whole}
        for values in self._grid() if self.random is None else self._drawn(self.random):
            at = len(names)
            parameters = tuple(
                (name, round(cast(float, value)) if name in whole else value)
                for name, value in zip(names, values, strict=False)
            )
            mu, *others = cast("tuple[float, ...]", values[at:])
            acting = tuple(zip(self.acting, others, strict=False))
            given = tuple(
                (name, setting_of(name, value))
                for name, value in zip(self.settings.axes, others[len(acting) :], strict=True)
            )
            for method in self.method:
                taken = self.taken(method)
                yield StructureCase(
                    self.kind,
                    parameters,
                    common,
                    mu,
                    acting,
                    self.over,
                    method,
                    self.tol if self.over is not None else 0.0,
                    tuple(each for each in given if each[0] in taken),
                )

    def taken(self, method: str) -> tuple[str, ...]:
        """Names of the settings that change an answer of a method."""
        return () if method == "auto" else METHODS[method].adjustable

    def _all(self) -> list[Axis | tuple[str, ...]]:
        return [
            *self.axes.values(),
            self.mu,
            *self.acting.values(),
            *self.settings.axes.values(),
        ]

    def _grid(self) -> Iterator[tuple[Value, ...]]:
        return itertools.product(*(_every(axis) for axis in self._all()))

    def _drawn(self, table: RandomTable) -> Iterator[tuple[Value, ...]]:
        generator = np.random.default_rng(table.seed)
        whole = [
            *(_known(self.kind, self.rest, name).whole for name in self.axes),
            *(False for _ in ("mu", *self.acting)),
            *(SETTINGS[name].is_whole for name in self.settings.axes),
        ]
        for start in range(0, table.count, DRAWN_AT_ONCE):
            drawn: list[list[Any]] = []
            for axis, is_whole in zip(self._all(), whole, strict=True):
                if isinstance(axis, Axis):
                    drawn.append(axis.draw(generator, whole=is_whole))
                else:
                    drawn.append(generator.choice(axis, DRAWN_AT_ONCE).tolist())
            left = table.count - start
            yield from itertools.islice(zip(*drawn, strict=True), left)


def _every(axis: Axis | tuple[str, ...]) -> Sequence[Value]:
    return axis.every() if isinstance(axis, Axis) else axis


def _known(kind: str, rest: Mapping[str, Any], name: str) -> Parameter:
    """Return what is known of a parameter, of the kind or of its arch."""
    path, _, last = name.rpartition(".")
    chosen = KINDS[rest[path]["kind"] if path else kind]
    return parameters_of(chosen)[last]


def load_kind_design(path: Any, table: Mapping[str, Any]) -> KindDesign:
    """Read a design of a kind of structure.

    Parameters
    ----------
    path : Path
        TOML file.
    table : mapping
        What it says, of which `kind` is known to be there.

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    try:
        kind = _kind(table, "kind")
        schema = _schema(kind, table)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=str(path)) from None
    written = read_table(path, schema, "design", "an existing .toml file")
    try:
        axes, rest = _axes(kind, written)
        design = KindDesign(
            kind=kind.name,
            axes=axes,
            rest=rest | {key: table[key] for key in COMMON if key in table},
            mu=written.mu,
            acting={
                name: axis for name in ACTING if (axis := getattr(written, name)) is not None
            },
            over=written.over,
            method=written.method,
            tol=written.tol,
            settings=written.settings,
            random=written.random,
        )
        _require_ranges(design, kind)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=str(path)) from None
    return design


def _kind(table: Mapping[str, Any], name: str) -> type[Maker]:
    named = table.get("kind")
    arches = [each.name for each in KINDS.values() if each.is_arch]
    known = list(KINDS) if name == "kind" else arches
    if not isinstance(named, str) or named not in known:
        raise InputError(name, named, f"one of {', '.join(known)}")
    return KINDS[named]


def _schema(kind: type[Maker], table: Mapping[str, Any]) -> type[Any]:
    """Make the table that a design of a kind is, for pydantic to check."""
    rows: list[tuple[str, Any, Any]] = [
        *_fields(kind, table),
        ("mu", AxisField, field()),
        *((name, _AXIS, field(default=None)) for name in ACTING),
        ("over", str | None, field(default=None)),
        ("method", Words, field(default=("auto",))),
        ("tol", Number, field(default=0.005)),
        ("settings", SettingsTable, field(default=SettingsTable())),
        ("random", RandomTable | None, field(default=None)),
        *((key, Any, field(default=None)) for key in COMMON),
    ]
    return _dataclass("KindDesignTable", rows)


def _fields(kind: type[Maker], table: Mapping[str, Any]) -> list[tuple[str, Any, Any]]:
    rows: list[tuple[str, Any, Any]] = [("kind", str, field())]
    for name, known in parameters_of(kind).items():
        what: Any = Any
        if known.choices:
            what = _WORDS
        elif known.is_number:
            what = _AXIS
        elif known.table and name in table:
            inside = table[name]
            require(isinstance(inside, Mapping), name, inside, "a table with a kind of arch")
            arch = _kind(inside, f"{name}.kind")
            what = _dataclass("ArchTable", _fields(arch, inside))
        rows.append((name, what, field(default=None)))
    return rows


def _dataclass(name: str, rows: list[tuple[str, Any, Any]]) -> type[Any]:
    return make_dataclass(
        name,
        rows,
        frozen=True,
        kw_only=True,
        namespace={"__pydantic_config__": {"extra": "forbid"}},
    )


def _axes(
    kind: type[Maker], written: Any, path: str = ""
) -> tuple[dict[str, Axis | tuple[str, ...]], dict[str, Any]]:
    """Tell axes from what all cases have in common."""
    axes: dict[str, Axis | tuple[str, ...]] = {}
    rest: dict[str, Any] = {}
    for name, known in parameters_of(kind).items():
        value = getattr(written, name)
        if value is None:
            continue
        if known.table:
            inside, more = _axes(KINDS[value.kind], value, f"{path}{name}.")
            axes |= inside
            rest[name] = {"kind": value.kind, **more}
        elif known.tables:
            rest[name] = value
        else:
            axes[f"{path}{name}"] = value
    return axes, rest


def _bracketed(kind: type[Maker], rest: Mapping[str, Any]) -> list[str]:
    """Names of the parameters that may be bracketed over."""
    names: list[str] = []
    for name, known in parameters_of(kind).items():
        if known.table:
            arch = KINDS[rest.get(name, {}).get("kind", CircularArch.name)]
            names += [f"{name}.{each}" for each in _bracketed(arch, {})]
        elif known.stands is not None:
            names.append(name)
    return names


def _require_ranges(design: KindDesign, kind: type[Maker]) -> None:
    """Raise `InputError` where a value is out of range by itself.

    What is so beside other parameters only becomes a row that says so.
    """
    spaced = design.random is None
    for name, axis in design.axes.items():
        known = _known(design.kind, design.rest, name)
        if isinstance(axis, Axis):
            require_axis(name, axis, spaced)
        ends = axis.ends if isinstance(axis, Axis) else axis
        values = (*ends, *(_every(axis) if spaced else ())) if known.whole else ends
        for value in values:
            known.require(name, value)
    for name, axis in (("mu", design.mu), *design.acting.items()):
        require_axis(name, axis, spaced)
        low, high = ACTING.get(name, (0.0, math.inf))
        for value in axis.ends:
            ok = value == low or is_number(value, low, high)
            require(ok, name, value, f"from {low:g} to {high:g}")
    live, shaken = "live" in design.rest, design.rest.get("shake")
    known = not isinstance(shaken, str) or shaken in SHAPES
    require(known, "shake", shaken, f"one of {', '.join(SHAPES)}, or a table")
    for name, there, why in (
        ("load", live, "no live loads"),
        ("amplitude_g", shaken, "no shake"),
        ("duration_s", shaken, "no shake"),
    ):
        ok = bool(there) or name not in design.acting
        require(ok, name, "given", f"left out: {why}")
        if isinstance(shaken, str) and name != "load" and name not in design.acting:
            raise InputError(name, MISSING, "given with shake")
    if design.over is not None:
        names = (*FAMILIES, *_bracketed(kind, design.rest))
        require(design.over in names, "over", design.over, f"one of {', '.join(names)}")
        require(live or design.over != "load", "over", "load", "another: no live loads")
    choices = [each for each in CHOICES if each != "theory"]
    require_asked(design, choices, bracketed=design.over is not None)
