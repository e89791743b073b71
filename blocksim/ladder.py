"""The ladder of methods: which there are, what each sees, which one a question needs."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim import engines
from blocksim.errors import InputError
from blocksim.setup import BY_RULE, SETTINGS, Overrides, require_setting

STATIC = ("theory", "limit")
SPATIAL = "pybullet"
"""The method that sees out of the plane."""


@dataclass(frozen=True, kw_only=True)
class Method:
    """A rung of the ladder.

    Parameters
    ----------
    name : str
    sees : str
        What it can tell.
    finest : float
        Smallest relative width of a bracket it can answer for.
    is_spatial : bool
        Whether it sees motion out of the plane.
    reduces : bool
        Whether it tells what joints carry, which a reduced arch takes.
    settings : tuple of str
        Those of `SETTINGS` it is run with.
    """

    name: str
    sees: str
    finest: float
    is_spatial: bool = False
    reduces: bool = False
    settings: tuple[str, ...] = ()

    @property
    def is_static(self) -> bool:
        """Whether it answers without motion."""
        return self.name in STATIC


METHODS = {
    method.name: method
    for method in (
        Method(
            name="theory",
            sees="the continuous arch: least thickness, mode, thrust, hinge and sliding angles",
            finest=0.0,
        ),
        Method(
            name="limit",
            sees="the arch as built: the same, and the joints that turn or slide",
            finest=0.0,
        ),
        Method(
            name="direct",
            sees="motion in the plane: each step's contact and Coulomb friction solved exactly",
            finest=1e-8,
            reduces=True,
            settings=("step", "still", "rest"),
        ),
        Method(
            name="pymunk",
            sees="motion in the plane: onset and collapse with Coulomb friction",
            finest=1e-4,
            reduces=True,
            settings=tuple(SETTINGS),
        ),
        Method(
            name="pybullet",
            sees="motion in space: the same, and out of the plane",
            finest=1e-3,
            is_spatial=True,
            reduces=True,
            settings=tuple(SETTINGS),
        ),
        Method(
            name="mujoco",
            sees="motion in the plane: onset and collapse with soft contacts",
            finest=1e-3,
        ),
    )
}

CHOICES = ("auto", *METHODS)
REASONS = {
    "limit": "exact for the voussoirs as built, which meets any tolerance, in milliseconds",
    SPATIAL: "the only one that sees out of the plane",
}
"""Why `auto` takes a method. `theory` is no cheaper where the voussoirs as built count."""


def choose(
    method: str,
    tol: float = 0.0,
    *,
    spatial: bool = False,
    settings: Overrides = BY_RULE,
    reduce: bool = False,
) -> Method:
    """Return the method asked for; for `auto` the cheapest that is exact, `limit`.

    Parameters
    ----------
    method : str
        One of `CHOICES`.
    tol : float
        Relative width of the bracket asked for, 0 where there is none.
    spatial : bool
        Whether the question is of motion out of the plane: `auto` is then the method
        that sees it.
    settings : mapping of str to float
        Given instead of what the engine's rule says.
    reduce : bool
        Whether no more blocks are to be simulated than it takes.

    Raises
    ------
    InputError
        If there is no such method, or it cannot answer to that tolerance, or does not
        see out of the plane where that is asked, or knows no such setting; if there is
        nothing to reduce.
    """
    if method not in CHOICES:
        raise InputError("method", method, f"one of {', '.join(CHOICES)}")
    rung = METHODS[(SPATIAL if spatial else "limit") if method == "auto" else method]
    if spatial and not rung.is_spatial:
        raise InputError("method", method, f"{SPATIAL} with a tilt or a plane lock")
    if reduce and (spatial or not rung.reduces):
        able = ", ".join(each.name for each in METHODS.values() if each.reduces)
        raise InputError("reduce", reduce, f"left out but for {able}, in the plane")
    if tol and tol < rung.finest:
        raise InputError("tol", tol, f"at least {rung.finest:g} for {rung.name}")
    for name, value in settings.items():
        known = ", ".join(rung.settings)
        allowed = f"one of {known} for {rung.name}" if known else f"left out for {rung.name}"
        if name not in rung.settings:
            raise InputError("settings", name, allowed)
        require_setting(name, value)
    return rung


def chosen_words(method: str, rung: Method) -> str:
    """Say what `auto` took and why, to be added to the reason of an answer."""
    return f"; auto took {rung.name}: {REASONS[rung.name]}" if method == "auto" else ""


def missing(method: Method) -> str | None:
    """Tell how to get what a method lacks here; None where it can run."""
    return None if method.is_static else engines.remedy(method.name)
