"""Options that the questions share, each said once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypedDict

from blocksim.blocks.assembly import Blocks
from blocksim.blocks.maker import Kind
from blocksim.blocks.problem import Problem
from blocksim.common.checks import WIDTH, require
from blocksim.common.progress import Progress, silent
from blocksim.engines.base import Method
from blocksim.simulation.simulated import BY_RULE, Overrides

Named = Literal["auto", "theory", "limit", "direct", "pymunk", "pybullet", "mujoco"]
"""Methods that come with blocksim; a text may name one of another package as well."""
Asked = Problem[Blocks] | Kind[Blocks]
"""What is asked about: a problem, or what makes one."""


class Options(TypedDict, total=False):
    """How a question is asked.

    Parameters
    ----------
    method : str or Engine
        `auto`, which takes the cheapest that can answer; `theory`, `limit`, or an engine, by
        its name or as an object.
    settings : mapping of str to float
        Settings that replace those of the engine's rule;
        `blocksim.simulation.simulated.SETTINGS` has their names.
    reduce : bool
        Simulate no more blocks than it takes: blocks that do not part as one
        (`blocksim.simulation.merging`), half of a symmetric arch (`blocksim.arch.reduction`).
        By default the engine decides, and only where gravity lies in the plane and the
        ground is at rest.
    progress : Progress
        What is told how far it is.
    tol : float
        Of a bracket, the relative width at which to end, above 0 and at most 0.5; by default
        0.005.
    confirm : bool
        Of a bracket, let the blocks go at both ends, as by default; without, an engine answers
        by the onset test alone.
    """

    method: Named | str | Method
    settings: Overrides
    reduce: bool | None
    progress: Progress
    tol: float
    confirm: bool


@dataclass(frozen=True, kw_only=True)
class Taken:
    """Options as given, or as usual."""

    method: Named | str | Method = "auto"
    settings: Overrides = field(default_factory=lambda: BY_RULE)
    reduce: bool | None = None
    progress: Progress = silent
    tol: float = 0.005
    confirm: bool = True

    def __post_init__(self) -> None:
        """Check the width of a bracket."""
        WIDTH.require("tol", self.tol)


def taken(options: Options, *without: str) -> Taken:
    """Return options, none of which is one that makes no sense here."""
    for name in without:
        require(name not in options, name, options.get(name), "left out here")
    return Taken(**options)


def problem_of(asked: Asked[Blocks]) -> Problem[Blocks]:
    """Return the problem that is asked about."""
    return asked.problem() if isinstance(asked, Kind) else asked
