"""The command that makes a structure file of a drawing or of another program's file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, cast

from blocksim.cli.arguments import Argument, Option
from blocksim.cli.options import named_options, require_given
from blocksim.cli.output import picture_kind, save_picture, say
from blocksim.cli.structures import reading_of
from blocksim.common.checks import require
from blocksim.common.errors import InputError
from blocksim.common.files import json_text, require_place, write_whole
from blocksim.common.words import counted
from blocksim.kinds.files import (
    DRAWN,
    deepened,
    is_drawing,
    named_file,
    structure_of,
    with_friction,
    within,
)
from blocksim.reading.drawing import Reading


def convert(
    source: Annotated[
        str, Argument(about="A drawing, .dxf or .svg, or an assembly of compas, .json.")
    ],
    out: Annotated[
        Path | None, Option(about="Structure file to write, .json; required.")
    ] = None,
    picture: Annotated[
        Path | None,
        Option(
            about="Picture of what was read of a drawing, and of what was refused and where: "
            ".png, .svg or .pdf; --out may then be left out."
        ),
    ] = None,
    mu: Annotated[
        float | None, Option(about="Friction coefficient, above 0; inf allowed.")
    ] = None,
    unit: Annotated[
        str | None,
        Option(about="Of the drawing: m, mm, cm, dm, in, ft, or metres that a unit is."),
    ] = None,
    layer: Annotated[
        list[str] | None,
        Option(
            metavar="ROLE=NAME",
            about="Layer that is read as blocks or as supports, or is ignored; repeatable.",
        ),
    ] = None,
    snap: Annotated[
        float | None, Option(about="Ends of lines that are so near are one corner, in m.")
    ] = None,
    depth: Annotated[
        float | None, Option(about="Depth of the blocks out of the plane in m.")
    ] = None,
    tolerance: Annotated[
        float | None, Option(about="Gaps and overlaps up to this are closed, in m.")
    ] = None,
    fixed: Annotated[
        str | None, Option(about="Blocks that stay where they are: ids, with commas.")
    ] = None,
) -> None:
    """Turn a drawing into a structure file, so that loads, weights or friction can be added."""
    require_given(**({} if picture else {"out": out}))
    if out is not None:
        require(out.suffix == ".json", "--out", str(out), "a file name ending in .json")
        require_place(out)
    drawn = is_drawing(source)
    if picture is not None:
        require(drawn, "--picture", str(picture), "left out: it is of drawings")
        picture_kind(picture, ("png", "svg", "pdf"), "--picture")
    if drawn:
        require_given(mu=mu)
    reading = reading_of(unit, layer, snap)
    try:
        with named_options(), named_file(source, reading) as data:
            said = data if mu is None else with_friction(data, mu)
            if tolerance is not None:
                said = within(said, tolerance)
            if depth is not None:
                said = deepened(said, depth)
            require(isinstance(said, dict), "structure", type(said).__name__, "a table of keys")
            table = _held(cast("dict[str, Any]", said), fixed)
            problem = structure_of(table)
    except InputError as error:
        if picture is not None:
            _draw(source, reading, picture, error)
        raise
    if picture is not None:
        _draw(source, reading, picture, None)
    if out is not None:
        write_whole(out, lambda file: file.write(_text(table).encode()))
    assembly = problem.assembly
    where = source if out is None else f"wrote {out}"
    say(
        f"{where}: {counted(len(assembly.blocks), 'block')}, "
        f"{counted(len(assembly.supports), 'support')}, "
        f"{counted(len(assembly.joints), 'joint')}"
    )
    for note in problem.notes:
        say(f"  {note}")


def _draw(source: str, reading: Reading, picture: Path, refusal: InputError | None) -> None:
    """Draw what was read of a drawing, and what was refused."""
    # Drawing takes a second to import, which others need not wait for.
    from blocksim.view.readfigure import read_figure

    drawing = DRAWN[Path(source).suffix.lower()](source, reading)
    kind = picture.suffix.removeprefix(".")
    save_picture(read_figure(drawing, refusal), picture, kind)


def _held(table: dict[str, Any], fixed: str | None) -> dict[str, Any]:
    """Return a structure with more blocks that stay where they are."""
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
