"""The command line of the studies: what `main` takes are its argument and its options."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import signature
from typing import ParamSpec, TypeVar

import click

from blocksim.cli.arguments import NEEDED, argument, command_of, option

Asked = ParamSpec("Asked")
Found = TypeVar("Found")
ABOUT = "Folder for what is found."


def run(main: Callable[Asked, Found], show: Callable[[Found], object] = str) -> None:
    """Run a study as the command line says, and print what it returns."""

    @wraps(main)
    def command(*args: Asked.args, **options: Asked.kwargs) -> None:
        click.echo(show(main(*args, **options)))

    known = signature(main)
    out = known.parameters["out"]
    folder = (argument if out.default is NEEDED else option)(
        ABOUT, default=out.default, folder=True
    )
    given = [*({**known.parameters, "out": out.replace(default=folder)}).values()]
    command.__signature__ = known.replace(parameters=given)  # type: ignore[attr-defined]
    command_of(command).main()
