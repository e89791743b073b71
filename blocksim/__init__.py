"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

import importlib as _importlib

from blocksim.common import interrupts
from blocksim.common import shown as _shown
from blocksim.common.version import __version__ as __version__

if interrupts.is_program():
    # Before the imports that commands make.
    interrupts.install()

# The package is above all its rooms, and names who shows things of theirs in a notebook.
_shown.show_by(lambda: _importlib.import_module("blocksim.notebook"))

TYPE_CHECKING = False
if TYPE_CHECKING:
    from blocksim.arch.circular import Arch as Arch
    from blocksim.arch.modes import Mode as Mode
    from blocksim.ask.answer import Check as Check
    from blocksim.ask.bracket import Bracket as Bracket
    from blocksim.ask.bracket import bracket as bracket
    from blocksim.ask.bulk import Told as Told
    from blocksim.ask.bulk import check_many as check_many
    from blocksim.ask.cases import Case as Case
    from blocksim.ask.cases import Cases as Cases
    from blocksim.ask.cases import Factors as Factors
    from blocksim.ask.cases import check_cases as check_cases
    from blocksim.ask.check import check as check
    from blocksim.ask.doctor import cite as cite
    from blocksim.ask.options import Options as Options
    from blocksim.ask.simulate import simulate as simulate
    from blocksim.blocks.assembly import Assembly as Assembly
    from blocksim.blocks.assembly import Block as Block
    from blocksim.blocks.assembly import Joint as Joint
    from blocksim.blocks.given import Body as Body
    from blocksim.blocks.given import GivenJoint as GivenJoint
    from blocksim.blocks.joints import JointState as JointState
    from blocksim.blocks.made import Built as Built
    from blocksim.blocks.made import Fill as Fill
    from blocksim.blocks.made import Made as Made
    from blocksim.blocks.maker import Maker as Maker
    from blocksim.blocks.maker import Table as Table
    from blocksim.blocks.maker import count as count
    from blocksim.blocks.maker import metres as metres
    from blocksim.blocks.maker import parameter as parameter
    from blocksim.blocks.polygons import assembly_of_polygons as assembly_of_polygons
    from blocksim.blocks.problem import Load as Load
    from blocksim.blocks.problem import Problem as Problem
    from blocksim.blocks.space.assembly import FaceJoint as FaceJoint
    from blocksim.blocks.space.assembly import Solid as Solid
    from blocksim.blocks.space.assembly import SpatialAssembly as SpatialAssembly
    from blocksim.blocks.space.extruded import extruded as extruded
    from blocksim.blocks.space.joining import assembly_in_space as assembly_in_space
    from blocksim.blocks.space.maker import SolidMaker as SolidMaker
    from blocksim.common.errors import BlocksimError as BlocksimError
    from blocksim.common.errors import InputError as InputError
    from blocksim.common.errors import MachineError as MachineError
    from blocksim.common.errors import MissingPart as MissingPart
    from blocksim.kinds.arcade import Arcade as Arcade
    from blocksim.kinds.basket import BasketHandleArch as BasketHandleArch
    from blocksim.kinds.catenary import CatenaryArch as CatenaryArch
    from blocksim.kinds.circular import CircularArch as CircularArch
    from blocksim.kinds.column import Column as Column
    from blocksim.kinds.corbeldome import CorbelDome as CorbelDome
    from blocksim.kinds.dome import Dome as Dome
    from blocksim.kinds.elliptic import EllipticArch as EllipticArch
    from blocksim.kinds.files import load_structure as load_structure
    from blocksim.kinds.files import structure_of as structure_of
    from blocksim.kinds.flat import FlatArch as FlatArch
    from blocksim.kinds.groinvault import GroinVault as GroinVault
    from blocksim.kinds.loading import load as load
    from blocksim.kinds.loading import load_recording as load_recording
    from blocksim.kinds.offers import Offers as Offers
    from blocksim.kinds.parabolic import ParabolicArch as ParabolicArch
    from blocksim.kinds.pointed import PointedArch as PointedArch
    from blocksim.kinds.portal import Portal as Portal
    from blocksim.kinds.returnwall import ReturnWall as ReturnWall
    from blocksim.kinds.rubble import Rubble as Rubble
    from blocksim.kinds.skewarch import BarrelVault as BarrelVault
    from blocksim.kinds.skewarch import SkewArch as SkewArch
    from blocksim.kinds.stack import Stack as Stack
    from blocksim.kinds.tower import Tower as Tower
    from blocksim.kinds.wall import Wall as Wall
    from blocksim.limit import collapse as collapse
    from blocksim.limit import equilibrium as equilibrium
    from blocksim.simulation.recording import Recording as Recording
    from blocksim.simulation.verdict import Evidence as Evidence
    from blocksim.simulation.verdict import Verdict as Verdict
    from blocksim.sweeps.case import SweepRow as SweepRow
    from blocksim.sweeps.fragility import Fragility as Fragility
    from blocksim.sweeps.fragility import fragility as fragility
    from blocksim.sweeps.load import load_design as load_design
    from blocksim.sweeps.run import Summary as Summary
    from blocksim.sweeps.run import sweep as sweep
    from blocksim.sweeps.shards import read_rows as read_rows
    from blocksim.sweeps.table import to_pandas as to_pandas
    from blocksim.sweeps.table import write_csv as write_csv
    from blocksim.sweeps.table import write_parquet as write_parquet

