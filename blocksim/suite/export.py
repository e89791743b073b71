"""The suite as files: a scene each, in neutral JSON, MJCF (MuJoCo) and SDF (Gazebo, Drake)."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.common.checks import require
from blocksim.common.errors import perhaps
from blocksim.common.files import AnyPath, json_bytes, make_folder, shipped_files, write_whole
from blocksim.suite.families import LEVELS, Question, families
from blocksim.suite.scene import Body, Scene
from blocksim.suite.timed import Motion, motions


def mjcf(scene: Scene) -> bytes | None:
    """Return a scene as MJCF; None where it has pushes, which MJCF cannot say.

    A planar scene lies in the plane of x and y, whose bodies slide in it and turn about z.
    """
    if scene.pushes:
        return None
    root = Xml.Element("mujoco", model=scene.name)
    Xml.SubElement(root, "option", gravity=_said(_in_space(scene.gravity)))
    assets = Xml.SubElement(root, "asset")
    world = Xml.SubElement(root, "worldbody")
    for at, body in enumerate(scene.bodies):
        told = Xml.SubElement(world, "body", name=body.name, pos=_said(_in_space(body.centre)))
        if not body.fixed:
            _joints(told, planar=scene.dimensions == 2)
            inertia = _inertia(body)
            entries = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
            Xml.SubElement(
                told, "inertial", pos="0 0 0", mass=repr(body.mass), fullinertia=_said(entries)
            )
        for part, shape in enumerate(body.shapes):
            name = f"mesh {at} {part}"
            Xml.SubElement(assets, "mesh", name=name, vertex=_said(_corners(body, shape)))
            Xml.SubElement(
                told, "geom", type="mesh", mesh=name, friction=f"{scene.friction!r} 0 0"
            )
    moving = [_velocity(body) for body in scene.moving]
    if np.any(moving):
        frame = Xml.SubElement(root, "keyframe")
        Xml.SubElement(frame, "key", name="start", qvel=_said(np.concatenate(moving)))
    return _text(root)


def sdf(scene: Scene) -> bytes | None:
    """Return a planar scene as SDF; None where SDF cannot say it.

    That is of pushes, velocities at the start, and polyhedra, which SDF takes from other files.
    """
    if scene.pushes or scene.dimensions != 2 or any(map(_moves, scene.moving)):
        return None
    root = Xml.Element("sdf", version="1.9")
    world = Xml.SubElement(root, "world", name=scene.name)
    _says(world, "gravity", _said(_in_space(scene.gravity)))
    for body in scene.bodies:
        model = Xml.SubElement(world, "model", name=body.name)
        _says(model, "static", "true" if body.fixed else "false")
        _says(model, "pose", _said([*_in_space(body.centre), 0, 0, 0]))
        link = Xml.SubElement(model, "link", name="link")
        if not body.fixed:
            inertial = Xml.SubElement(link, "inertial")
            _says(inertial, "mass", repr(body.mass))
            told = Xml.SubElement(inertial, "inertia")
            for axis, value in zip("xyz", np.diag(_inertia(body)).tolist(), strict=True):
                _says(told, f"i{axis}{axis}", repr(value))
        for part, shape in enumerate(body.shapes):
            collision = Xml.SubElement(link, "collision", name=f"part {part}")
            _says(collision, "pose", _said([0, 0, -body.depth / 2, 0, 0, 0]))
            line = Xml.SubElement(Xml.SubElement(collision, "geometry"), "polyline")
            for corner in shape - body.centre:
                _says(line, "point", _said(corner))
            _says(line, "height", repr(body.depth))
            surface = Xml.SubElement(Xml.SubElement(collision, "surface"), "friction")
            ode = Xml.SubElement(surface, "ode")
            for name in ("mu", "mu2"):
                _says(ode, name, repr(scene.friction))
    return _text(root)


def _joints(body: Xml.Element, *, planar: bool) -> None:
    if not planar:
        Xml.SubElement(body, "freejoint")
        return
    for kind, axis in (("slide", "1 0 0"), ("slide", "0 1 0"), ("hinge", "0 0 1")):
        Xml.SubElement(body, "joint", type=kind, axis=axis)


def _inertia(body: Body) -> Array:
    """Inertia about the centre of mass, of a planar body as of a prism, (3, 3)."""
    if len(body.centre) == 3:
        return np.asarray(body.inertia)
    about_z = float(np.asarray(body.inertia))
    # Enough for what moves in its plane: shared evenly, and the depth's part.
    other = about_z / 2 + body.mass * body.depth**2 / 12
    return np.diag([other, other, about_z])


def _velocity(body: Body) -> Array:
    velocity = np.zeros(len(body.centre)) if body.velocity is None else body.velocity
    spin = np.atleast_1d(body.spin)
    return np.concatenate([velocity, spin if len(velocity) == 2 else np.resize(spin, 3)])


def _moves(body: Body) -> bool:
    return bool(np.any(_velocity(body)))


def _corners(body: Body, shape: Array) -> Array:
    """Corners about the centre of mass, of a polygon those of its prism, (k, 3) float."""
    about = shape - body.centre
    if about.shape[1] == 3:
        return about
    ends = [np.full((len(about), 1), side * body.depth / 2) for side in (-1, 1)]
    return np.concatenate([np.hstack([about, end]) for end in ends])


def _in_space(vector: Array) -> Array:
    return np.resize(np.append(vector, 0.0), 3)


def _said(numbers: Array | Sequence[float]) -> str:
    return " ".join(repr(float(each)) for each in np.ravel(numbers))


def _says(parent: Xml.Element, name: str, text: str) -> None:
    Xml.SubElement(parent, name).text = text


def _text(root: Xml.Element) -> bytes:
    Xml.indent(root)
    return Xml.tostring(root, xml_declaration=True, encoding="utf-8") + b"\n"


WRITERS: dict[str, tuple[str, Callable[[Scene], bytes | None]]] = {
    "scenes": ("json", lambda scene: json_bytes(scene.record())),
    "mjcf": ("xml", mjcf),
    "sdf": ("sdf", sdf),
}
"""Folders, each with the ending of its files and what writes one; None is left out."""


@cache
def questions() -> dict[str, Question | Motion]:
    """Return all scenes by name, with their answers."""
    asked: list[Question | Motion] = [
        each for family in families() for each in family.questions
    ]
    return {each.name: each for each in (*asked, *motions())}


def groups() -> list[str]:
    """Return the groups of scenes, in order."""
    return list(dict.fromkeys(each.group for each in questions().values()))


def chosen(levels: Collection[float] = (), within: Collection[str] = ()) -> Iterator[Scene]:
    """Return scenes at the levels [%] and of the groups named, or all.

    Scenes whose motion is asked for have no level, and come where no level is named.
    """
    for level in levels:
        known = ", ".join(f"{each:g}" for each in LEVELS)
        require(level in LEVELS, "--level", level, f"one of {known}")
    for group in within:
        known = groups()
        allowed = f"one of {', '.join(known)}{perhaps(group, known)}"
        require(group in known, "--group", group, allowed)

    def is_asked(each: Question | Motion) -> bool:
        if levels and (isinstance(each, Motion) or each.level not in levels):
            return False
        return not within or each.group in within

    return (each.scene for each in questions().values() if is_asked(each))


def export(folder: AnyPath, scenes: Iterator[Scene]) -> dict[str, int]:
    """Write scenes, their schemas and the page that explains them.

    Returns: Number of files of each kind.
    """
    folder, count = Path(folder), dict.fromkeys(WRITERS, 0)
    for name in WRITERS:
        make_folder(folder / name)
    for path in (
        *shipped_files("suite/*.md").values(),
        *shipped_files("suite/*.schema.json").values(),
    ):
        text = path.read_bytes()
        write_whole(folder / path.name, lambda file, text=text: file.write(text))
    for scene in scenes:
        for name, (ending, written) in WRITERS.items():
            text = written(scene)
            if text is None:
                continue
            place = folder / name / f"{scene.name}.{ending}"
            write_whole(place, lambda file, text=text: file.write(text))
            count[name] += 1
    return count
