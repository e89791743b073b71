"""How thin can it be? Bisection between a thickness that falls and one that stands."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from blocksim.arch import limit, theory
from blocksim.arch.circular import Arch, Weight
from blocksim.arch.modes import Mode
from blocksim.arch.observed import observed_mode
from blocksim.arch.reduction import Reduction
from blocksim.ask.methods import choose, chosen_words
from blocksim.ask.search import ETA_MAX, Answer, Search
from blocksim.common.checks import is_number, require, require_friction
from blocksim.common.progress import Progress, silent
from blocksim.evidence.setup import BY_RULE, Overrides, given_words
from blocksim.evidence.trial import Held, conclude, hold, reduced_words
from blocksim.evidence.verdict import Verdict

ANY_THICKNESS = "two joints on each half, and a line of thrust through the middle of both"


@dataclass(frozen=True, kw_only=True)
class Bracket:
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
    mode, mode_limit, mode_theory : Mode or None
        Of the mechanism it starts with at `eta_low`; exact, at the least thickness.
    mode_in_motion : Mode or None
        As seen in the moving run at `eta_low`, see `Trial`; None where there was none.
    thrust, beta_r, beta_s : float or None
        Scaled thrust; angles of the inner hinge and inner sliding joint [rad]. For
        static methods.
    confirmed : bool or None
        Whether moving runs at both ends agree; None where there were none.
    runs, undecided : int
        Arches tried, and those without an answer.
    blocks, splits : int or None
        Most blocks simulated of any arch, and how many joints in all `reduce` merged and
        had to split again; None for static methods.
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
    mode_theory: Mode
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
    reduce: bool = False,
    progress: Progress = silent,
) -> Bracket:
    """Find the least thickness-to-radius ratio that stands.

    Engines bisect with the onset test and let the arch go at both ends. The search
    starts at the closed form's value, and only starts there.

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
        Depth out of the plane [r], which decides only where gravity leans.
    confirm : bool
        Let the arch go at both ends; without, an engine answers by the onset test alone.
    settings : mapping of str to float
        Of `blocksim.evidence.setup.SETTINGS`, instead of what the engine's rule says.
    reduce : bool
        Simulate no more blocks than it takes (`blocksim.arch.reduction`).
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
    require_friction(mu)
    require(is_number(tol, 0, 0.5), "tol", tol, "above 0 and at most 0.5")
    arch = Arch(half_angle=half_angle, eta=1.0, voussoirs=voussoirs, weight=weight, depth=depth)
    leaning = arch.problem(mu, lean) if lean else None
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
        mode_theory=continuous.mode,
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
        held = partial(hold, engine=rung.name, settings=settings)
        answer = _by_simulation(
            arch, answer, continuous.eta, held, progress, confirm=confirm, reduce=reduce
        )
    reason = answer.reason + given_words(settings) + chosen_words(method, rung)
    return replace(answer, reason=reason, wall_s=time.perf_counter() - started)


def _inner(angles: tuple[float, ...]) -> float | None:
    return angles[0] if angles else None


def _by_simulation(
    arch: Arch,
    answer: Bracket,
    guess: float | None,
    held_at: Callable[..., Held],
    progress: Progress,
    *,
    confirm: bool,
    reduce: bool,
) -> Bracket:
    """Bisect with the onset test, then, if asked for, let the arch go at both ends."""
    ends: dict[Verdict, Held] = {}
    eta_of: dict[Verdict, float] = {}
    reduction: Reduction | None = None
    blocks = splits = both = 0

    def judge(eta: float) -> Answer:
        nonlocal reduction, blocks, splits, both
        built = replace(arch, eta=eta)
        if reduction:
            # What moves at one thickness is the best guess for the next.
            reduction = reduction.at(built)
        elif reduce:
            reduction = Reduction.of(built, answer.mu)
        held = held_at(built.problem(answer.mu, answer.lean), reduction=reduction)
        # An engine may have split it, or given it up.
        kept = held.setup.reduction
        reduction = kept if isinstance(kept, Reduction) else None
        blocks, splits = max(blocks, held.setup.blocks), splits + held.splits
        both += held.onset.may_rest
        # Every answer narrows the bracket: the last of each kind is that of its end.
        ends[held.onset.verdict] = held
        eta_of[held.onset.verdict] = eta
        return Answer(held.onset.verdict, held.onset.acceleration)

    search = Search(judge, progress)
    search.expand(ETA_MAX if guess is None else guess)
    search.bisect(answer.tol)
    verdicts: list[bool] = []
    mode = later = None
    for expected in (Verdict.COLLAPSES, Verdict.STANDS):
        # The lower end tells the mode, too.
        if expected in ends and (confirm or expected is Verdict.COLLAPSES):
            held = ends[expected]
            if confirm:
                progress(0.95, f"moving run at {eta_of[expected]:.6g}")
            ended = conclude(held, moving=confirm)
            verdicts.append(ended.verdict is expected)
            if ended.verdict is Verdict.COLLAPSES:
                mode = observed_mode(ended.joints, arch)
                later = observed_mode(ended.joints_in_motion, arch)
    confirmed = (bool(verdicts) and all(verdicts)) if confirm else None
    words = {True: "confirmed", False: "not confirmed", None: "not tried"}
    reason = f"onset test at {search.runs} ratios, ends {words[confirmed]} by moving runs"
    if both:
        reason += f"; friction allows both rest and motion at {both} of them"
    if reduction:
        reason += f"; {reduced_words(blocks, arch.voussoirs, splits)}"
    return replace(
        answer,
        eta_low=search.low,
        eta_high=search.high,
        mode=mode,
        mode_in_motion=later,
        confirmed=confirmed,
        runs=search.runs,
        undecided=search.undecided,
        blocks=blocks,
        splits=splits,
        reason=reason,
    )