_PLACES = {
    "arch.circular": ("Arch",),
    "arch.modes": ("Mode",),
    "ask.bracket": ("Bracket", "bracket"),
    "ask.bulk": ("Told", "check_many"),
    "ask.cases": ("Case", "Cases", "Factors", "check_cases"),
    "ask.answer": ("Check",),
    "ask.check": ("check",),
    "ask.doctor": ("cite",),
    "sweeps.fragility": ("Fragility", "fragility"),
    "ask.options": ("Options",),
    "ask.simulate": ("simulate",),
    "blocks.assembly": ("Assembly", "Block", "Joint"),
    "blocks.given": ("Body", "GivenJoint"),
    "blocks.joints": ("JointState",),
    "blocks.made": ("Built", "Fill", "Made"),
    "blocks.maker": ("Maker", "Table", "count", "metres", "parameter"),
    "blocks.polygons": ("assembly_of_polygons",),
    "blocks.problem": ("Load", "Problem"),
    "blocks.space.assembly": ("FaceJoint", "Solid", "SpatialAssembly"),
    "common.errors": ("BlocksimError", "InputError", "MachineError", "MissingPart"),
    "simulation.recording": ("Recording",),
    "simulation.verdict": ("Evidence", "Verdict"),
    "kinds.files": ("load_structure", "structure_of"),
    "kinds.loading": ("load", "load_recording"),
    "kinds.offers": ("Offers",),
    "blocks.space.extruded": ("extruded",),
    "blocks.space.joining": ("assembly_in_space",),
    "blocks.space.maker": ("SolidMaker",),
    "limit": ("collapse", "equilibrium"),
    "sweeps.case": ("SweepRow",),
    "sweeps.load": ("load_design",),
    "sweeps.run": ("Summary", "sweep"),
    "sweeps.shards": ("read_rows",),
    "sweeps.table": ("to_pandas", "write_csv", "write_parquet"),
}
"""Where public names are, besides those of kinds; each is loaded when it is first used."""


def _places() -> dict[str, str]:
    """Return the module of each public name."""
    from blocksim.kinds import PLACES

    kinds = (place.partition(".") for place in PLACES.values())
    places = {name: f"kinds.{file}" for file, _, name in kinds}
    return places | {name: place for place, names in _PLACES.items() for name in names}


def __getattr__(name: str) -> object:
    """Load a public name; `__all__` is the list of them."""
    places = _places()
    if name == "__all__":
        return sorted({*places, "__version__"})
    if name in places:
        found = getattr(_importlib.import_module(f"blocksim.{places[name]}"), name)
        globals()[name] = found
        return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return sorted({*globals(), *_places()})
