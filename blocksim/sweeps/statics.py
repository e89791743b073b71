"""Cases in bulk: what closed form and limit analysis tell of many arches at once."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import cast

import numpy as np

from blocksim.arch.circular import ETA_MAX, Weight
from blocksim.arch.limit.bulk import least_thickness_of_joints, which_stand
from blocksim.arch.limit.halfplanes import half_joints
from blocksim.arch.theory.arrays import least_thicknesses
from blocksim.ask.methods import STATIC
from blocksim.blocks.assembly import Array
from blocksim.simulation.verdict import Verdict
from blocksim.sweeps.case import Case, Row


def by_statics(cases: Sequence[Case], rows: list[Row]) -> list[int]:
    """Fill in what closed form and limit analysis tell. Return which are left to simulate."""
    groups: defaultdict[tuple[int, Weight], list[int]] = defaultdict(list)
    for k, row in enumerate(rows):
        groups[cast("int", row["voussoirs"]), cast("Weight", row["weight"])].append(k)
        if row["method"] == "auto":
            row["method"] = "limit"
    left: list[int] = []
    for (voussoirs, weight), group in groups.items():
        alpha = np.radians(_numbers(rows, group, "half_angle_deg"))
        mu = _numbers(rows, group, "mu")
        continuous = least_thicknesses(alpha, mu, weight)
        names, least = continuous.mode.tolist(), _or_none(continuous.eta)
        for k, mode, eta in zip(group, names, least, strict=True):
            rows[k].update(mode_theory=mode, eta_theory=eta)
        _least_as_built(cases, rows, group, alpha, mu, voussoirs, weight)
        judged = [i for i, k in enumerate(group) if "eta" in rows[k]]
        if judged:
            chosen = [group[i] for i in judged]
            arches = alpha[judged], mu[judged], voussoirs, weight
            left += _verdicts(cases, rows, chosen, arches)
        for k in group:
            if cases[k].over and not _bracketed(cases[k], rows[k]):
                left.append(k)
    return left


def _least_as_built(
    cases: Sequence[Case],
    rows: list[Row],
    group: Sequence[int],
    alpha: Array,
    mu: Array,
    voussoirs: int,
    weight: Weight,
) -> None:
    """Find the least thickness of the voussoirs where the question needs it."""
    needed = [
        i
        for i, k in enumerate(group)
        if (cases[k].over and cases[k].method != "theory") or "ratio" in rows[k]
    ]
    if not needed:
        return
    found = least_thickness_of_joints(half_joints(alpha[needed], voussoirs), mu[needed], weight)
    for i, least in zip(needed, _or_none(found), strict=True):
        row = rows[group[i]]
        ratio = cast("float | None", row.get("ratio"))
        row["eta_limit"] = least
        if ratio is None:
            continue
        if least is None:
            row["error"] = "no thickness up to eta = 2 stands, of which a ratio could be taken"
        elif least == 0:
            row["error"] = "any thickness stands: there is none of which to take a ratio"
        elif ratio * least > ETA_MAX:
            row["error"] = f"eta = {ratio * least:.6g}: must be above 0 and at most 2"
        else:
            row["eta"] = ratio * least


Arches = tuple[Array, Array, int, Weight]


def _verdicts(
    cases: Sequence[Case], rows: list[Row], group: Sequence[int], arches: Arches
) -> list[int]:
    """Judge arches by statics, and return those to be simulated instead."""
    alpha, mu, voussoirs, weight = arches
    eta = _numbers(rows, group, "eta")
    band = np.array([cases[k].band for k in group])
    least = _numbers(rows, group, "eta_theory")
    by_theory = np.array([cases[k].method == "theory" for k in group])
    stands = eta >= least  # False where none stands
    built = np.flatnonzero(~by_theory & np.isfinite(band))
    near = np.isinf(band)
    if built.size:
        a, m, e, b = alpha[built], mu[built], eta[built], band[built]
        stands[built] = which_stand(a, e, m, voussoirs, weight)
        within = np.flatnonzero(b)
        if within.size:
            # Within the band if a little thinner falls, or a little thicker stands.
            a, m, e, b = a[within], m[within], e[within], b[within]
            thinner = which_stand(a, e / (1 + b), m, voussoirs, weight)
            thicker = which_stand(a, np.minimum(e * (1 + b), ETA_MAX), m, voussoirs, weight)
            near[built[within]] = thinner != thicker
    for k, stood, theory in zip(group, stands.tolist(), by_theory.tolist(), strict=True):
        row = rows[k]
        row["verdict"] = (Verdict.STANDS if stood else Verdict.COLLAPSES).value
        row["method"] = "theory" if theory else "limit"
        if theory and not stood:
            row["mode"] = row["mode_theory"]
    return [k for k, simulate in zip(group, near.tolist(), strict=True) if simulate]


def _bracketed(case: Case, row: Row) -> bool:
    """Fill in a static bracket: both ends are the least thickness, or none stands."""
    if case.method not in {*STATIC, "auto"}:
        return False
    least = row["eta_theory" if case.method == "theory" else "eta_limit"]
    low = ETA_MAX if least is None else least or None
    row.update(eta_low=low, eta_high=least)
    # The radius is 1 m.
    row.update(unit="m", low=low, high=least, limit=row.get("eta_limit"))
    if case.method == "theory":
        row["mode"] = row["mode_theory"]
    return True


def _numbers(rows: Sequence[Row], group: Iterable[int], name: str) -> Array:
    """Return a column as numbers. Infinity is a text in it, and what is missing is nan."""
    return np.array([rows[k][name] for k in group], dtype=float)


def _or_none(values: Array) -> Iterable[float | None]:
    return [None if math.isnan(value) else value for value in values.tolist()]
