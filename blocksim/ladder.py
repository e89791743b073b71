"""The ladder of methods: which there are, what each sees, which one a question needs."""

from __future__ import annotations

from dataclasses import dataclass

from blocksim import engines
from blocksim.errors import InputError

STATIC = ("theory", "limit")


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
    """

    name: str
    sees: str
    finest: float

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
    )
}

CHOICES = ("auto", *METHODS)


def choose(method: str, tol: float = 0.0) -> Method:
    """Return the method asked for; for `auto` the cheapest that is exact, `limit`.

    Parameters
    ----------
    method : str
        One of `CHOICES`.
    tol : float
        Relative width of the bracket asked for, 0 where there is none.

    Raises
    ------
    InputError
        If there is no such method, or it cannot answer to that tolerance.
    """
    if method not in CHOICES:
        raise InputError("method", method, f"one of {', '.join(CHOICES)}")
    # `limit` sees the voussoirs as built and is exact, which `theory` is not for them.
    rung = METHODS["limit" if method == "auto" else method]
    if tol and tol < rung.finest:
        raise InputError("tol", tol, f"at least {rung.finest:g} for {rung.name}")
    return rung


def missing(method: Method) -> str | None:
    """Tell how to get what a method lacks here; None where it can run."""
    return None if method.is_static else engines.remedy(method.name)
