"""The command line of the studies: what `main` takes are its argument and its options."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

import click

from blocksim.cli.arguments import command_of

Asked = ParamSpec("Asked")
Found = TypeVar("Found")


def run(main: Callable[Asked, Found], show: Callable[[Found], object] = str) -> None:
    """Run a study as the command line says, and print what it returns."""

    @wraps(main)
    def command(*args: Asked.args, **options: Asked.kwargs) -> None:
        click.echo(show(main(*args, **options)))

    command_of(command).main()
