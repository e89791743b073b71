"""Rows of a `validate` run, read from its validate.json."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from blocksim.arch.circular import WEIGHTS
from blocksim.arch.modes import Mode
from blocksim.common.checks import VOUSSOIRS, is_number
from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, json_of, read_file
from blocksim.common.words import printable

LARGEST_FILE = 20_000_000
"""Bytes: some 20,000 rows."""
WRITTEN = "validate.json as `blocksim validate` writes it"


@dataclass(frozen=True, kw_only=True)
class Result:
    """A simulated arch on the map, as the page takes it.

    Parameters
    ----------
    scenario, engine : str
    weight : str
    alpha : float
        Half-angle [deg].
    mu : float or None
        None where friction is unbounded.
    voussoirs : int
    eta : float
        Centre of the bracket; 2 where nothing stands.
    nothing_stands : bool
        No thickness up to 2 does.
    mode : str or None
        As observed.
    miss : str
        What disagrees with limit analysis.
    found : str
        What the engine found, in a few words.
    """

    scenario: str
    engine: str
    weight: str
    alpha: float
    mu: float | None
    voussoirs: int
    eta: float
    nothing_stands: bool
    mode: str | None
    miss: str
    found: str


def read_results(path: AnyPath) -> list[Result]:
    """Read the results of a `validate` run.

    Parameters
    ----------
    path : Path
        A validate.json.

    Returns
    -------
    list of Result
        Of the rows that have a bracket.

    Raises
    ------
    InputError
        If the file is missing, too large, or no such results.
    """
    text = read_file(path, "--results", f"an existing {WRITTEN}", LARGEST_FILE)
    try:
        rows = json_of(text)["rows"]
        found = [_result(row) for row in rows]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError("--results", str(path), WRITTEN) from None
    return [result for result in found if result is not None]


def _result(row: dict[str, Any]) -> Result | None:
    """Check one row; None where it has no bracket."""
    low, high = row["eta_low"], row["eta_high"]
    if low is None:
        return None
    # Where nothing stands, the bracket ends at the thickest arch there is.
    eta = low if high is None else (low + high) / 2
    mu, alpha = float(row["mu"]), row["half_angle_deg"]
    mode = None if row["mode_observed"] is None else Mode(row["mode_observed"]).value
    sound = (
        is_number(eta, 0, 2)
        and is_number(alpha, 0, math.nextafter(180, 0))
        and is_number(mu, 0, math.inf)
        and VOUSSOIRS.has(row["voussoirs"])
        and row["weight"] in WEIGHTS
    )
    if not sound:
        raise ValueError
    name = "a mode without a name" if mode is None else f"mode {mode}"
    least = "no thickness stands" if high is None else f"least η from {low:.6g} to {high:.6g}"
    return Result(
        scenario=printable(str(row["scenario"])),
        engine=printable(str(row["engine"])),
        weight=row["weight"],
        alpha=alpha,
        mu=None if math.isinf(mu) else mu,
        voussoirs=row["voussoirs"],
        eta=eta,
        nothing_stands=high is None,
        mode=mode,
        miss=printable(str(row["miss"])),
        found=f"{least}, {name}",
    )
