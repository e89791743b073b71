"""Tables of what was known before blocksim computed it, and what blocksim says."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any, cast

from markdown_table import table

from blocksim.arch import theory
from blocksim.arch.circular import Arch
from blocksim.arch.limit import least_thickness
from blocksim.kinds.circular import CircularArch
from blocksim.studies.agreement import Row
from blocksim.studies.validate import structures, validate

ROOT = Path(__file__).resolve().parent.parent


def of_validation(which: str) -> str:
    """Return one of the tables of validation: of the paper, of arches, of structures."""
    return {
        "landmarks": _landmarks,
        "captions": _captions,
        "arches": _arches,
        "structures": _structures,
    }[which]()


def _printed() -> dict[str, Any]:
    file = ROOT / "tests" / "validation" / "cocchetti_rizzi_2024.toml"
    return tomllib.loads(file.read_text(encoding="utf-8"))


def _digits(value: float, count: int = 13) -> str:
    return f"{value:.{count}g}"


def _landmarks() -> str:
    """Table 1 of the paper, and the largest relative difference of theory from it."""
    symbols = {
        "eta": "eta",
        "mu": "mu",
        "half_angle": "alpha",
        "thrust": "h",
        "beta_r": "beta_r",
        "beta_s": "beta_s",
    }
    rows = list[list[str]]()
    for name, printed in _printed()["table1"].items():
        found = theory.landmarks()[name]
        apart = max(
            abs(getattr(found, own) - printed[symbol]) / (abs(printed[symbol]) or 1.0)
            for own, symbol in symbols.items()
        )
        values = [_digits(printed[symbol]) for symbol in symbols.values()]
        rows.append([f"{name}, {printed['name']}", *values, _apart(apart)])
    headings = ["point", *symbols.values(), "blocksim differs by"]
    return table(headings, rows)


def _apart(value: float) -> str:
    """Say a relative difference: round-off is all one, whatever the machine."""
    return "less than 1e-12" if value < 1e-12 else f"{value:.0e}"


def _captions() -> str:
    """Arches of the captions of Figs 13-25: printed eta, and that of theory."""
    rows = list[list[str]]()
    for each in _printed()["captions"]:
        alpha = each.get("alpha") or math.radians(each["alpha_deg"])
        found = theory.least_thickness(alpha, each["mu"])
        cells = [each["place"], f"{math.degrees(alpha):.6g}", f"{each['mu']:.6g}"]
        same = "" if found.eta is None else _apart(abs(found.eta / each["eta"] - 1))
        said = "any: the arch slides" if found.eta is None else _digits(found.eta, 10)
        rows.append([*cells, each["mode"], _digits(each["eta"], 10), said, same])
    headings = ["figure", "alpha", "mu", "mode", "eta printed", "theory", "differs by"]
    return table(headings, rows)


def _arches() -> str:
    """Least thickness of each shipped arch: known, by theory, and as built."""
    rows = list[list[str]]()
    for known in structures(quick=False):
        problem, expected = known.problem, known.expect[0]
        if not expected.modes:
            continue
        arch = cast("Arch", cast("CircularArch", problem.maker).shape)
        found = theory.least_thickness(arch.half_angle, problem.mu, arch.weight)
        built = least_thickness(arch.half_angle, problem.mu, arch.voussoirs, arch.weight).eta
        rows.append(
            [
                f"`{known.name}`",
                f"{math.degrees(arch.half_angle):.6g}",
                f"{problem.mu:.6g}",
                ", ".join(expected.modes),
                _eta(expected.eta),
                _eta(found.eta),
                f"{_eta(built)} (n = {arch.voussoirs})",
                problem.source.replace("|", "\\|"),
            ]
        )
    headings = ["arch", "alpha", "mu", "modes", "known eta", "theory", "as built", "source"]
    return table(headings, rows)


def _eta(value: float | None) -> str:
    return "none stands" if value is None else f"{value:.8g}"


def _structures() -> str:
    """Set what is known of each shipped structure beside what limit analysis says."""
    known = [each for each in structures(quick=False) if not each.expect[0].modes]
    asked = {(row.structure, row.question): row for row in validate(known, [], workers=1)}
    rows = list[list[str]]()
    for each in known:
        for one in each.expect:
            question = one.over or "stands"
            value = "-" if one.value is None else f"{one.value:.10g}"
            row = asked.get((each.name, question))
            said = "of engines only" if row is None else _found(row)
            over = f"`--over {one.over}`" if one.over else "does it stand?"
            cells = [over, one.verdict or value, one.published or "-", said]
            source = each.problem.source.replace("|", "\\|")
            rows.append([f"`{each.name}`", *cells, source])
    headings = ["structure", "question", "known", "published", "limit analysis", "source"]
    return table(headings, rows)


def _found(row: Row) -> str:
    if row.value is None:
        return str(row.verdict)
    return f"{row.value:.8g} {row.unit or ''}".strip()
