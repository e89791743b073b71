"""The ladder of methods: which there are, what each sees, which one a question needs."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim import engines
from blocksim.errors import InputError

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
    """

    name: str
    sees: str
    finest: float
    is_spatial: bool = False

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
        ),
        Method(
            name="pymunk",
            sees="motion in the plane: onset and collapse with Coulomb friction",
            finest=1e-4,
        ),
        Method(
            name="pybullet",
            sees="motion in space: the same, and out of the plane",
            finest=1e-3,
            is_spatial=True,
        ),
        Method(
            name="mujoco",
            sees="motion in the plane: onset and collapse with soft contacts",
            finest=1e-3,
        ),
    )
}

CHOICES = ("auto", *METHODS)


def choose(method: str, tol: float = 0.0, *, spatial: bool = False) -> Method:
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

    Raises
    ------
    InputError
        If there is no such method, or it cannot answer to that tolerance, or does not
        see out of the plane where that is asked.
    """
    if method not in CHOICES:
        raise InputError("method", method, f"one of {', '.join(CHOICES)}")
    # `limit` sees the voussoirs as built and is exact, which `theory` is not for them.
    rung = METHODS[(SPATIAL if spatial else "limit") if method == "auto" else method]
    if spatial and not rung.is_spatial:
        raise InputError("method", method, f"{SPATIAL} with a tilt or a plane lock")
    if tol and tol < rung.finest:
        raise InputError("tol", tol, f"at least {rung.finest:g} for {rung.name}")
    return rung


def missing(method: Method) -> str | None:
    """Tell how to get what a method lacks here; None where it can run."""
    return None if method.is_static else engines.remedy(method.name)
