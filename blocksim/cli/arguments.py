"""Commands from functions: parameters become options, and dataclasses groups of options."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import Field as Declared
from dataclasses import dataclass, field, fields, is_dataclass
from inspect import Parameter, getdoc, signature
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin, get_type_hints

import click

from blocksim.common.checks import Range
from blocksim.common.fields import Field


class _File(click.Path):
    """The path of a file, or of a folder."""

    def __init__(self, *, folder: bool = False) -> None:
        super().__init__(path_type=Path)
        self._folder = folder

    def convert(
        self,
        value: Any,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> Any:
        """Refuse names that the system takes, but that name no file."""
        if value == "":
            self.fail("a name that is empty", param, ctx)
        if not self._folder and str(value).endswith("/"):
            self.fail(f"{value!r} is a folder, by the slash at its end", param, ctx)
        return super().convert(value, param, ctx)


if TYPE_CHECKING:
    AnyType = click.ParamType[Any]
else:
    # Generic from click 8.4 on.
    AnyType = click.ParamType


class _Number(AnyType):
    """A number in a range."""

    def __init__(self, kind: click.ParamType[Any], known: Range) -> None:
        self.name, self._kind, self._known = kind.name, kind, known

    def convert(
        self,
        value: Any,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> Any:
        """Refuse what is no number, or out of range."""
        number = self._kind.convert(value, param, ctx)
        self._known.require(param.opts[0] if param else self.name, number)
        return number


KINDS: dict[object, click.ParamType[Any]] = {
    str: click.STRING,
    int: click.INT,
    float: click.FLOAT,
    Path: _File(),
}


@dataclass(frozen=True, kw_only=True)
class Option(Field):
    """Facts about an option besides its type and default.

    `name`: With its dashes, where it is not that of the parameter; `--yes/--no` of a flag.
    `folder`: Whether a path is that of a folder.
    """

    name: str = ""
    metavar: str | None = None
    folder: bool = False


@dataclass(frozen=True, kw_only=True)
class Argument(Option):
    """Facts about an argument, which may be left out."""


NEEDED = Parameter.empty
"""Default of an argument that cannot be left out."""


def option(about: str, *, default: Any = None, **known: Any) -> Any:
    """Declare an option of a command, or of a group of options; see `Option`."""
    said = Option(about=about, **known)
    return field(default=default, metadata={Field.__name__: said})


def argument(about: str, *, default: Any = None, **known: Any) -> Any:
    """Declare an argument of a command; see `Option`."""
    said = Argument(about=about, **known)
    return field(default=default, metadata={Field.__name__: said})


class _Argument(click.Argument):
    """An argument that is told in the help, too."""

    about = ""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str]:
        return self.make_metavar(ctx), self.about


class Command(click.Command):
    """A command whose help shows options below the headings of their groups."""

    headings: dict[str, str]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Refuse options that are given twice but taken once."""
        if not ctx.resilient_parsing:
            _, _, order = self.make_parser(ctx).parse_args(list(args))
            for each, times in Counter(order).items():
                if times > 1 and isinstance(each, click.Option) and not each.multiple:
                    flags = "/".join([*each.opts, *each.secondary_opts])
                    said = f"{flags} is given {times} times: must be given once"
                    raise click.UsageError(said)
        return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write groups of options, arguments, and other options."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for each in self.get_params(ctx):
            told = each.get_help_record(ctx)
            usual = "Arguments" if isinstance(each, click.Argument) else "Options"
            if told is not None:
                heading = self.headings.get(each.name or "", usual)
                sections.setdefault(heading, []).append(told)
        for heading, told in sections.items():
            with formatter.section(heading):
                formatter.write_dl(told)


def command_of(function: Callable[..., None], name: str | None = None) -> Command:
    """Make a command of a function.

    `function`: The default of each parameter is an `option` or an `argument`, or its type is a
        dataclass of such, or of such groups. Of these it gets one, whose fields are options
        below its `heading`. Any other default is that of an option of which nothing is said.
    `name`: Of the command.
    """
    parameters: list[click.Parameter] = []
    headings: dict[str, str] = {}

    def taken(
        name: str, hint: Any, said: Any, heading: str
    ) -> Callable[[Mapping[str, Any]], Any]:
        """Declare a parameter, and return what makes its value of what was given."""
        if is_dataclass(hint) and isinstance(hint, type):
            own, under = get_type_hints(hint), getattr(hint, "heading", heading)
            parts = {
                each.name: taken(each.name, own[each.name], each, under)
                for each in fields(hint)
            }
            return lambda given: hint(**{key: part(given) for key, part in parts.items()})
        if not hasattr(said, "metadata"):
            said = (argument if said is NEEDED else option)("", default=said)
        parameters.append(_parameter(name, hint, said))
        if heading:
            headings[name] = heading
        return lambda given: given[name]

    hints = get_type_hints(function)
    every = {
        each.name: taken(each.name, hints[each.name], each.default, "")
        for each in signature(function).parameters.values()
    }

    def called(**given: Any) -> None:
        function(**{key: part(given) for key, part in every.items()})

    made = Command(name, callback=called, params=parameters, help=getdoc(function))
    made.headings = headings
    return made


def _parameter(name: str, hint: Any, declared: Declared[Any]) -> click.Parameter:
    """Make an option or an argument of a type."""
    kind, said, default = _kind(hint), declared.metadata[Field.__name__], declared.default
    if isinstance(said, Argument):
        needed = default is NEEDED
        default = None if needed else default
        made = _Argument([name], type=_type(kind, said), required=needed, default=default)
        made.about = said.about
        return made
    flags = [said.name or f"--{name.replace('_', '-')}", name]
    if kind is bool:
        return click.Option(flags, is_flag=True, default=default, help=said.about)
    many = get_origin(kind) is list
    return click.Option(
        flags,
        type=_type(get_args(kind)[0] if many else kind, said),
        multiple=many,
        default=default,
        metavar=said.metavar,
        show_default=default is not None,
        help=said.about,
        callback=_as_list if many else None,
    )


def _as_list(context: object, parameter: object, value: tuple[str, ...]) -> list[str] | None:  # noqa: ARG001
    return list(value) or None


def _kind(hint: Any) -> Any:
    """Return the type of an annotation, None left out."""
    if get_origin(hint) not in {Union, UnionType}:
        return hint
    return next(part for part in get_args(hint) if part is not NoneType)


def _type(kind: Any, said: Option) -> Any:
    if get_origin(kind) is Literal:
        return click.Choice(get_args(kind))
    if get_origin(kind) is tuple:
        return click.Tuple([KINDS[each] for each in get_args(kind)])
    if said.range is not None:
        return _Number(KINDS[kind], said.range)
    return _File(folder=True) if said.folder else KINDS[kind]
