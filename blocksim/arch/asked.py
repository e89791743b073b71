"""An arch to ask about, from a file or from options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from blocksim.arch.circular import Arch, Weight

if TYPE_CHECKING:
    from blocksim.arch.dimensions import Line
    from blocksim.arch.modes import Mode
    from blocksim.simulation.verdict import Verdict


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """An arch to ask about, and what is known of it.

    Parameters
    ----------
    name : str
        File name without its ending.
    title, source : str
    half_angle : float
        alpha [rad].
    mu : float
    voussoirs : int
    weight : str
    eta : float or None
        Thickness-to-radius ratio, where the scenario sets one.
    line : Line or None
        The line that was measured, where one was.
    radius, depth, specific_weight : float
    lean : float
        Angle by which gravity leans out of the plane [rad].
    expected_modes : tuple of Mode
        Empty where nothing is said.
    expected_eta : float or None
    expected_verdict : Verdict or None
        Of the arch at its `eta`.
    quick : bool
        Whether `validate --quick` takes it.
    """

    name: str
    title: str
    source: str
    half_angle: float
    mu: float
    voussoirs: int
    weight: Weight
    eta: float | None
    line: Line | None
    radius: float
    depth: float
    specific_weight: float
    lean: float
    expected_modes: tuple[Mode, ...]
    expected_eta: float | None
    expected_verdict: Verdict | None
    quick: bool

    def arch(self, eta: float) -> Arch:
        """Return the arch at a thickness-to-radius ratio."""
        return Arch(
            half_angle=self.half_angle,
            eta=eta,
            voussoirs=self.voussoirs,
            weight=self.weight,
            radius=self.mean_radius(eta),
            depth=self.depth,
            specific_weight=self.specific_weight,
        )

    def mean_radius(self, eta: float) -> float:
        """Return the radius of the centreline at a thickness-to-radius ratio [m].

        The centreline stays as it is, wherever it is known. A line that was measured without
        a thickness says where that line is, and the centreline follows.
        """
        if self.line is None or self.eta is not None:
            return self.radius
        return self.line.mean_radius(eta)
