"""Families of scenes that ask whether blocks stand, and how each scene is made."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any, Literal

import numpy as np

from blocksim.ask.families import FAMILIES
from blocksim.blocks.assembly import Array, Support
from blocksim.blocks.outlines import counter_clockwise
from blocksim.blocks.problem import STANDARD_GRAVITY, Problem
from blocksim.common.files import shipped_files, toml_of
from blocksim.kinds import KINDS
from blocksim.kinds.files import structure_of
from blocksim.suite.scene import BOUND, Scene, acting, bodies_of

LEVELS = (20.0, 10.0, 5.0, 2.0, 1.0, 0.1)
"""How far scenes are from the limit, on both sides of it [%]."""
WEIGHT = 19_620.0
"""Weight of the blocks [N/m^3]."""
SLOWEST = 0.2
"""Acceleration with which a scene falls at the least, over that share of g by which it is
beyond its limit; its duration follows from that."""
LEFT = 5.0
"""Bounds that a scene which falls has moved by at its end, or more."""
FRAMES = 10
"""Times besides the start at which poses are asked for."""


@dataclass(frozen=True, kw_only=True)
class Family:
    """A structure for each value of one parameter. Fields are the keys of the file.

    `over`: The parameter: load, tilt, mu, or one of the structure's kind.
    `stands`, {"low", "high"}: At which end it stands.
    `critical`: The value at which that changes.
    `structure`: A structure file's content.
    `known`: Where the critical value comes from, if not from limit analysis.
    `tilt_deg`: By which the table is tilted.
    `azimuth_deg`: Of blocks in space, towards where, from x towards y.
    `foot`: Depth to which supports behind springings are cut: those of an arch that is nearly a
        ring would meet [m].
    """

    name: str
    group: str
    over: str
    stands: Literal["low", "high"]
    critical: float
    structure: dict[str, Any]
    known: str = ""
    tilt_deg: float = 0.0
    azimuth_deg: float = 0.0
    foot: float | None = None

    @property
    def spatial(self) -> bool:
        """Whether its blocks lie in space."""
        kind = str(self.structure.get("kind"))
        return kind in KINDS and KINDS[kind].in_space

    @cached_property
    def _built(self) -> Problem[Any]:
        said: dict[str, Any] = {"density": WEIGHT, **self.structure}
        built = replace(structure_of(said), azimuth=math.radians(self.azimuth_deg))
        return built.tilted(math.radians(self.tilt_deg)) if self.tilt_deg else built

    def at(self, value: float) -> Problem[Any]:
        """Return the structure at a value of the parameter."""
        built = self._built
        if self.over in FAMILIES:
            found = FAMILIES[self.over](built).at(value)
        else:
            found = built.but(**{self.over: value})
        if self.foot is None or found.in_space:
            return found
        return _footed(found, self.foot)

    @property
    def questions(self) -> Iterator[Question]:
        """The scenes, in an order that says nothing of their answers."""
        every = [
            (level, stands, hashlib.sha256(f"{self.name} {level} {stands}".encode()).digest())
            for level in LEVELS
            for stands in (True, False)
        ]
        for number, (level, stands, _) in enumerate(sorted(every, key=lambda each: each[2])):
            yield Question(
                family=self, name=f"{self.name}-{number + 1:02}", level=level, stands=stands
            )


@dataclass(frozen=True, kw_only=True)
class Question:
    """Whether one structure stands, and the answer."""

    family: Family
    name: str
    level: float
    stands: bool

    @property
    def group(self) -> str:
        """Kind of structure that it is of."""
        return self.family.group

    @cached_property
    def problem(self) -> Problem[Any]:
        """The structure that is asked about."""
        below = self.stands == (self.family.stands == "low")
        share = self.level / 100 * (-1 if below else 1)
        return self.family.at(self.family.critical * (1 + share))

    @cached_property
    def scene(self) -> Scene:
        """The scene that engines are given."""
        gravity, pushes = acting(self.problem)
        bodies = bodies_of(self.problem)
        masses = [body.mass for body in bodies if not body.fixed]
        volume = float(np.mean(masses)) * STANDARD_GRAVITY / WEIGHT
        bound = BOUND * volume ** (1 / len(gravity))
        # A corner that gains speed evenly goes so far in that time.
        least = SLOWEST * self.level / 100 * STANDARD_GRAVITY
        duration = round(math.sqrt(2 * LEFT * bound / least), 2)
        return Scene(
            name=self.name,
            group=self.group,
            level=self.level,
            gravity=gravity,
            friction=self.problem.mu,
            bodies=bodies,
            pushes=pushes,
            times=np.linspace(0.0, duration, FRAMES + 1),
            bound=bound,
        )


def _footed(problem: Problem, depth: float) -> Problem:
    """Return an arch with supports of so little depth behind its springings."""
    assembly = problem.assembly
    made: list[Support] = []
    for index, support in enumerate(assembly.supports):
        joint = next(each for each in assembly.joints if each.support == index)
        ends = np.array([joint.inner, joint.outer])
        bearer = 1.0 if joint.before == -1 else -1.0
        out: Array = -bearer * depth * joint.normal
        corners = np.concatenate([ends, ends[::-1] + out])
        turned = counter_clockwise(corners)
        made.append(Support((turned,), support.name))
    return replace(problem, assembly=replace(assembly, supports=tuple(made)))


@cache
def families() -> tuple[Family, ...]:
    """Read the families that come with blocksim."""
    found: list[Family] = []
    for path in shipped_files("suite/*.toml").values():
        found += [Family(**each) for each in toml_of(path.read_bytes())["family"]]
    return tuple(found)
