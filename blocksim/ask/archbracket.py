"""How thin can it be? Bisection between a thickness that falls and one that stands."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from blocksim.arch import limit, theory
from blocksim.arch.circular import Arch, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.observed import observed_mode
from blocksim.arch.reduction import Reduction
from blocksim.ask.bracket import by_engine
from blocksim.ask.methods import choose, chosen_words, reduces
from blocksim.ask.search import ETA_MAX, THINNEST
from blocksim.common.checks import FRICTION, is_number, require
from blocksim.common.progress import Progress, silent
from blocksim.common.shown import Shown
from blocksim.evidence.observation import Held, hold, reduced_words
from blocksim.evidence.simulation import BY_RULE, Overrides, given_words
from blocksim.kinds.circular import arch_problem

ANY_THICKNESS = "two joints on each half, and a line of thrust through the middle of both"


@dataclass(frozen=True, kw_only=True)
class Bracket(Shown):
    """Least thickness between two ratios that were both tried.

    Parameters
    ----------
    method : str
    half_angle, mu : float
    voussoirs : int
    weight : str
    lean : float
        Angle by which gravity leans out of the plane [rad]; `eta_limit` and `eta_theory`
        are those without it.
    depth : float
        Depth out of the plane [r].
    tol : float
        Relative width asked for.
    eta_low : float or None
        Largest ratio that collapsed; None where none did.
    eta_high : float or None
        Smallest ratio that stood, 0 where any stands; None where none up to 2 did.
    eta_limit, eta_theory : float or None
        Exact values for the voussoirs as built and the continuous arch; `eta_limit` is 0
        where any thickness stands (some arches of three voussoirs).
    mode, mode_limit : Mode or None
        `mode` is that of the mechanism the arch starts with at `eta_low`. `mode_limit` is that
        of limit analysis at the least thickness.
    modes_theory : tuple of Mode
        Of the continuous arch at its least thickness: all that coincide.
    mode_in_motion : Mode or None
        As seen in the moving run at `eta_low`, see `Observation`; None where there was none.
    thrust, beta_r, beta_s : float or None
        Scaled thrust; angles of the inner hinge and inner sliding joint [rad]. For
        static methods.
    confirmed : bool or None
        Whether moving runs at both ends agree; None where there were none.
    runs, undecided : int
        Arches tried, and those without an answer.
    blocks, splits : int or None
        The most blocks with which an arch was simulated, and the number of joints that `reduce`
        had merged and had to split again. None for static methods.
    reason : str
        What the answer rests on.
    wall_s : float
    """

    method: str
    half_angle: float
    mu: float
    voussoirs: int
    weight: Weight
    tol: float
    eta_low: float | None
    eta_high: float | None
    eta_limit: float | None
    eta_theory: float | None
    mode: Mode | None
    mode_limit: Mode | None
    modes_theory: tuple[Mode, ...]
    mode_in_motion: Mode | None = None
    thrust: float | None = None
    beta_r: float | None = None
    beta_s: float | None = None
    confirmed: bool | None = None
    runs: int = 0
    undecided: int = 0
    blocks: int | None = None
    splits: int | None = None
    reason: str = ""
    wall_s: float = 0.0
    lean: float = 0.0
    depth: float = 1.0

    @property
    def mode_theory(self) -> Mode:
        """The first of `modes_theory`."""
        return self.modes_theory[0]

    def __repr__(self) -> str:
        return (
            f"Bracket(eta {_ends(self.eta_low, self.eta_high)}, by {self.method}, "
            f"half_angle={self.half_angle:g}, mu={self.mu:g}, voussoirs={self.voussoirs})"
        )

    @property
    def centre(self) -> float | None:
        """Middle of the bracket; None where no thickness stands or none falls."""
        if self.eta_low is None or self.eta_high is None:
            return None
        return (self.eta_low + self.eta_high) / 2


def bracket(
    *,
    half_angle: float,
    mu: float,
    voussoirs: int,
    weight: Weight = "centreline",
    method: str = "auto",
    tol: float = 0.005,
    lean: float = 0.0,
    depth: float = 1.0,
    confirm: bool = True,
    settings: Overrides = BY_RULE,
    reduce: bool | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Find the least thickness-to-radius ratio that stands.

    Engines search with the onset test and let the arch go at both ends. The search begins at
    the value of limit analysis, and takes nothing else from it.

    Parameters
    ----------
    half_angle : float
        alpha, in (0, pi) [rad].
    mu : float
        Friction coefficient, above 0, inf allowed.
    voussoirs : int
    weight : {"centreline", "sector"}
    method : str
        `auto`, `theory`, `limit`, or the name of an engine.
    tol : float
        Relative width at which to end, above 0 and at most 0.5.
    lean : float
        Angle by which gravity leans out of the plane [rad].
    depth : float
        Depth out of the plane [r]; it matters only where gravity leans.
    confirm : bool
        Let the arch go at both ends; without, an engine answers by the onset test alone.
    settings : mapping of str to float
        Settings that replace those of the engine's rule;
        `blocksim.evidence.simulation.SETTINGS` has their names.
    reduce : bool, optional
        Simulate half of the arch, and voussoirs that stay together as one block
        (`blocksim.arch.reduction`). By default the engine decides (`Engine.reduces`); not where
        gravity leans out of the plane.
    progress : Progress, optional

    Returns
    -------
    Bracket

    Raises
    ------
    InputError
        If a value is out of range.
    MissingPart
        If the engine's library is not installed.
    """
    started = time.perf_counter()
    FRICTION.require("mu", mu)
    require(is_number(tol, 0, 0.5), "tol", tol, "above 0 and at most 0.5")
    arch = Arch(half_angle=half_angle, eta=1.0, voussoirs=voussoirs, weight=weight, depth=depth)
    leaning = arch_problem(arch, mu, lean) if lean else None
    rung = choose(method, tol, problem=leaning, settings=settings, reduce=reduce)
    built = limit.least_thickness(half_angle, mu, voussoirs, weight)
    continuous = theory.least_thickness(half_angle, mu, weight)
    answer = Bracket(
        method=rung.name,
        half_angle=half_angle,
        mu=mu,
        voussoirs=voussoirs,
        weight=weight,
        lean=lean,
        depth=depth,
        tol=tol,
        eta_low=None,
        eta_high=None,
        eta_limit=built.eta,
        eta_theory=continuous.eta,
        mode=None,
        mode_limit=built.mode,
        modes_theory=continuous.modes,
    )
    if rung.name == "theory":
        answer = replace(
            answer,
            eta_low=ETA_MAX if continuous.eta is None else continuous.eta,
            eta_high=continuous.eta,
            mode=continuous.mode,
            thrust=continuous.thrust,
            beta_r=continuous.beta_r,
            beta_s=continuous.beta_s,
            reason="closed form of the continuous arch",
        )
    elif rung.name == "limit":
        answer = replace(
            answer,
            # Where any thickness stands none collapses.
            eta_low=ETA_MAX if built.eta is None else built.eta or None,
            eta_high=built.eta,
            mode=built.mode,
            thrust=built.thrust,
            beta_r=_inner(built.hinges_intrados),
            beta_s=_inner(tuple(x for x in built.slides if x < half_angle)),
            reason="static limit analysis of the voussoirs as built"
            + (f": {ANY_THICKNESS}" if built.eta == 0 else ""),
        )
    else:
        reduced = reduces(rung, reduce, is_planar=not lean)
        guess = built.eta or continuous.eta or ETA_MAX
        search = by_engine(
            _Thinning(arch, mu, lean, rung.name, settings, reduce=reduced).held_at,
            guess,
            (THINNEST, ETA_MAX),
            tol,
            name="eta",
            more_is_safer=True,
            confirm=confirm,
            progress=progress,
        )
        seen = search.collapse
        answer = replace(
            answer,
            eta_low=search.falls,
            eta_high=search.stands,
            mode=observed_mode(seen.joints, arch) if seen else None,
            mode_in_motion=observed_mode(seen.joints_in_motion, arch) if seen else None,
            confirmed=search.confirmed,
            runs=search.runs,
            undecided=search.undecided,
            blocks=search.blocks,
            splits=search.splits,
            reason=search.reason,
        )
        if reduced and search.blocks is not None and search.splits is not None:
            words = reduced_words(Reduction.by, search.blocks, voussoirs, search.splits)
            answer = replace(answer, reason=f"{answer.reason}; {words}")
    reason = answer.reason + given_words(settings) + chosen_words(method, rung)
    return replace(answer, reason=reason, wall_s=time.perf_counter() - started)


