"""Tables in pages that are made from code or from rows: `python docs/tables.py` writes them.

A page says `<!-- table: NAME -->` and `<!-- end -->`; what lies between is replaced. A test
makes them again and compares, so that no table says anything else than the code.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import click
import numpy as np
from format_tables import of_format
from markdown_table import table
from quotes import columns
from validation_tables import of_validation

from blocksim.cli import app
from blocksim.common.fields import fields_of
from blocksim.kinds import KINDS
from blocksim.report.referee import known_scores, level_words
from blocksim.suite.families import families

ROOT = Path(__file__).resolve().parent.parent
ROWS = ROOT / "analysis" / "figures"
MARKED = re.compile(r"<!-- table: ([\w ]+) -->\n.*?<!-- end -->", flags=re.DOTALL)
CANNOT = {
    "theory": "voussoirs, motion, anything but the circular arch",
    "limit": "motion, ground that shakes",
    "direct": "blocks that crush, soil that bears more",
    "pymunk": "blocks in space, supports that move",
    "pybullet": "shaking, supports that move; creeps where joints slide",
    "mujoco": "shaking, supports that move; its contacts are soft",
}
"""In a few words; `docs/methods/methods.md` has all of it."""
FINE = {"pybullet": 0.004}
"""Relative widths of the brackets in the table of methods; 0.001 of any other method."""


def pages() -> list[Path]:
    """Return every page in which there may be tables."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def filled(page: str) -> str:
    """Return a page with its tables made anew."""
    return MARKED.sub(
        lambda found: f"<!-- table: {found[1]} -->\n{made(found[1])}\n<!-- end -->", page
    )


def made(name: str) -> str:
    """Return a table by its name, in Markdown."""
    kind, _, rest = name.partition(" ")
    return TABLES[kind](rest)


def _methods(_: str) -> str:
    with (ROWS / "costs.csv").open(encoding="utf-8", newline="") as file:
        costs = list(csv.DictReader(file))
    rows = list[list[str]]()
    for method, cannot in CANNOT.items():
        width = FINE.get(method, 0.001)
        own = {row["question"]: row for row in costs if row["method"] == method}
        check, bracket = own["check"], own[f"bracket to {width:g}"]
        finest = min(float(row["error"]) for each, row in own.items() if each != "check")
        error = _error(method, finest)
        cells = [_seconds(check), f"to {100 * width:g} %: {_seconds(bracket)}", error, cannot]
        rows.append([f"`{method}`", *cells])
    return table(["method", "a check", "a bracket", "error", "it cannot do"], rows)


def _seconds(row: dict[str, str]) -> str:
    usual, longest = (float(row[name]) for name in ("median_s", "longest_s"))
    return f"{_short(usual)} s (at most {_short(longest)} s)"


def _short(value: float) -> str:
    """Say a number to one digit, or to a whole number above one."""
    return f"{value:.0f}" if value >= 1 else f"{value:.1g}"


def _error(method: str, error: float) -> str:
    if method == "theory":
        return "none, of the continuous arch"
    return "none" if error < 1e-12 else f"{100 * error:.1g} %".replace("e-0", "e-")


def _kinds(_: str) -> str:
    rows = [
        [
            f"`{kind.name}`",
            kind.about + " (in space)" * kind.in_space,
            ", ".join(f"`{each}`" for each in fields_of(kind)),
        ]
        for kind in KINDS.values()
    ]
    return table(["kind", "what it is", "parameters"], rows)


def _parameters(name: str) -> str:
    usual = KINDS[name.replace(" ", "-")]()
    rows = list[list[str]]()
    for each, known in fields_of(type(usual)).items():
        over = ", ".join(one for one in usual.bracketed if one.partition(".")[0] == each)
        cells = [known.said(getattr(usual, each)), known.allowed, known.about, over]
        rows.append([f"`{each}`", *(cell.replace("|", "\\|") for cell in cells)])
    return table(["parameter", "if left out", "may be", "what it is", "`--over`"], rows)


def _commands(_: str) -> str:
    """Every command with its options, as `--help` has them; shared ones once, at the end."""
    group = app
    context = click.Context(group)
    parts, shared = list[str](), dict[str, dict[str, list[str]]]()
    for name in group.list_commands(context):
        command = cast(click.Command, group.get_command(context, name))
        panels = list[str]()
        rows = list[list[str]]()
        for one in command.params:
            panel = getattr(command, "headings", dict[str, str]()).get(str(one.name))
            if one.name == "help":
                continue
            if panel is None:
                rows.append(_option(one))
            else:
                shared.setdefault(panel, {})[str(one.name)] = _option(one)
                panels += [panel] * (panel not in panels)
        about = " ".join((command.help or "").partition("\n\n")[0].split())
        besides = " and ".join(
            f"[{each}](#{each.lower().replace(' ', '-')})" for each in panels
        )
        said = f"{about} It takes the options of {besides}, too." if besides else about
        parts.append(f"## {name}\n\n{said}")
        if rows:
            parts.append(table(["option", "what it says"], rows))
    for panel, own in shared.items():
        parts.append(f"## {panel}\n\n" + table(["option", "what it says"], [*own.values()]))
    return "\n\n".join(parts)


