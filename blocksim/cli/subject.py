"""What is asked about: a file, a shipped name, a kind, or the circular arch by its options."""

from __future__ import annotations

from dataclasses import replace

from blocksim.blocks.problem import Problem
from blocksim.cli.options import Given, Loading, require_given
from blocksim.cli.question import maker_of, of_any_thickness, question, thickness_notes


def is_structure(scene: str | None) -> bool:
    """Tell a structure from an arch by its options, or a scenario of one."""
    if scene is None:
        return False
    # An arch by its options is answered sooner than readers of files are loaded.
    from blocksim.cli.structures import is_structure

    return is_structure(scene)


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
    made = of_any_thickness(asked) if sought else maker_of(asked, given.ratio)
    notes = () if sought else thickness_notes(asked, given.ratio)
    # Fill and loads on the road are borne by supports that are drawn.
    built = (made.between_supports() if loading.on_road else made).problem()
    problem = replace(built.leaning(asked.lean) if asked.lean else built, notes=notes)
    if not loading.given:
        return problem
    from blocksim.cli.road import loaded

    return loaded(problem, Given(), loading)
