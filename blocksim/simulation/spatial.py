"""A problem in space in an engine, and the recording of its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blocksim.blocks.assembly import Array
from blocksim.blocks.space.parting import displacement_in_space
from blocksim.blocks.space.problem import SpatialProblem
from blocksim.common.files import AnyPath
from blocksim.common.shown import renderer
from blocksim.engines.base import Engine, Quality, World
from blocksim.simulation.looking import InSpace
from blocksim.simulation.recorded import Recorded, Simulated
from blocksim.simulation.simulated import Overrides, settings_by


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SpatialRecording(Recorded[SpatialProblem]):
    """The motion of blocks in space in one engine.

    Parameters
    ----------
    problem : SpatialProblem
    engine, engine_version : str
    settings : Settings
    times : (frames,) float
        In units of sqrt(size/g), from the release.
    poses : (frames, blocks, 6) float
        Centres of mass x, y, z in units of the size, and rotation vectors since the release.
    quality : Quality
    """

    def film(self, path: AnyPath, *, slow: float | None = None, height: int = 720) -> None:
        """Write it as a film in perspective.

        Parameters
        ----------
        path : Path
            Ending in .mp4 or .gif.
        slow : float, optional
            How many times slower than it happened.
        height : int
            In pixels; frames are 16:9.

        Raises
        ------
        InputError, MachineError
            If the film is too long or too large, or the file cannot be written.
        """
        renderer().film_of(self, path, slow=slow, height=height)

    @property
    def displacement(self) -> Array:
        """Largest displacement of any corner since the release [size], (frames,)."""
        return displacement_in_space(self.poses - self.poses[0], self.problem.assembly)


@dataclass(frozen=True, kw_only=True)
class SpatialSimulation(Simulated[SpatialProblem]):
    """A problem in space, an engine that moves blocks there, and its settings."""

    length = "L"

    @classmethod
    def of(
        cls, problem: SpatialProblem, engine: Engine, settings: Overrides
    ) -> SpatialSimulation:
        """Take the settings that the engine chooses for the blocks, or those given."""
        assert engine.rule_in_space is not None  # noqa: S101 - asked of engines in space only
        return cls(
            problem=problem,
            engine=engine,
            settings=settings_by(engine.rule_in_space(problem.assembly), settings),
            given=settings,
        )

    @property
    def look(self) -> InSpace:
        """The problem as it is looked at where blocks move."""
        return InSpace(self.problem)

    @property
    def built(self) -> Array:
        """Poses as built, (blocks, 6)."""
        assembly = self.problem.assembly
        return np.pad(assembly.centres / assembly.size, ((0, 0), (0, 3)))

    def world(self) -> World:
        """Blocks in the engine, at rest."""
        assert self.engine.build_in_space is not None  # noqa: S101 - as above
        return self.engine.build_in_space(self.problem, self.settings)

    def record(
        self, times: Sequence[float], poses: Sequence[Array], quality: Quality
    ) -> SpatialRecording:
        """Return frames as a recording."""
        return self.recorded(SpatialRecording, times, poses, quality)
