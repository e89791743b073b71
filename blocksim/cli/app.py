"""The program: its name, its options, and its commands, each loaded when it is asked for."""

from __future__ import annotations

import os
import pkgutil
import re
import sys
from functools import partial
from importlib import import_module
from typing import Any

import click
from click.shell_completion import CompletionItem, shell_complete

from blocksim.cli.arguments import command_of
from blocksim.cli.output import say
from blocksim.common import interrupts
from blocksim.common.errors import InputError
from blocksim.common.later import Later
from blocksim.common.version import __version__

COMMANDS = {
    "check": "asking.check",
    "bracket": "asking.bracket",
    "verify": "proving.verify",
    "simulate": "commands.simulate",
    "fragility": "sweeping.fragility",
    "render": "commands.render",
    "convert": "converting.convert",
    "report": "reporting.report",
    "validate": "studies.validate",
    "chart": "studies.chart",
    "suite export": "studies.export",
    "suite score": "studies.score",
    "suite replay": "studies.replay",
    "sweep": "sweeping.sweep",
    "map": "mapping.draw_map",
    "paper": "mapping.paper",
    "scenarios": "listing.list_scenarios",
    "kinds": "listing.list_kinds",
    "doctor": "listing.doctor",
    "cite": "listing.cite",
}
"""File and function of each command, which may be two words."""


COMPLETES = "_BLOCKSIM_COMPLETE"


def about_of(name: str) -> str:
    """Return the first line of the help of a command, which is not loaded to be listed."""
    file, _, function = COMMANDS[name].partition(".")
    source = (pkgutil.get_data(__package__ or "", f"{file}.py") or b"").decode()
    found = re.search(
        rf'^def {function}\(.*?"""(.*?)("""|\n)', source, re.DOTALL | re.MULTILINE
    )
    return found[1] if found else ""


class Commands(click.Group):
    """The commands by name, none of which is loaded to be listed."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - as called
        """Return the names, in the order of the help."""
        return list(COMMANDS)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find a command by its first word, or by two."""
        two = " ".join(args[:2])
        if two in COMMANDS:
            args = [two, *args[2:]]
        following = [name for name in COMMANDS if name.startswith(f"{args[0]} ")]
        if following and not ctx.resilient_parsing:
            ctx.fail(f"{args[0]} must be one of: {', '.join(following)}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write the commands and what they are for."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, about_of(name)) for name in COMMANDS])

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Return the names that begin so, and options of the program itself."""
        found = [
            CompletionItem(name, help=about_of(name))
            for name in COMMANDS
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]


def _command(name: str, place: str) -> click.Command:
    """Load a command."""
    file, _, function = place.partition(".")
    with interrupts.AtOnce():
        return command_of(getattr(import_module(f"blocksim.cli.{file}"), function), name)


@click.pass_context
def start(context: click.Context, version: bool) -> None:
    """Answer whether a masonry arch stands, how thin it can be and how it falls."""
    if version:
        say(f"blocksim {__version__}")
    elif context.invoked_subcommand is None:
        say(*context.get_help().splitlines())
    if version:
        context.exit()


_commands: Any = Later(
    {name: partial(_command, name, place) for name, place in COMMANDS.items()}
)
app = Commands(
    "blocksim",
    _commands,
    callback=start,
    params=[click.Option(["--version"], is_flag=True, help="Print the version.")],
    invoke_without_command=True,
    help=start.__doc__,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def run() -> int:
    """Run the command that the program was given, and return its exit code.

    Not by click's own `main`, which has words of its own for interrupts and readers that went.
    A shell that completes a line says so in the environment, as click's documentation has it.
    """
    if COMPLETES in os.environ:
        return shell_complete(app, {}, "blocksim", COMPLETES, os.environ[COMPLETES])
    for word in sys.argv[1:]:
        try:
            word.encode()
        except UnicodeEncodeError:
            raise InputError("argument", word, "text in UTF-8, names of files, too") from None
    try:
        with app.make_context("blocksim", sys.argv[1:]) as context:
            app.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return 0
