"""What is told of a symmetric circular arch beside what is told of any blocks."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim.arch.circular import Arch
from blocksim.arch.modes import Mode


@dataclass(frozen=True, kw_only=True)
class ArchAnswer:
    """Ratios and modes of an arch.

    `shape`: The arch asked about.
    `eta_limit`, `eta_theory`: Least thickness over radius, of the voussoirs as built and of the
        continuous arch. It is 0 where any thickness stands (some arches of three voussoirs),
        and None where no thickness up to 2 stands.
    `mode`: How this arch starts to collapse. An engine takes it from the mechanism of the onset
        test, `limit` from eqs (15) and (16). `theory` knows the mode at the least thickness
        only, and gives that. None where the arch stands, or where its joints form none of the
        modes.
    `mode_in_motion`: As seen in the moving run after a displacement of `motion.EARLY`; see
        `Observation`.
    `mode_limit`: Mode of the voussoirs as built at their least thickness, where `mode` may be
        another. Where no thickness up to 2 stands, it is the mode at 2.
    `modes_theory`: Modes of the continuous arch at its least thickness: several on a line of
        the map, where they coincide.
    """

    shape: Arch
    eta_limit: float | None
    eta_theory: float | None
    mode: Mode | None = None
    mode_in_motion: Mode | None = None
    mode_limit: Mode | None
    modes_theory: tuple[Mode, ...]

    @property
    def mode_theory(self) -> Mode:
        """The first of `modes_theory`."""
        return self.modes_theory[0]


@dataclass(frozen=True, kw_only=True)
class ArchBracket(ArchAnswer):
    """The same of the least thickness, between two ratios that were both tried.

    `eta_low`: Largest ratio that collapsed; None where none did.
    `eta_high`: Smallest ratio that stood, 0 where any stands; None where none up to 2 did.
    `thrust`, `beta_r`, `beta_s`: Scaled thrust; angles of the inner hinge and inner sliding
        joint [rad]. For static methods.
    """

    eta_low: float | None = None
    eta_high: float | None = None
    thrust: float | None = None
    beta_r: float | None = None
    beta_s: float | None = None

    @property
    def centre(self) -> float | None:
        """Middle of the bracket; None where no thickness stands or none falls."""
        if self.eta_low is None or self.eta_high is None:
            return None
        return (self.eta_low + self.eta_high) / 2
