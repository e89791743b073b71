"""Must it rest? What friction allows where forces of equilibrium exist."""

from __future__ import annotations

from typing import Literal

import numpy as np

from blocksim.blocks.problem import Problem
from blocksim.common.checks import require
from blocksim.common.progress import Progress, silent

Rest = Literal["must", "can", "cannot"]
WORDS = {
    "must": "it must rest: friction lets no motion begin",
    "can": "it can rest, and friction may let it move as well",
}
NOT_FOUND = "it can rest; whether it must was not found out in the time allowed"


def rest_words(rest: Rest | None, *, asked: bool) -> str | None:
    """Return what is said of blocks that can rest; None where nothing is to be said."""
    return (NOT_FOUND if asked else None) if rest is None else WORDS.get(rest)


def require_rest(problem: Problem) -> None:
    """Raise `InputError` where it cannot be found out whether blocks must rest."""
    allowed = "left out where gravity leans or the ground shakes"
    require(problem.is_planar and problem.shaking is None, "must_rest", "asked", allowed)
    bounded = bool(np.isfinite(problem.friction).all())
    require(bounded, "must_rest", "asked", "left out where friction is unbounded")


def rest_of(
    problem: Problem | None,
    *,
    exists: bool | None,
    moved: bool,
    progress: Progress = silent,
) -> Rest | None:
    """Tell what friction allows blocks at rest.

    Parameters
    ----------
    problem : Problem or None
        Where it is to be found out whether blocks must rest.
    exists : bool or None
        Whether there are forces of equilibrium; None where that was not found out.
    moved : bool
        Whether a motion was seen.
    progress : Progress, optional

    Returns
    -------
    {"must", "can", "cannot"} or None
        None where it was not found out whether it must rest.

    """
    if not exists:
        return None if exists is None else "cannot"
    if moved or problem is None:
        return "can" if moved else None
    # Imported here: few ask, and it takes longer to load than an answer.
    from blocksim.limit.starting import may_start

    progress(1.0, "motions that friction lets begin")
    moves = may_start(problem).moves
    return None if moves is None else "can" if moves else "must"
