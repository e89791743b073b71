"""What is asked about: a file, a shipped name, a kind, or the circular arch by its options."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from blocksim.arch.dimensions import require_unit_weight
from blocksim.blocks.problem import Problem
from blocksim.cli.arguments import argument
from blocksim.cli.given import Given, Loading
from blocksim.cli.options import named_options, option_of, parameters_of, refuse, require_given
from blocksim.common.checks import is_number, require
from blocksim.common.errors import InputError
from blocksim.common.fields import same
from blocksim.kinds.circular import CircularArch
from blocksim.kinds.ways import ASIDE, DENSITY, THICK

if TYPE_CHECKING:
    from blocksim.reading.asked import Reading

STREAM = "-"
"""Subject that means JSON lines on standard input."""
IN_METRES = " (or --span, --rise and --thickness, in m)"


@dataclass(frozen=True, kw_only=True)
class Subject:
    """What is asked about, and what acts on it: a structure, or the arch by its options."""

    given: Given
    loading: Loading
    scene: str | None = argument(
        "A structure: a file, .json or .toml, or a shipped name (blocksim scenarios); or a "
        "kind: its name (blocksim kinds), or module:CLASS of your own. To render, a recording, "
        ".npz, as well."
    )

    @property
    def options(self) -> dict[str, object]:
        """All options, given or not."""
        return {**asdict(self.given), **asdict(self.loading)}

    @property
    def is_many(self) -> bool:
        """Whether it is a stream or a folder of structures."""
        try:
            return self.scene == STREAM or bool(self.scene and Path(self.scene).is_dir())
        except (OSError, ValueError):
            # No name of a file: whatever reads it says so.
            return False


def anything_asked(
    asked: Subject,
    *,
    spatial: bool = False,
    tilts: bool = False,
    pushes: bool = False,
    thick: bool = False,
    sought: bool = False,
    **needed: object,
) -> Problem[Any]:
    """Return what is asked about, in the plane or in space, and what the options put on it.

    `thick`, `sought`, `needed`: As of `arch_asked`.
    `spatial`: Whether blocks of the plane are asked as prisms.
    `tilts`, `pushes`: Whether the question tilts or pushes them.
    """
    # Prisms tilt in space, towards any side; what is of the plane tilts in it.
    given, loading = asked.given, asked.loading
    late = spatial and loading.azimuth is not None
    acting = replace(loading, tilt=None, push=None) if late else loading
    if asked.scene is None:
        found = arch_asked(given, thick=thick, sought=sought, **needed)
        if acting.given or given.lean is not None:
            from blocksim.cli.road import loaded

            found = loaded(found, Given(lean=given.lean), acting)
    else:
        require_given(**needed)
        found = structure(asked.scene, given, acting)
    in_space = found.in_space or spatial
    ways = loading.tilt, loading.push, found.shaking
    given_way = pushes or tilts or any(each is not None for each in ways)
    beside = "left out, or --tilt, --push or --shake beside it"
    prisms = "prisms are by --spatial of check, bracket and simulate"
    allowed = beside if in_space else f"left out: it is of blocks in space; {prisms}"
    usable = in_space and given_way
    require(usable or loading.azimuth is None, "--azimuth", loading.azimuth, allowed)
    if not spatial:
        return found
    from blocksim.blocks.road import require_upright
    from blocksim.blocks.space.extruded import extruded

    if tilts or (late and loading.tilt is not None):
        # Prisms do not know what of their loads lies on a road.
        name, turn = (
            ("--over", "tilt") if tilts else ("--tilt", math.radians(loading.tilt or 0.0))
        )
        require_upright(found, name, turn)
    with named_options():
        made = found if found.in_space else extruded(found)
    if loading.azimuth is not None:
        made = replace(made, azimuth=math.radians(loading.azimuth))
    if late and loading.tilt:
        made = made.tilted(math.radians(loading.tilt))
    if late and loading.push is not None:
        from blocksim.ask.push import pushed

        made = pushed(made, loading.push)
    return made


def is_thick(given: Given) -> bool:
    """Tell whether options say how thick an arch is."""
    return any(getattr(given, name) is not None for name in THICK)


def arch_of(given: Given, *, thick: bool = False, **needed: object) -> CircularArch:
    """Return what makes the arch that options describe.

    `thick`: Whether a thickness has to be given; where none is, it is `ASIDE` of the least.
    `needed`: Other options that have to be given, by name.
    """
    measured = given.measured
    sizes, thickness = (("span", "rise"), "thickness") if measured else (("alpha",), "eta")
    lacking = {thickness: None} if thick and not is_thick(given) else {}
    mu = given.mu if given.friction_angle is None else given.friction_angle
    others = [*(["--friction-angle"] if mu is None else []), *(["--ratio"] if lacking else [])]
    instead = f" (or {', '.join(others)})" if others else ""
    if not measured and given.alpha is None:
        instead = IN_METRES
    require_given(instead, **needed, **same(given, *sizes), mu=mu, **lacking)
    refuse(given.drawn, why="left out: it is of drawings, and this is an arch")
    refuse({"parameters": given.parameters}, why="left out: it is for kinds of structures")
    _require_degrees(given.alpha)
    if given.unit_weight is not None:
        require_unit_weight("--unit-weight", given.unit_weight)
    table: dict[str, Any] = {
        "weight": "sector" if measured else "centreline",
        "density": DENSITY if given.unit_weight is None else 1000 * given.unit_weight,
        **({} if given.depth is None else {"depth": given.depth}),
        **({} if is_thick(given) else {"ratio": ASIDE}),
        **given.sizes,
    }
    with named_options():
        return CircularArch(**table)


def arch_asked(
    given: Given, *, thick: bool = False, sought: bool = False, **needed: object
) -> Problem:
    """Return the arch that options describe, under its own weight, upright.

    `thick`, `needed`: As of `arch_of`.
    `sought`: Whether its thickness is what is sought.
    """
    if sought and not is_thick(given):
        given = replace(given, eta=1.0)
    problem = arch_of(given, thick=thick, **needed).problem()
    if not is_thick(given):
        note = f"no thickness was given, so it is {ASIDE:g} of the least as built"
        problem = replace(problem, notes=(note,))
    return problem


def _require_degrees(alpha: float | None) -> None:
    """Raise `InputError` for a half-angle that is none in degrees."""
    if alpha is not None:
        ok = is_number(alpha, 0, math.nextafter(180, 0))
        require(ok, "--alpha", alpha, "above 0 and below 180 deg")
        flat = f"in degrees: {alpha:g} deg is nearly flat, in radians it would be "
        flat += f"{math.degrees(alpha):.4g} deg (a flat arch: --span and --rise)"
        require(alpha > math.pi, "--alpha", alpha, flat)


def structure(scene: str, given: Given, loading: Loading) -> Problem[Any]:
    """Read or make a structure and put on it what the options say."""
    # An arch by its options is answered sooner than readers of files are loaded.
    from blocksim.cli.road import loaded
    from blocksim.kinds import KINDS, own_kind
    from blocksim.kinds.changes import edited
    from blocksim.kinds.files import is_drawing, load_structure, structure_of

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
                reading=reading_of(given.unit, given.layer, given.snap, given.up),
            )
    except InputError as error:
        name = error.field.partition("[")[0]
        if name not in changes:
            raise
        if name in sizes:
            raise InputError(option_of(name), error.value, error.allowed) from None
        raise InputError("--with", f"{error.field}={error.value}", error.allowed) from None
    return loaded(built, given, loading)


def reading_of(
    unit: str | None, layer: list[str] | None, snap: float | None = None, up: str | None = None
) -> Reading:
    """Read what `--unit`, `--layer`, `--snap` and `--up` say of a drawing or a mesh."""
    from blocksim.reading.asked import ROLES, Reading

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
        upwards = cast('Literal["y", "z"] | None', up)
        return Reading(unit=metres, layers=layers, snap=snap, up=upwards)


def _is_place(scene: str) -> bool:
    """Tell the place of a kind of one's own, ``module:CLASS``, from a file's name."""
    module, colon, name = scene.partition(":")
    named = all(part.isidentifier() for part in module.split("."))
    return bool(colon) and named and name.isidentifier()
