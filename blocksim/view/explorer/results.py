"""Rows of a `validate` run, read from its validate.json."""

from __future__ import annotations

import math
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


def read_results(path: AnyPath) -> list[dict[str, Any]]:
    """Read the rows of a validate.json on arches that have a bracket."""
    text = read_file(path, "--results", f"an existing {WRITTEN}", LARGEST_FILE)
    try:
        rows = json_of(text)["rows"]
        found = [_result(row) for row in rows if row["modes_published"]]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        raise InputError("--results", str(path), WRITTEN) from None
    return [result for result in found if result is not None]


def _result(row: dict[str, Any]) -> dict[str, Any] | None:
    """Check a row, and return what the page shows of it, or None without a bracket."""
    low, high = row["low"], row["high"]
    if low is None:
        return None
    # Where nothing stands, the bracket ends at the thickest arch there is.
    eta = low if high is None else (low + high) / 2
    mu, alpha = float(row["mu"]), row["half_angle_deg"]
    mode = None if row["mode"] is None else Mode(row["mode"]).value
    sound = (
        is_number(eta, 0, 2)
        and is_number(alpha, 0, math.nextafter(180, 0))
        and is_number(mu, 0, math.inf)
        and VOUSSOIRS.has(row["blocks"])
        and row["weight"] in WEIGHTS
    )
    if not sound:
        raise ValueError
    name = "a mode without a name" if mode is None else f"mode {mode}"
    least = "no thickness stands" if high is None else f"least η from {low:.6g} to {high:.6g}"
    return {
        "scenario": printable(str(row["structure"])),
        "engine": printable(str(row["method"])),
        "weight": row["weight"],
        "alpha": alpha,
        "mu": None if math.isinf(mu) else mu,
        "voussoirs": row["blocks"],
        "eta": eta,
        "nothing_stands": high is None,
        "mode": mode,
        "miss": printable(str(row["miss"])),
        "found": f"{least}, {name}",
    }
