"""Where pages are made of templates."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from blocksim.report.answerwords import ratio
from blocksim.view import style
from blocksim.view.templates import environment_of

if TYPE_CHECKING:
    from jinja2 import Environment

JOINT = 3.0
"""Width of a joint that takes part [pixels]."""


def environment() -> Environment:
    """Return templates of this room, which know colours."""
    made = environment_of("blocksim.report", "templates", lstrip=True)
    made.filters["ratio"] = ratio
    colours = {
        "joint_colours": style.JOINTS,
        "dashes": {
            tone: [JOINT * each for each in style.DASHES.get(tone, ())]
            for tone in style.JOINTS.values()
        },
        "miss_colour": style.MISS,
        "thrust_colour": style.THRUST,
        "verdict_colours": style.VERDICTS,
        "load_colours": {"dead": style.DEAD, "live": style.LIVE, "gravity": style.QUIET},
    }
    cast("dict[str, object]", made.globals).update(colours)
    return made
