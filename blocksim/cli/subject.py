"""What is asked about: a file, a shipped name, a kind, or the circular arch by its options."""

from __future__ import annotations

from dataclasses import replace

from blocksim.blocks.problem import Problem
from blocksim.cli.options import Given, Loading, named_options, require_given
from blocksim.cli.question import question


def is_structure(scene: str | None) -> bool:
    """Tell a structure from an arch by its options, or a scenario of one."""
    if scene is None:
        return False
    # An arch by its options is answered sooner than readers of files are loaded.
    from blocksim.cli.structures import is_structure

    return is_structure(scene)


def in_space(scene: str | None) -> bool:
    """Tell a structure in space by what is in its file."""
    from blocksim.kinds import SOLID_KINDS

    if scene in SOLID_KINDS:
        return True
    if scene is None or not scene.lower().endswith((".json", ".toml")):
        return False
    from blocksim.kinds.files import lies_in_space

    return lies_in_space(scene)


def problem_asked(
    scene: str | None,
    given: Given,
    loading: Loading,
    *,
    thick: bool = False,
    sought: bool = False,
    **needed: object,
) -> Problem:
    """Return what is asked about, and what the options put on it.

    Parameters
    ----------
    scene, given, thick, needed
        As of `question`.
    loading : Loading
    sought : bool
        Whether the thickness of an arch is what is sought.
    """
    if scene is not None and is_structure(scene):
        from blocksim.cli.structures import structure

        require_given(**needed)
        return structure(scene, given, loading)
    asked = question(scene, given, thick=thick, **needed)
    with named_options():
        if sought and not asked.has_thickness:
            asked = replace(asked, given={**asked.given, "eta": 1.0})
        # Fill and loads on the road are borne by supports that are drawn.
        problem = asked.problem(supports=bool(loading.on_road))
    if not loading.given:
        return problem
    from blocksim.cli.road import loaded

    return loaded(problem, Given(), loading)
