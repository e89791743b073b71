"""The command check."""

from __future__ import annotations

from dataclasses import replace

import click

from blocksim.arch.carried import carried_by_arch
from blocksim.arch.check import check as ask_check
from blocksim.cli.options import (
    EXIT_CODES,
    AtJoint,
    Given,
    Json,
    Loading,
    MethodOption,
    Reduce,
    Scene,
    Set,
    named_options,
    settings_of,
)
from blocksim.cli.output import answer_with, progress
from blocksim.cli.question import arch_of, joint_of, question, thickness_words
from blocksim.report.answers import check_lines, check_record, joint_names_of


def check(
    given: Given,
    loading: Loading,
    scene: Scene = None,
    method: MethodOption = "auto",
    settings: Set = None,
    joint: AtJoint = None,
    reduce: Reduce = False,
    as_json: Json = False,
) -> None:
    """Tell whether it stands: exit code 0 stands, 1 collapses, 3 undecided."""
    if scene is not None or loading.given:
        # An arch under its own weight is answered sooner than these are loaded.
        from blocksim.cli.structures import check_problem

        check_problem(
            scene, given, loading, method, settings, joint, reduce=reduce, as_json=as_json
        )
    asked = question(scene, given, thick=True)
    arch = arch_of(asked, given.ratio)
    at_joint = None if joint is None else joint_of(joint, joint_names_of(arch))
    with named_options(), progress() as report:
        answer = ask_check(
            arch,
            mu=asked.mu,
            method=method,
            lean=asked.lean,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    answer = replace(answer, reason=answer.reason + thickness_words(asked, given.ratio))
    at = asked.line and asked.line.at
    told = answer.carried
    if told is not None and at_joint is not None:
        told = carried_by_arch(arch, asked.mu, at_joint)
    answer_with(check_record(answer, told), check_lines(answer, at, told), as_json=as_json)
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])
