"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

import importlib as _importlib
from typing import Any as _Any
from typing import cast as _cast

from blocksim.common import interrupts
from blocksim.common import shown as _shown
from blocksim.common.version import __version__

if interrupts.is_program():
    # Before the imports that commands make.
    interrupts.install()

# The package is above all its rooms, and names who shows things of theirs in a notebook.
_shown.show_by(lambda: _cast(_Any, _importlib.import_module("blocksim.notebook")))

TYPE_CHECKING = False
if TYPE_CHECKING:
    from blocksim.arch.circular import Arch
    from blocksim.arch.modes import Mode
    from blocksim.ask.bracket import Bracket, bracket
    from blocksim.ask.bulk import Told, check_many
    from blocksim.ask.check import Check, check
    from blocksim.ask.citing import cite
    from blocksim.ask.options import Options
    from blocksim.ask.simulate import simulate
    from blocksim.blocks.assembly import Assembly, Block, Joint
    from blocksim.blocks.given import Body, GivenJoint
    from blocksim.blocks.joints import JointState
    from blocksim.blocks.made import Built, Fill, Made
    from blocksim.blocks.maker import Maker, Table, count, metres, parameter
    from blocksim.blocks.problem import Load, Problem
    from blocksim.blocks.space.assembly import FaceJoint, Solid, assembly_in_space
    from blocksim.blocks.space.extruded import extruded
    from blocksim.blocks.space.maker import SolidMaker
    from blocksim.blocks.space.problem import SpatialProblem
    from blocksim.common.errors import BlocksimError, InputError, MachineError, MissingPart
    from blocksim.kinds.arcade import Arcade
    from blocksim.kinds.basket import BasketHandleArch
    from blocksim.kinds.catenary import CatenaryArch
    from blocksim.kinds.circular import CircularArch
    from blocksim.kinds.column import Column
    from blocksim.kinds.corbeldome import CorbelDome
    from blocksim.kinds.dome import Dome
    from blocksim.kinds.elliptic import EllipticArch
    from blocksim.kinds.files import load_in_space, load_structure, structure_of
    from blocksim.kinds.flat import FlatArch
    from blocksim.kinds.loading import load
    from blocksim.kinds.offers import Offers
    from blocksim.kinds.parabolic import ParabolicArch
    from blocksim.kinds.pointed import PointedArch
    from blocksim.kinds.portal import Portal
    from blocksim.kinds.recorded import load_recording
    from blocksim.kinds.returnwall import ReturnWall
    from blocksim.kinds.rubble import Rubble
    from blocksim.kinds.skewarch import BarrelVault, SkewArch
    from blocksim.kinds.stack import Stack
    from blocksim.kinds.tower import Tower
    from blocksim.kinds.wall import Wall
    from blocksim.limit import collapse, equilibrium
    from blocksim.simulation.recording import Recording
    from blocksim.simulation.verdict import Evidence, Verdict
    from blocksim.sweeps.run import sweep

__all__ = [
    "Arcade",
    "Arch",
    "Assembly",
    "BarrelVault",
    "BasketHandleArch",
    "Block",
    "BlocksimError",
    "Body",
    "Bracket",
    "Built",
    "CatenaryArch",
    "Check",
    "CircularArch",
    "Column",
    "CorbelDome",
    "Dome",
    "EllipticArch",
    "Evidence",
    "FaceJoint",
    "Fill",
    "FlatArch",
    "GivenJoint",
    "InputError",
    "Joint",
    "JointState",
    "Load",
    "MachineError",
    "Made",
    "Maker",
    "MissingPart",
    "Mode",
    "Offers",
    "Options",
    "ParabolicArch",
    "PointedArch",
    "Portal",
    "Problem",
    "Recording",
    "ReturnWall",
    "Rubble",
    "SkewArch",
    "Solid",
    "SolidMaker",
    "SpatialProblem",
    "Stack",
    "Table",
    "Told",
    "Tower",
    "Verdict",
    "Wall",
    "__version__",
    "assembly_in_space",
    "bracket",
    "check",
    "check_many",
    "cite",
    "collapse",
    "count",
    "equilibrium",
    "extruded",
    "load",
    "load_in_space",
    "load_recording",
    "load_structure",
    "metres",
    "parameter",
    "simulate",
    "structure_of",
    "sweep",
]

_PLACES = {
    "arch.circular": ("Arch",),
    "arch.modes": ("Mode",),
    "ask.bracket": ("Bracket", "bracket"),
    "ask.bulk": ("Told", "check_many"),
    "ask.check": ("Check", "check"),
    "ask.citing": ("cite",),
    "ask.options": ("Options",),
    "ask.simulate": ("simulate",),
    "blocks.assembly": ("Assembly", "Block", "Joint"),
    "blocks.given": ("Body", "GivenJoint"),
    "blocks.joints": ("JointState",),
    "blocks.made": ("Built", "Fill", "Made"),
    "blocks.maker": ("Maker", "Table", "count", "metres", "parameter"),
    "blocks.problem": ("Load", "Problem"),
    "blocks.space.assembly": ("FaceJoint", "Solid", "assembly_in_space"),
    "blocks.space.problem": ("SpatialProblem",),
    "common.errors": ("BlocksimError", "InputError", "MachineError", "MissingPart"),
    "simulation.recording": ("Recording",),
    "simulation.verdict": ("Evidence", "Verdict"),
    "kinds.arcade": ("Arcade",),
    "kinds.basket": ("BasketHandleArch",),
    "kinds.catenary": ("CatenaryArch",),
    "kinds.circular": ("CircularArch",),
    "kinds.column": ("Column",),
    "kinds.elliptic": ("EllipticArch",),
    "kinds.files": ("load_in_space", "load_structure", "structure_of"),
    "kinds.flat": ("FlatArch",),
    "kinds.loading": ("load",),
    "kinds.offers": ("Offers",),
    "kinds.parabolic": ("ParabolicArch",),
    "kinds.pointed": ("PointedArch",),
    "kinds.portal": ("Portal",),
    "kinds.recorded": ("load_recording",),
    "kinds.rubble": ("Rubble",),
    "kinds.stack": ("Stack",),
    "kinds.wall": ("Wall",),
    "kinds.corbeldome": ("CorbelDome",),
    "kinds.dome": ("Dome",),
    "kinds.returnwall": ("ReturnWall",),
    "kinds.skewarch": ("BarrelVault", "SkewArch"),
    "kinds.tower": ("Tower",),
    "blocks.space.extruded": ("extruded",),
    "blocks.space.maker": ("SolidMaker",),
    "limit": ("collapse", "equilibrium"),
    "sweeps.run": ("sweep",),
}
"""Where the public names are; each is loaded when it is first used."""


def __getattr__(name: str) -> object:
    """Load a public name."""
    for place, names in _PLACES.items():
        if name in names:
            found = getattr(_importlib.import_module(f"blocksim.{place}"), name)
            globals()[name] = found
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return sorted({*globals(), *__all__})
