"""Tables in pages that are made from code or from rows: `python docs/tables.py` writes them.

A page says `<!-- table: NAME -->` and `<!-- end -->`; what lies between is replaced. A test
makes them again and compares, so that no table says anything else than the code.
"""

from __future__ import annotations

import csv
import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import click
import typer
from pydantic import TypeAdapter

from blocksim.arch import theory
from blocksim.arch.limit import least_thickness
from blocksim.arch.scenario import ScenarioFile, load_scenario, shipped
from blocksim.blocks.entries import Around, StructureFile
from blocksim.cli import app
from blocksim.kinds import KINDS
from blocksim.kinds.base import parameters_of
from blocksim.many.design import Design
from blocksim.studies.questions import StructureRow
from blocksim.studies.structures import structures, validate_structures

ROOT = Path(__file__).resolve().parent.parent
ROWS = ROOT / "analysis" / "figures"
MARKED = re.compile(r"<!-- table: ([\w ]+) -->\n.*?<!-- end -->", flags=re.DOTALL)
CANNOT = {
    "theory": "voussoirs, motion, anything but the circular arch",
    "limit": "motion, ground that shakes",
    "direct": "gravity out of the plane",
    "pymunk": "gravity out of the plane, supports that move",
    "pybullet": "shaking, supports that move; slow, and creeps where joints slide",
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


def table(headings: list[str], rows: list[list[str]]) -> str:
    """Set rows as a table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


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
    return table(["method", "a check", "a bracket", "error", "it cannot see"], rows)


def _seconds(row: dict[str, str]) -> str:
    usual, longest = (float(row[name]) for name in ("median_s", "longest_s"))
    return f"{_short(usual)} s (at most {_short(longest)} s)"


def _short(value: float) -> str:
    """Say a number to one digit, or to a whole number above one."""
    return f"{value:.0f}" if value >= 1 else f"{value:.1g}"


def _error(method: str, error: float) -> str:
    if method == "theory":
        return "none, of the continuous arch"
    return (
        "none" if error < 1e-12 else f"{error:.0e}" if error < 1e-6 else f"{100 * error:.1g} %"
    )


def _format(which: str) -> str:
    """Tables of the keys of a file: one of its top, one for each table inside it."""
    schemas = {"structure": StructureFile, "scenario": ScenarioFile, "design": Design}
    schema = TypeAdapter(schemas[which]).json_schema()
    parts = {"": schema, **{_word(name): part for name, part in schema["$defs"].items()}}
    return "\n\n".join(
        (f"**{name}**: {_sentence(part)}\n\n" if name else "") + _keys(part)
        for name, part in parts.items()
        if "properties" in part
    )


def _word(name: str) -> str:
    """Say `BlockEntry` as block."""
    return re.sub(r"(Entry|Table)$", "", name).lower()


def _sentence(part: dict[str, Any]) -> str:
    return " ".join(part.get("description", "").partition("\n")[0].split())


def _keys(part: dict[str, Any]) -> str:
    required = part.get("required", [])
    said = _described(part)
    rows = [
        [
            f"`{name}`",
            _kind(each).replace("|", "\\|"),
            "must be given" if name in required else _default(each.get("default")),
            said[name].replace("|", "\\|"),
        ]
        for name, each in part["properties"].items()
    ]
    return table(["key", "may be", "if left out", "what it is"], rows)


def _described(part: dict[str, Any]) -> dict[str, str]:
    """Return what a docstring in numpy style says of each parameter, bases included."""
    text = part.get("description", "")
    if part.get("title") == "StructureFile":
        text += "\n" + re.sub(r"^ {4}", "", Around.__doc__ or "", flags=re.MULTILINE)
    said = dict[str, str]()
    for found in re.finditer(
        r"^(\w[\w, ]*) : [^\n]*\n((?:    [^\n]*\n?)*)", text, flags=re.MULTILINE
    ):
        for name in found[1].split(", "):
            said[name] = " ".join(found[2].split())
    return said


def _default(value: Any) -> str:
    if value is None or value in ([], {}, ""):
        return "-"
    if isinstance(value, dict) and "values" in value:
        return ", ".join(f"`{each:g}`" for each in value["values"])
    if isinstance(value, dict):
        return "as its own keys say"
    if isinstance(value, list):
        return ", ".join(f"`{each}`" for each in value)
    return "`true`" if value is True else "`false`" if value is False else f"`{value}`"


def _kind(part: dict[str, Any], *, many: bool = False) -> str:
    """Say what a key may be: `many` after "list of"."""
    if "$ref" in part:
        name = _word(part["$ref"].rpartition("/")[2])
        return f"{name} tables" if many else "axis" if name == "axis" else f"table {name}"
    options = [each for each in part.get("anyOf", []) if each.get("type") != "null"]
    if options:
        return ", or ".join(_kind(each, many=many) for each in options)
    if "const" in part or "enum" in part:
        return " or ".join(f"`{each}`" for each in part.get("enum", [part.get("const")]))
    match part.get("type"):
        case "boolean":
            return "true or false"
        case "string":
            return "texts" if many else "text"
        case "array":
            return _list(part, many=many)
        case "integer" | "number":
            return _number(part, many=many)
    return "anything"


def _list(part: dict[str, Any], *, many: bool) -> str:
    fixed = part.get("prefixItems")
    if fixed and fixed[0].get("type") == "number":
        return "points" if many else "point `[x, y]`"
    if fixed:
        return f"{len(fixed)} of: {_kind(fixed[0])}"
    low, high = part.get("minItems"), part.get("maxItems", math.inf)
    size = f"{low} to {high} " if low and high <= 3 else f"{low} or more " if low else ""
    return ("lists" if many else "list") + f" of {size}{_kind(part['items'], many=True)}"


def _number(part: dict[str, Any], *, many: bool) -> str:
    noun = "whole number" if part["type"] == "integer" else "number"
    noun += "s" if many else ""
    above, below = part.get("exclusiveMinimum"), part.get("exclusiveMaximum")
    low, high = part.get("minimum"), part.get("maximum")
    said = list[str]()
    if above is not None:
        said.append(f"above {above:g}")
    elif low is not None and abs(low) < 1e9:
        said.append(f"{low:g} or more")
    if below is not None:
        said.append(f"below {below:g}")
    elif high is not None and abs(high) < 1e9:
        said.append(f"at most {high:g}")
    return noun + (", " + ", ".join(said) if said else "")


def _kinds(_: str) -> str:
    rows = [
        [f"`{kind.name}`", kind.about, ", ".join(f"`{each}`" for each in parameters_of(kind))]
        for kind in KINDS.values()
    ]
    return table(["kind", "what it is", "parameters"], rows)


def _parameters(name: str) -> str:
    usual = KINDS[name.replace(" ", "-")]()
    rows = list[list[str]]()
    for each, known in parameters_of(type(usual)).items():
        over = ", ".join(one for one in usual.bracketed if one.partition(".")[0] == each)
        cells = [*known.words(getattr(usual, each)), known.about, over]
        rows.append([f"`{each}`", *(cell.replace("|", "\\|") for cell in cells)])
    return table(["parameter", "if left out", "may be", "what it is", "`--over`"], rows)


def _commands(_: str) -> str:
    """Every command with its options, as `--help` has them; shared ones once, at the end."""
    group = cast(click.Group, typer.main.get_command(app))
    context = click.Context(group)
    parts, shared = list[str](), dict[str, dict[str, list[str]]]()
    for name in group.list_commands(context):
        command = cast(click.Command, group.get_command(context, name))
        panels = list[str]()
        rows = list[list[str]]()
        for one in command.params:
            panel = getattr(one, "rich_help_panel", None)
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
    said = " ".join((getattr(one, "help", "") or "").split()).replace("|", "\\|")
    return [", ".join(f"`{each}`" for each in shown), said]


def _validated(which: str) -> str:
    return {
        "landmarks": _landmarks,
        "captions": _captions,
        "scenarios": _scenarios,
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


def _scenarios() -> str:
    """Least thickness of each shipped scenario: known, by theory, and as built."""
    rows = list[list[str]]()
    for name in shipped():
        each = load_scenario(name)
        if not each.expected_modes:
            continue
        found = theory.least_thickness(each.half_angle, each.mu, each.weight)
        built = least_thickness(each.half_angle, each.mu, each.voussoirs, each.weight).eta
        rows.append(
            [
                f"`{name}`",
                f"{math.degrees(each.half_angle):.6g}",
                f"{each.mu:.6g}",
                ", ".join(str(mode) for mode in each.expected_modes),
                _eta(each.expected_eta),
                _eta(found.eta),
                f"{_eta(built)} (n = {each.voussoirs})",
                each.source.replace("|", "\\|"),
            ]
        )
    headings = ["scenario", "alpha", "mu", "modes", "known eta", "theory", "as built", "source"]
    return table(headings, rows)


def _eta(value: float | None) -> str:
    return "none stands" if value is None else f"{value:.8g}"


def _structures() -> str:
    """Set what is known of each shipped structure beside what limit analysis says."""
    known = structures(quick=False)
    asked = {
        (row.structure, row.question): row for row in validate_structures(known, [], workers=1)
    }
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


def _found(row: StructureRow) -> str:
    if row.value is None:
        return str(row.verdict)
    return f"{row.value:.8g} {row.unit or ''}".strip()


def _example(name: str) -> str:
    """Return a script as a page shows it: its picture, its text, its code."""
    code = (ROOT / "docs" / "examples" / f"{name}.py").read_text(encoding="utf-8")
    about, _, rest = code.removeprefix('"""').partition('"""')
    title, _, more = about.partition("\n\n")
    picture = f"![{' '.join(title.split())}](examples/{name}.png)"
    return f"{more.strip()}\n\n{picture}\n\n```python\n{rest.strip()}\n```"


TABLES: dict[str, Callable[[str], str]] = {
    "methods": _methods,
    "format": _format,
    "kinds": _kinds,
    "parameters": _parameters,
    "commands": _commands,
    "validated": _validated,
    "example": _example,
}


def main() -> None:
    """Write the tables of every page."""
    for path in pages():
        text = path.read_text(encoding="utf-8")
        path.write_text(filled(text), encoding="utf-8")


if __name__ == "__main__":
    main()
