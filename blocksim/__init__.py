"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

from blocksim.common import interrupts

if interrupts.is_program():
    # Before the imports below, which take a second.
    interrupts.install()

from blocksim.arch.bracket import Bracket as Bracket
from blocksim.arch.bracket import bracket as bracket
from blocksim.arch.check import ArchCheck as ArchCheck
from blocksim.arch.check import check as check
from blocksim.arch.circular import Arch as Arch
from blocksim.arch.modes import Mode as Mode
from blocksim.arch.motion import load_recording as load_recording
from blocksim.arch.motion import simulate as simulate
from blocksim.blocks.assembly import Assembly as Assembly
from blocksim.blocks.assembly import Block as Block
from blocksim.blocks.assembly import Joint as Joint
from blocksim.blocks.joints import JointState as JointState
from blocksim.blocks.problem import Load as Load
from blocksim.blocks.problem import Problem as Problem
from blocksim.common.errors import BlocksimError as BlocksimError
from blocksim.common.errors import InputError as InputError
from blocksim.common.errors import MissingPart as MissingPart
from blocksim.common.version import __version__ as __version__
from blocksim.evidence.recording import Recording as Recording
from blocksim.evidence.verdict import Verdict as Verdict
from blocksim.kinds.files import load_structure as load_structure
from blocksim.kinds.files import structure_of as structure_of
from blocksim.limit import collapse as collapse
from blocksim.limit import equilibrium as equilibrium
