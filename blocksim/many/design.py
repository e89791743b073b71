"""Designs: which arches a sweep asks about, as a TOML file says."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Protocol, cast

import numpy as np
from pydantic import BeforeValidator, Field

from blocksim.arch.circular import WEIGHTS, Weight
from blocksim.arch.scenario import read_table
from blocksim.ask.methods import CHOICES, METHODS, STATIC
from blocksim.ask.search import ETA_MAX
from blocksim.common.checks import ETA, FRICTION, Range, is_number, require
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath
from blocksim.engines import NAMES
from blocksim.evidence.simulation import SETTINGS, require_setting, setting_of
from blocksim.many.axis import DRAWN_AT_ONCE, Axis, AxisField, Number, require_axis
from blocksim.many.case import Case

LARGEST_DESIGN = 20_000_000
"""Cases of one sweep: their identities are held in memory, about 0.1 kB each."""
AUTO_BAND = 0.001
"""Share of the least thickness within which `auto` simulates."""
DEGREES = Range(low=0.06, high=math.nextafter(180, 0), unit="deg")
"""Of half-angles."""
USUAL_VOUSSOIRS = Axis(values=(27.0,))


def _as_list(written: object) -> object:
    """Take a single word for a list of one."""
    return cast("object", written) if isinstance(written, list) else [written]


Words = Annotated[
    tuple[str, ...], Field(min_length=1, max_length=10), BeforeValidator(_as_list)
]


@dataclass(frozen=True, kw_only=True)
class RandomTable:
    """Table `[random]`: draw arches instead of taking every combination.

    Parameters
    ----------
    count : int
        How many.
    seed : int
        The same seed draws the same arches.
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    count: Annotated[int, Field(ge=1, strict=True)]
    seed: Annotated[int, Field(ge=0, strict=True)]


