"""The command line of the studies: what `main` takes are its argument and its options."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, ParamSpec, TypeVar

import click

from blocksim.cli.arguments import Argument, Option, command_of

Asked = ParamSpec("Asked")
Found = TypeVar("Found")
ABOUT = "Folder for what is found."


def run(main: Callable[Asked, Found], show: Callable[[Found], object] = str) -> None:
    """Run a study as the command line says, and print what it returns."""

    @wraps(main)
    def command(*args: Asked.args, **options: Asked.kwargs) -> None:
        click.echo(show(main(*args, **options)))

    needed = signature(main).parameters["out"].default is Parameter.empty
    folder = Argument(about=ABOUT, folder=True) if needed else Option(about=ABOUT, folder=True)
    command.__annotations__ = {**main.__annotations__, "out": Annotated[Path, folder]}
    command_of(command).main()
