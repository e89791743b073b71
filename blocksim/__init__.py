"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

from blocksim.common import interrupts

if interrupts.is_program():
    # Before the imports below, which take a second.
    interrupts.install()

from blocksim.arch.bracket import Bracket, bracket
from blocksim.arch.check import ArchCheck, check
from blocksim.arch.circular import Arch
from blocksim.arch.modes import Mode
from blocksim.arch.motion import load_recording, simulate
from blocksim.blocks.assembly import Assembly, Block, Joint
from blocksim.blocks.joints import JointState
from blocksim.blocks.problem import Load, Problem
from blocksim.common.errors import BlocksimError, InputError, MissingPart
from blocksim.common.version import __version__
from blocksim.evidence.recording import Recording
from blocksim.evidence.verdict import Verdict
from blocksim.kinds.files import load_structure, structure_of
from blocksim.limit import collapse, equilibrium

__all__ = [
    "Arch",
    "ArchCheck",
    "Assembly",
    "Block",
    "BlocksimError",
    "Bracket",
    "InputError",
    "Joint",
    "JointState",
    "Load",
    "MissingPart",
    "Mode",
    "Problem",
    "Recording",
    "Verdict",
    "__version__",
    "bracket",
    "check",
    "collapse",
    "equilibrium",
    "load_recording",
    "load_structure",
    "simulate",
    "structure_of",
]
