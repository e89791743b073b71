"""Options declared once: a command that takes a dataclass takes its fields as options."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, get_args, get_type_hints


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """Show typer the fields of parameters that are dataclasses as options of their own.

    Parameters
    ----------
    command : callable
        Parameters whose type is a dataclass get one; its fields are annotated as options are,
        and shown in the help below its `heading`.

    Returns
    -------
    callable
        Of keyword arguments only: the fields, in place of the dataclasses.
    """
    groups: dict[str, type[Any]] = {}
    shown: list[Parameter] = []
    hints = get_type_hints(command, include_extras=True)
    for each in signature(command).parameters.values():
        hint = hints[each.name]
        if is_dataclass(hint) and isinstance(hint, type):
            groups[each.name] = hint
            own = get_type_hints(hint, include_extras=True)
            for field in fields(hint):
                for told in get_args(own[field.name])[1:]:
                    # A heading of their own in the help.
                    told.rich_help_panel = getattr(hint, "heading", None)
                shown.append(_option(field.name, own[field.name], field.default))
        else:
            shown.append(_option(each.name, hint, each.default))

    @wraps(command)
    def called(**given: Any) -> None:
        made = {
            name: group(**{field.name: given.pop(field.name) for field in fields(group)})
            for name, group in groups.items()
        }
        command(**given, **made)

    # What typer reads; without these it would look at the command behind.
    called.__signature__ = Signature(shown)  # type: ignore[attr-defined]
    called.__annotations__ = {each.name: each.annotation for each in shown}
    return called


def _option(name: str, hint: Any, default: Any) -> Parameter:
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=hint)
