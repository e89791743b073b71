"""The commands check and bracket."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Annotated

import click

from blocksim.arch.carried import carried_by_arch
from blocksim.ask.bracket import bracket as ask_bracket
from blocksim.ask.check import check as ask_check
from blocksim.cli.arguments import Option
from blocksim.cli.options import (
    EXIT_CODES,
    THICKNESS,
    AtJoint,
    Given,
    Json,
    Loading,
    MethodOption,
    MustRest,
    Over,
    ProofFile,
    Reduce,
    Scene,
    Set,
    Within,
    named_options,
    settings_of,
)
from blocksim.cli.output import answer_with, progress
from blocksim.cli.proving import write_proof
from blocksim.cli.question import arch_of, joint_of, question, thickness_words
from blocksim.common.checks import FRICTION, require
from blocksim.evidence.verdict import aside
from blocksim.kinds.circular import CircularArch, arch_problem
from blocksim.report.answers import (
    bracket_lines,
    bracket_record,
    check_lines,
    check_record,
    joint_names_of,
)
from blocksim.report.sizes import bracket_size_lines, bracket_size_record


def check(
    given: Given,
    loading: Loading,
    scene: Scene = None,
    method: MethodOption = "auto",
    settings: Set = None,
    joint: AtJoint = None,
    reduce: Reduce = None,
    must_rest: MustRest = False,
    proof: ProofFile = None,
    as_json: Json = False,
) -> None:
    """Tell whether it stands: exit code 0 stands, 1 collapses, 3 undecided."""
    if scene is not None or loading.given:
        # An arch under its own weight is answered sooner than these are loaded.
        from blocksim.cli.structures import check_problem

        check_problem(
            scene,
            given,
            loading,
            method,
            settings,
            joint,
            reduce=reduce,
            must_rest=must_rest,
            proof=proof,
            as_json=as_json,
        )
    asked = question(scene, given, thick=True)
    arch = arch_of(asked, given.ratio)
    at_joint = None if joint is None else joint_of(joint, joint_names_of(arch))
    with named_options(), progress() as report:
        problem = arch_problem(arch, asked.mu, asked.lean)
        answer = ask_check(
            problem,
            method=method,
            settings=settings_of(settings),
            reduce=reduce,
            must_rest=must_rest,
            progress=report,
        )
    write_proof(answer, proof)
    said = aside("note", thickness_words(asked, given.ratio))
    answer = replace(answer, evidence=answer.evidence + said)
    at = asked.line and asked.line.at
    told = answer.carried
    if told is not None and at_joint is not None:
        told = carried_by_arch(arch, problem, at_joint)
    answer_with(check_record(answer, told), check_lines(answer, at, told), as_json=as_json)
    raise click.exceptions.Exit(EXIT_CODES[answer.verdict])


def bracket(
    given: Given,
    loading: Loading,
    scene: Scene = None,
    over: Over = None,
    within: Within = None,
    method: MethodOption = "auto",
    tol: Annotated[float, Option(help="Relative width of the bracket.")] = 0.005,
    settings: Set = None,
    reduce: Reduce = None,
    as_json: Json = False,
) -> None:
    """Find where it starts to fall as one parameter changes: how thin an arch can be."""
    if scene is not None or loading.given or over not in {None, THICKNESS}:
        from blocksim.cli.structures import bracket_problem

        if bracket_problem(
            scene,
            given,
            loading,
            over,
            within,
            method,
            tol,
            settings,
            reduce=reduce,
            as_json=as_json,
        ):
            return
    left = {"eta": given.eta, "ratio": given.ratio, **asdict(loading)}
    for name, value in left.items():
        require(value is None, f"--{name}", value, "left out over thickness")
    require(within is None, "--within", within, "left out over thickness")
    asked = question(scene, given)
    with named_options(), progress() as report:
        FRICTION.require("mu", asked.mu)
        made = CircularArch(
            half_angle=asked.half_angle,
            eta=1.0,
            voussoirs=asked.voussoirs,
            weight=asked.weight,
            radius=asked.radius,
            depth=asked.depth,
            friction=asked.mu,
        )
        answer = ask_bracket(
            made.problem().leaning(asked.lean),
            over=THICKNESS,
            method=method,
            tol=tol,
            settings=settings_of(settings),
            reduce=reduce,
            progress=report,
        )
    record = bracket_record(answer, asked.radius) | bracket_size_record(answer, asked)
    lines = bracket_lines(answer) + bracket_size_lines(answer, asked)
    answer_with(record, lines, as_json=as_json)