def _option(one: click.Parameter) -> list[str]:
    """Return an option's names and what its help says."""
    names = [*one.opts, *one.secondary_opts]
    shown = names if one.param_type_name == "option" else [str(one.name).upper()]
    told = getattr(one, "help", None) or getattr(one, "about", "")
    said = " ".join(told.split()).replace("|", "\\|")
    return [", ".join(f"`{each}`" for each in shown), said]


def _example(name: str) -> str:
    """Return a script as a page shows it: its picture, its text, its code."""
    code = (ROOT / "docs" / "examples" / f"{name}.py").read_text(encoding="utf-8")
    about, _, rest = code.removeprefix('"""').partition('"""')
    title, _, more = about.partition("\n\n")
    picture = f"![{' '.join(title.split())}](examples/{name}.png)"
    return f"{more.strip()}\n\n{picture}\n\n```python\n{rest.strip()}\n```"


def _suite(_: str) -> str:
    """Engines that have answered the referee's scenes, as `known.json` has them."""
    rows = [
        [
            f"{each['engine']} {each['version']}",
            each["settings"],
            level_words(each["nearest_level"]),
            _right(each["groups"], in_space=False),
            _right(each["groups"], in_space=True),
            "-" if each["median_drift"] is None else f"{each['median_drift']:.1g}",
            f"{each['seconds']:.0f} s",
        ]
        for each in known_scores()
    ]
    names = ["engine", "settings", "right to", "right in the plane", "right in space",
             "drift of what stands", "time"]  # fmt: skip
    return table(names, rows)


def _right(groups: dict[str, Any], *, in_space: bool) -> str:
    """Share of scenes and levels that are right; a dash where none was answered."""
    spatial = {each.group for each in families() if each.spatial}
    counts = [
        count
        for name, group in groups.items()
        if (name in spatial) == in_space
        for count in group["levels"].values()
    ]
    every = sum(map(sum, counts))
    return f"{100 * sum(count[0] for count in counts) / every:.1f} %" if every else "-"


def _convergence(_: str) -> str:
    """Errors of motion over the step, and the order from the second step to the fourth."""
    rows = columns("convergence")
    steps = dict.fromkeys(rows["step"].tolist())
    cells = list[list[str]]()
    for motion in dict.fromkeys(rows["motion"].tolist()):
        errors = rows["error"][rows["motion"] == motion].tolist()
        exact = max(errors) < 1e-12
        order = math.log2(errors[1] / errors[3]) / 2
        said = ["none" if exact else f"{100 * error:.1g} %" for error in errors]
        cells.append([motion, *said, "exact" if exact else f"{order:.1f}"])
    return table(["motion", *(f"step {step}" for step in steps), "order"], cells)


def _engines_converge(_: str) -> str:
    """Errors of motion by each engine at its usual step, and the order about it."""
    rows = columns("convergence_engines")
    of = [*zip(rows["in_space"], rows["engine"], rows["motion"], strict=True)]
    asked = sorted(dict.fromkeys(each[:2] for each in of), key=lambda each: each[0])
    cells = list[list[str]]()
    for motion in dict.fromkeys(rows["motion"]):
        found = [
            rows["error"][[each == (*engine, motion) for each in of]].reshape(-1, 3)
            for engine in asked
        ]
        cells.append([motion, *(_error_and_order(errors) for errors in found)])
    heads = [f"{name}{', space' * (space == 'True')}" for space, name in asked]
    return table(["motion", *heads], cells)


def _error_and_order(errors: np.ndarray) -> str:
    """Say both of motions, (motions, steps), begun at several places: by root mean squares."""
    if not len(errors):
        return "-"
    coarse, usual, fine = np.sqrt((errors**2).mean(axis=0)).tolist()
    if max(coarse, usual, fine) < 1e-10:
        return "exact"
    order = math.log2(coarse / fine) / 2
    return f"{100 * usual:.1g} % ({f'{order:.1f}' if order > 0.5 else 'no order'})"


TABLES: dict[str, Callable[[str], str]] = {
    "methods": _methods,
    "format": of_format,
    "kinds": _kinds,
    "parameters": _parameters,
    "commands": _commands,
    "validated": of_validation,
    "convergence": _convergence,
    "motions": _engines_converge,
    "example": _example,
    "suite": _suite,
}


def main() -> None:
    """Write the tables of every page."""
    for path in pages():
        text = path.read_text(encoding="utf-8")
        path.write_text(filled(text), encoding="utf-8")


if __name__ == "__main__":
    main()
