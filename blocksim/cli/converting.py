"""The command that makes a structure file of a drawing or of another program's file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

from blocksim.cli.arguments import NEEDED, argument, option
from blocksim.cli.given import DEPTH, LAYER, MU, SNAP, TOLERANCE, UNIT, UP
from blocksim.cli.options import named_options, require_given
from blocksim.cli.output import picture_kind, say, write
from blocksim.cli.subject import reading_of
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import json_text, require_place
from blocksim.common.words import counted
from blocksim.kinds.changes import edited
from blocksim.kinds.files import DRAWN, drawing_of, is_drawing, named_file, structure_of
from blocksim.reading.drawing import Drawing


def convert(
    source: str = argument(
        "A drawing, .dxf or .svg, a mesh, or an assembly of compas, .json.", default=NEEDED
    ),
    out: Path | None = option("Structure file to write, .json; required."),
    picture: Path | None = option(
        "Picture of what was read of a drawing, and of what was refused and where: "
        ".png, .svg or .pdf; --out may then be left out."
    ),
    mu: float | None = MU,
    unit: str | None = UNIT,
    layer: list[str] | None = LAYER,
    snap: float | None = SNAP,
    up: str | None = UP,
    depth: float | None = DEPTH,
    tolerance: float | None = TOLERANCE,
    fixed: str | None = option("Blocks that stay where they are: ids, with commas."),
) -> None:
    """Turn a drawing into a structure file, so that loads, weights or friction can be added."""
    require_given(**({} if picture else {"out": out}))
    if out is not None:
        require(out.suffix == ".json", "--out", str(out), "a file name ending in .json")
        require_place(out)
    drawn = is_drawing(source)
    if picture is not None:
        flat = Path(source).suffix.lower() in DRAWN
        require(flat, "--picture", str(picture), "left out: it is of drawings")
        picture_kind(picture, ("png", "svg", "pdf"), "--picture")
    if drawn:
        require_given(mu=mu)
    reading = reading_of(unit, layer, snap, up)
    with named_options():
        drawing = None if picture is None else drawing_of(source, reading)
    try:
        with named_options(), named_file(source, reading, drawing) as data:
            said = edited(data, friction=mu, tolerance=tolerance, depth=depth)
            table = _held(said, fixed)
            problem = structure_of(table)
    except InputError as error:
        _draw(drawing, picture, error)
        raise
    _draw(drawing, picture, None)
    if out is not None:
        write(out, _text(table).encode(), silent=True)
    made, where = problem.assembly, source if out is None else f"wrote {out}"
    parts = (made.blocks, "block"), (made.supports, "support"), (made.joints, "joint")
    sizes = ", ".join(counted(len(each), noun) for each, noun in parts)
    say(f"{where}: {sizes}", *(f"  {note}" for note in problem.notes))


def _draw(drawing: Drawing | None, picture: Path | None, refusal: InputError | None) -> None:
    """Draw what was read of a drawing, and what was refused, where that is asked for."""
    if drawing is None or picture is None:
        return
    from blocksim.view.readfigure import read_figure

    write(picture, read_figure(drawing, refusal))


def _held(said: object, fixed: str | None) -> dict[str, Any]:
    """Return a structure with more blocks that stay where they are."""
    require(isinstance(said, dict), "structure", type(said).__name__, "a table of keys")
    table = cast("dict[str, Any]", said)
    if fixed is None:
        return table
    wanted = {each.strip() for each in fixed.split(",")}
    given: Any = table.get("blocks", [])
    listed = cast("list[Any]", given) if isinstance(given, list) else [given]
    if not all(isinstance(block, dict) and "id" in block for block in listed):
        return table  # what is wrong with them is said where all of it is checked
    blocks = [
        {**block, "fixed": True} if str(block["id"]) in wanted else block for block in listed
    ]
    known = {str(block["id"]) for block in blocks}
    for name in wanted - known:
        raise InputError("--fixed", name, f"ids of blocks: {', '.join(sorted(known)[:20])}")
    return {**table, "blocks": blocks}


def _text(table: dict[str, Any]) -> str:
    """Return JSON that people can edit: a line for each block."""
    lines: list[str] = []
    for key, value in table.items():
        text = json_text(value)
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = [f"    {json_text(each)}" for each in cast("list[object]", value)]
            text = "[\n" + ",\n".join(rows) + "\n  ]"
        lines.append(f"  {json_text(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"
