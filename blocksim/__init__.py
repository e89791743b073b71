"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

from blocksim import interrupts

if interrupts.is_program():
    # Before the imports below, which take a second.
    interrupts.install()

from blocksim.arch import Arch as Arch
from blocksim.assembly import Assembly as Assembly
from blocksim.assembly import Block as Block
from blocksim.assembly import Joint as Joint
from blocksim.bracket import Bracket as Bracket
from blocksim.bracket import bracket as bracket
from blocksim.check import Check as Check
from blocksim.check import check as check
from blocksim.errors import BlocksimError as BlocksimError
from blocksim.errors import InputError as InputError
from blocksim.errors import MissingPart as MissingPart
from blocksim.joints import JointState as JointState
from blocksim.modes import Mode as Mode
from blocksim.recording import Recording as Recording
from blocksim.recording import load_recording as load_recording
from blocksim.trial import simulate as simulate
from blocksim.verdict import Verdict as Verdict
from blocksim.version import __version__ as __version__