def _ends(low: float | None, high: float | None) -> str:
    said = ["none" if each is None else f"{each:.9g}" for each in (low, high)]
    return " to ".join(dict.fromkeys(said))


def _inner(angles: tuple[float, ...]) -> float | None:
    return angles[0] if angles else None


class _Thinning:
    """One arch at one thickness after the other, reduced alike where that is asked for."""

    def __init__(
        self,
        arch: Arch,
        mu: float,
        lean: float,
        engine: str,
        settings: Overrides,
        *,
        reduce: bool,
    ) -> None:
        self._arch, self._mu, self._lean = arch, mu, lean
        self._engine, self._settings = engine, settings
        self._reduce = reduce
        self._reduction: Reduction | None = None

    def held_at(self, eta: float) -> Held:
        built = replace(self._arch, eta=eta)
        if self._reduction:
            # What moves at one thickness is the best guess for the next.
            reduction = self._reduction.at(built)
        else:
            reduction = Reduction.of(built, self._mu) if self._reduce else None
        held = hold(
            arch_problem(built, self._mu, self._lean),
            self._engine,
            settings=self._settings,
            reduction=reduction,
        )
        # An engine may have split it, or given it up.
        kept = held.simulation.reduction
        self._reduction = kept if isinstance(kept, Reduction) else None
        return held