@dataclass(frozen=True, kw_only=True)
class SettingsTable:
    """Table `[settings]`: of engines, instead of what their rules say; see `Settings`.

    Parameters
    ----------
    step : Axis
        Length of a step [sqrt(r/g)].
    sweeps : Axis
        Sweeps over the contacts in each step of a moving run.
    hold_sweeps : Axis
        The most sweeps an onset test may take.
    still : Axis
        Acceleration that counts as rest [g].
    rest : Axis
        Displacement that counts as rest, over the radius.
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    step: AxisField | None = None
    sweeps: AxisField | None = None
    hold_sweeps: AxisField | None = None
    still: AxisField | None = None
    rest: AxisField | None = None

    @property
    def axes(self) -> dict[str, Axis]:
        """Those given, by name."""
        axes = {name: cast("Axis | None", getattr(self, name)) for name in SETTINGS}
        return {name: axis for name, axis in axes.items() if axis is not None}


@dataclass(frozen=True, kw_only=True)
class Design:
    """Every combination of the values given, or a number of arches drawn from them.

    Parameters
    ----------
    half_angle_deg : Axis
        Half-angle of embrace [deg].
    mu : Axis
        Friction coefficient; inf allowed.
    voussoirs : Axis
        How many.
    weight : tuple of str
        `centreline`, `sector`, or both.
    eta : Axis, optional
        Thickness over the radius.
    ratio : Axis, optional
        Thickness over the least of the voussoirs as built; with neither the question is
        how thin the arch can be.
    method : tuple of str
        Every arch is put to each.
    band : float, optional
        Engines simulate arches within this share of their least thickness, and `limit`
        answers for the others. By default a named engine simulates all, and `auto`
        those within 0.001, with `direct`.
    tol : float
        Relative width of an engine's bracket.
    confirm : bool
        Let the arch go at both ends of an engine's bracket; without, the onset test alone
        answers, in about half of the time.
    settings : SettingsTable
        Axes like any other; a method is given those it is run with.
    random : RandomTable, optional
        Draws arches instead.
    """

    __pydantic_config__: ClassVar = {"extra": "forbid"}

    half_angle_deg: AxisField
    mu: AxisField
    voussoirs: AxisField = USUAL_VOUSSOIRS
    weight: Words = ("centreline",)
    eta: AxisField | None = None
    ratio: AxisField | None = None
    method: Words = ("auto",)
    band: Number | None = None
    tol: Number = 0.005
    confirm: Annotated[bool, Field(strict=True)] = True
    settings: SettingsTable = SettingsTable()
    random: RandomTable | None = None

    @property
    def size(self) -> int:
        """Number of cases, those that occur twice included."""
        arches = math.prod(len(axis.every()) for axis in self._axes())
        if self.random is None:
            return arches * len(self.weight) * len(self.method)
        return self.random.count * len(self.method)

    def cases(self) -> Iterator[Case]:
        """Give the cases one after the other, always in the same order."""
        arches = self._grid() if self.random is None else self._drawn(self.random)
        names = tuple(self.settings.axes)
        free = [(*self._width(method), self.taken(method), method) for method in self.method]
        for (alpha, mu, voussoirs, weight, eta, ratio), values in arches:
            given = tuple(
                (name, setting_of(name, value))
                for name, value in zip(names, values, strict=True)
            )
            arch = alpha, mu, round(voussoirs), weight, eta, ratio
            for band, tol, taken, method in free:
                own = tuple(each for each in given if each[0] in taken)
                # Where there is no bracket by an engine, there are no ends to confirm.
                yield Case(*arch, method, band, tol, self.confirm or not tol, own)

    def taken(self, method: str) -> tuple[str, ...]:
        """Names of the settings that change an answer of a method here."""
        if not any(self._width(method)):
            return ()
        return METHODS[NAMES[0] if method == "auto" else method].adjustable

    def _axes(self) -> list[Axis]:
        arch = self.half_angle_deg, self.mu, self.voussoirs, self.eta, self.ratio
        axes = *arch, *self.settings.axes.values()
        return [axis for axis in axes if axis is not None]

    def _width(self, method: str) -> tuple[float, float]:
        """Band and tolerance of one method, 0 where it has none: then they change nothing."""
        bracketed = self.eta is None and self.ratio is None
        if method in STATIC or (bracketed and method == "auto"):
            return 0.0, 0.0
        band = AUTO_BAND if method == "auto" else math.inf
        return (0.0, self.tol) if bracketed else (self.band or band, 0.0)

    def _grid(self) -> Iterator[tuple[_Arch, _Values]]:
        arches = itertools.product(
            self.half_angle_deg.every(),
            self.mu.every(),
            self.voussoirs.every(),
            cast("tuple[Weight, ...]", self.weight),
            [None] if self.eta is None else self.eta.every(),
            [None] if self.ratio is None else self.ratio.every(),
        )
        settings = [axis.every() for axis in self.settings.axes.values()]
        return itertools.product(arches, itertools.product(*settings))

    def _drawn(self, table: RandomTable) -> Iterator[tuple[_Arch, _Values]]:
        generator = np.random.default_rng(table.seed)
        nothing = [None] * DRAWN_AT_ONCE
        for start in range(0, table.count, DRAWN_AT_ONCE):
            arches = zip(
                self.half_angle_deg.draw(generator, whole=False),
                self.mu.draw(generator, whole=False),
                self.voussoirs.draw(generator, whole=True),
                cast("list[Weight]", generator.choice(self.weight, DRAWN_AT_ONCE).tolist()),
                nothing if self.eta is None else self.eta.draw(generator, whole=False),
                nothing if self.ratio is None else self.ratio.draw(generator, whole=False),
                strict=True,
            )
            drawn = [
                axis.draw(generator, whole=SETTINGS[name].is_whole)
                for name, axis in self.settings.axes.items()
            ]
            settings = zip(*drawn, strict=True) if drawn else itertools.repeat(())
            yield from itertools.islice(
                zip(arches, settings, strict=False), table.count - start
            )


_Arch = tuple[float, float, float, Weight, float | None, float | None]
_Values = tuple[float, ...]
"""Of the settings given."""


def load_arch_design(path: AnyPath) -> Design:
    """Read a design of symmetric circular arches.

    Parameters
    ----------
    path : Path
        TOML file with the fields of `Design`.

    Returns
    -------
    Design

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    design = read_table(path, Design, "design", "an existing .toml file")
    try:
        _require_ranges(design)
    except InputError as error:
        raise InputError(error.field, error.value, error.allowed, where=str(path)) from None
    return design


