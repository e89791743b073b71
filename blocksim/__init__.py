"""Rigid-block masonry arches: does it stand, how thin can it be, how does it fall."""

from __future__ import annotations

import importlib as _importlib

from blocksim.common import interrupts
from blocksim.common.version import __version__

if interrupts.is_program():
    # Before the imports that commands make.
    interrupts.install()

TYPE_CHECKING = False
if TYPE_CHECKING:
    from blocksim.arch.circular import Arch
    from blocksim.arch.modes import Mode
    from blocksim.ask.archbracket import Bracket, bracket
    from blocksim.ask.archcheck import ArchCheck, check
    from blocksim.ask.archmotion import simulate
    from blocksim.blocks.assembly import Assembly, Block, Joint
    from blocksim.blocks.joints import JointState
    from blocksim.blocks.problem import Load, Problem
    from blocksim.common.errors import (
        BlocksimError,
        InputError,
        MachineError,
        MissingPart,
    )
    from blocksim.evidence.recording import Recording
    from blocksim.evidence.verdict import Verdict
    from blocksim.kinds.files import load_structure, structure_of
    from blocksim.kinds.recorded import load_recording
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
    "MachineError",
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

_PLACES = {
    "ask.archbracket": ("Bracket", "bracket"),
    "ask.archcheck": ("ArchCheck", "check"),
    "arch.circular": ("Arch",),
    "arch.modes": ("Mode",),
    "ask.archmotion": ("simulate",),
    "blocks.assembly": ("Assembly", "Block", "Joint"),
    "blocks.joints": ("JointState",),
    "blocks.problem": ("Load", "Problem"),
    "common.errors": ("BlocksimError", "InputError", "MachineError", "MissingPart"),
    "evidence.recording": ("Recording",),
    "evidence.verdict": ("Verdict",),
    "kinds.files": ("load_structure", "structure_of"),
    "kinds.recorded": ("load_recording",),
    "limit": ("collapse", "equilibrium"),
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
