"""What is known by a name: a file, a drawing, what is shipped, a kind."""

from __future__ import annotations

import os
from pathlib import Path

from blocksim.blocks.problem import Problem
from blocksim.common.files import AnyPath, read_file, toml_of
from blocksim.kinds import KINDS
from blocksim.kinds.files import LARGEST_FILES, load_structure
from blocksim.kinds.scenarios import load_scenario, shipped


def load(name: AnyPath, *, friction: float | None = None) -> Problem:
    """Return what is known by a name.

    Parameters
    ----------
    name : str or path
        A structure file, a drawing, an assembly of compas, a scenario of an arch, the name of
        one that is shipped, or that of a kind.
    friction : float, optional
        Friction coefficient where the name says none, as of drawings and kinds; inf allowed.

    Raises
    ------
    InputError
        In one line: what is wrong with the file, or that friction is missing.

    Examples
    --------
    >>> load("oppenheim_7").assembly.joints[0].before
    -1
    >>> load("wall", friction=0.7).maker.courses
    6
    """
    said = os.fspath(name)
    if said in KINDS:
        return KINDS[said](friction=friction).problem()
    if said in shipped() or _is_scenario(said):
        return load_scenario(said).problem()
    return load_structure(name, friction=friction)


def _is_scenario(path: str) -> bool:
    """Tell a scenario of an arch from a structure file, by what is in it."""
    if not path.endswith(".toml") or not Path(path).is_file():
        return False
    try:
        table = toml_of(read_file(path, "structure", "a file", LARGEST_FILES[".toml"]))
    except ValueError:
        return False
    return "arch" in table and "kind" not in table and "blocks" not in table