def _require_ranges(design: Design) -> None:
    """Raise `InputError` where a case would be out of range."""
    spaced = design.random is None
    for field, known, allowed in (
        ("half_angle_deg", DEGREES, "above 0 and below 180"),
        ("mu", FRICTION, FRICTION.words),
        ("voussoirs", Range(low=3, high=1000), "a whole number from 3 to 1000"),
        ("eta", Range(low=ETA.low, high=ETA_MAX), "above 0 and at most 2"),
        ("ratio", Range(low=1e-6, high=100), "1e-06 to 100"),
    ):
        axis = cast("Axis | None", getattr(design, field))
        if axis is None:
            continue
        require_axis(field, axis, spaced)
        for value in axis.ends:
            require(known.has(value), field, value, allowed)
        if field == "voussoirs":
            for value in (*axis.ends, *(axis.every() if spaced else ())):
                require(3 <= value == int(value), field, value, allowed)
    for word in design.weight:
        require(word in WEIGHTS, "weight", word, f"one of {', '.join(WEIGHTS)}")
    bracketed = design.eta is None and design.ratio is None
    require_asked(design, CHOICES, bracketed=bracketed)
    both = design.eta is not None and design.ratio is not None
    require(not both, "ratio", "given", "left out where eta is given")
    band_ok = design.band is None or is_number(design.band, 0, math.inf)
    require(band_ok, "band", design.band, "above 0 (inf to simulate every arch)")
    if bracketed:
        require(design.band is None, "band", design.band, "left out where brackets are asked")


class Asked(Protocol):
    """How a design asks, whatever it asks about."""

    @property
    def method(self) -> tuple[str, ...]:
        """Methods."""
        ...

    @property
    def tol(self) -> float:
        """Relative width of a bracket."""
        ...

    @property
    def settings(self) -> SettingsTable:
        """Axes of the engines' settings."""
        ...

    @property
    def random(self) -> RandomTable | None:
        """Whether cases are drawn."""
        ...

    @property
    def size(self) -> int:
        """Number of cases."""
        ...

    def taken(self, method: str) -> tuple[str, ...]:
        """Names of the settings that change an answer of a method."""
        ...


def require_asked(design: Asked, choices: Sequence[str], *, bracketed: bool) -> None:
    """Raise `InputError` where methods, tolerance, settings or size are out of range.

    Parameters
    ----------
    design : Asked
    choices : sequence of str
        Methods that may be asked.
    bracketed : bool
        Whether the question is where something changes.
    """
    for word in design.method:
        # A file may name engines that are installed, but no module to be imported.
        own = word in METHODS and word not in METHODS.shipped
        require(word in choices or own, "method", word, f"one of {', '.join(choices)}")
    require(is_number(design.tol, 0, 0.5), "tol", design.tol, "above 0 and at most 0.5")
    for name in sorted(set(design.method) - {"auto"}) if bracketed else ():
        finest = METHODS[name].finest
        require(design.tol >= finest, "tol", design.tol, f"at least {finest:g} for {name}")
    spaced = design.random is None
    for name, axis in design.settings.axes.items():
        field = f"settings.{name}"
        require_axis(field, axis, spaced)
        for value in axis.every() if spaced else axis.ends:
            require_setting(name, value)
        taken = any(name in design.taken(method) for method in design.method)
        require(taken, field, "given", "left out: no method asked is run with it")
    count = design.size
    ok = 0 < count <= LARGEST_DESIGN
    require(ok, "design", f"{count} cases", f"at most {LARGEST_DESIGN} cases")
