"""The options that say how it is asked, each declared once, and what all options share."""

from __future__ import annotations

import math
from collections.abc import Collection, Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import PurePath
from typing import cast

from blocksim.ask.families import FAMILIES
from blocksim.ask.methods import CHOICES
from blocksim.cli.arguments import option
from blocksim.cli.given import PARAMETERS, Crossed, Given, Loading
from blocksim.common.checks import require
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.common.files import json_of
from blocksim.simulation.simulated import SETTINGS
from blocksim.simulation.verdict import Verdict

EXIT_CODES = {Verdict.STANDS: 0, Verdict.COLLAPSES: 1, Verdict.UNDECIDED: 3}
OWN = ", or an engine of your own: its name, or module:ENGINE"
METHOD = option(f"{', '.join(CHOICES)}{OWN}.", default="auto")
OVER = option(f"Parameter: {', '.join(FAMILIES)}; thickness, of arches, if left out.")
WITHIN = option(
    "Where an engine searches, instead of where limit analysis says. Other methods "
    "search nowhere and refuse it.",
    metavar="LOW HIGH",
)
SET = option(
    f"Setting of the engine instead of its rule; repeatable: {', '.join(SETTINGS)}.",
    name="--set",
    metavar="NAME=VALUE",
)
REDUCE = option(
    "Simulate blocks that stay together as one, and half of an arch: pymunk does, "
    "pybullet does with arches. In space limit asks what planes of symmetry leave.",
    name="--reduce/--no-reduce",
)
MUST_REST = option(
    "Find out as well whether it must rest, or friction may let it move: "
    "a second with 8 joints, ten with 28.",
    default=False,
    name="--must-rest",
)
PROOF = option(
    "Write proofs of the answer by limit, JSON, which blocksim verify checks.", name="--proof"
)
CASES = option(
    "File of cases (.toml): what acts in each, with partial factors; the case that "
    "governs comes first.",
    name="--cases",
)
SPATIAL = option(
    "Ask in space: blocks of the plane are prisms, which may lean out of it.",
    default=False,
    name="--spatial",
)
JOINT = option(
    "Joint whose thrust is printed, named by its two blocks; the crown if left out.",
    name="--joint",
    metavar="A-B",
)
JSON = option("Print one JSON object, nothing else.", default=False, name="--json")
THICKNESS = "thickness"
"""The parameter of `bracket` that is left out: of arches."""


def require_given(instead: str = "", /, **options: object) -> None:
    """Name all options that are missing at once, and what may stand in their place."""
    absent = [name for name, value in options.items() if value is None]
    if absent:
        named = [option_of(name) for name in absent]
        listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
        raise InputError(listed, MISSING if len(named) == 1 else ALL_MISSING, f"given{instead}")


def option_of(field: str) -> str:
    """Return the option of a field."""
    return NAMED.get(field) or f"--{field.replace('_', '-')}"


def refuse(
    options: Mapping[str, object],
    known: Collection[str] = (),
    why: str = "left out: it is not known in space",
) -> None:
    """Refuse options that are given and mean nothing here, in space by default."""
    for name, value in options.items():
        unset = value is None or value is False or name in known
        require(unset, option_of(name), _as_given(value), why)


def _as_given(value: object) -> object:
    """Say a value of an option as it is given, a number as it is."""
    if isinstance(value, list | tuple):
        parts = map(_as_given, cast("Sequence[object]", value))
        words = [f"{each:g}" if isinstance(each, float) else str(each) for each in parts]
        return ("; " if isinstance(value, list) else " ").join(words)
    return str(value) if isinstance(value, PurePath) else value


def parameters_of(given: list[str] | None) -> dict[str, object]:
    """Read what `--with` gives: numbers, words, or JSON."""
    found: dict[str, object] = {}
    for each in given or ():
        name, equals, value = each.partition("=")
        ok = bool(name and equals and value) and name != "kind"
        require(ok, "--with", each, "name=value, with a parameter of the kind")
        require(name not in found, "--with", each, f"given once for {name}")
        try:
            found[name] = json_of(value.encode())
        except ValueError:
            found[name] = value
            # Numbers that JSON has not: .4 and +0.4.
            with suppress(ValueError):
                if math.isfinite(float(value)):
                    found[name] = float(value)
    return found


def settings_of(given: list[str] | None) -> dict[str, float]:
    """Read what `--set` gives."""
    settings: dict[str, float] = {}
    for each in given or ():
        name, _, value = each.partition("=")
        allowed = f"name=value, with a number and one of {', '.join(SETTINGS)}"
        require(name in SETTINGS, "--set", each, allowed)
        require(name not in settings, "--set", each, f"given once for {name}")
        try:
            settings[name] = float(value)
        except ValueError:
            raise InputError("--set", each, allowed) from None
    return settings


NAMED = {
    "parameters": "--with",
    "friction": "--mu",
    "shaking": "--shake",
    "moves": "--spread",
    **{field: f"--{option}" for option, field in PARAMETERS.items()},
}
"""Options that are not called as their fields."""
OPTIONS = {
    *NAMED,
    *(each.name for group in (Given, Loading, Crossed) for each in fields(group)),
    *("must_rest", "over", "within", "method", "tol", "reduce", "amplitudes"),
}
"""Fields that are options, too."""


@contextmanager
def named_options() -> Generator[None]:
    """Name the option, not the field, in what is said of wrong input."""
    try:
        yield
    except InputError as error:
        if error.where is None and error.field in OPTIONS:
            raise InputError(option_of(error.field), error.value, error.allowed) from None
        if error.where is None and error.field.startswith("settings"):
            _, _, name = error.field.partition(".")
            value = f"{name}={error.value:g}" if name else error.value
            raise InputError("--set", value, error.allowed) from None
        raise
