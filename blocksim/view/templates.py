"""Where pages are made of templates: the one place that knows Jinja2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from blocksim.common.words import printed
from blocksim.view import style

JOINT = 3.0
"""Width of a joint that takes part [pixels]."""


def template_of(
    package: str, name: str, folder: str = "", **filters: Callable[[Any], str]
) -> Template:
    """Return a template of a package, which knows colours and escapes what it is given."""
    environment = Environment(
        loader=PackageLoader(package, folder),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=printed,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # JSON has no infinity; modes keep the order of the paper.
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False}
    environment.filters.update(filters)
    dashes = {
        tone: [JOINT * each for each in style.DASHES.get(tone, ())]
        for tone in style.JOINTS.values()
    }
    known: dict[str, object] = {
        "joint_colours": style.JOINTS,
        "dashes": dashes,
        "miss_colour": style.MISS,
        "thrust_colour": style.THRUST,
        "verdict_colours": style.VERDICTS,
        "load_colours": {"dead": style.DEAD, "live": style.LIVE, "gravity": style.QUIET},
    }
    return environment.get_template(name, globals=known)
