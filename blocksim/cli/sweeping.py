"""The command sweep: a design to an executor, and what became of it in words."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path

from blocksim.cli.arguments import argument, option
from blocksim.cli.options import JSON, require_given
from blocksim.cli.output import answer_with, progress
from blocksim.common.checks import Range
from blocksim.common.errors import ALL_MISSING, MISSING, InputError
from blocksim.sweeps.cluster import cluster
from blocksim.sweeps.load import load_design
from blocksim.sweeps.run import Summary
from blocksim.sweeps.run import sweep as ask_sweep
from blocksim.sweeps.table import require_parquet, write_csv, write_parquet


def sweep(
    design: Path | None = argument("Which arches to ask about: a .toml file; required."),
    out: Path | None = option(
        "Folder for the rows; one that has some is resumed; required.", folder=True
    ),
    workers: int = option("Processes.", default=2, range=Range(low=1, high=256, whole=True)),
    scheduler: str | None = option("Address of a dask scheduler, instead of processes."),
    parquet: bool = option(
        "Write all rows as a table, too: rows.parquet.", default=False, name="--parquet"
    ),
    csv: bool = option("Write all rows as CSV, too: rows.csv.", default=False, name="--csv"),
    as_json: bool = JSON,
) -> None:
    """Ask about many arches. A run that was killed goes on where it was."""
    if design is None:
        extra = " and --out" if out is None else ""
        raise InputError(f"DESIGN{extra}", ALL_MISSING if extra else MISSING, "given")
    require_given(out=out)
    out = out or Path()
    asked = load_design(design)
    if parquet:
        require_parquet()
    with ExitStack() as stack:
        executor = None
        if scheduler is not None:
            executor, workers = stack.enter_context(cluster(scheduler))
        report = stack.enter_context(progress())
        done = ask_sweep(asked, out, executor=executor, workers=workers, progress=report)
        if parquet:
            write_parquet(out, out / "rows.parquet")
        if csv:
            write_csv(out, out / "rows.csv")
    answer_with(lambda: summary_record(done), lambda: summary_lines(done, out), as_json=as_json)


def summary_record(done: Summary) -> dict[str, object]:
    """Return a summary as `sweep --json` prints it."""
    return {
        "cases": done.cases,
        "found": done.found,
        **asdict(done.tally),
        "saved_s": done.saved_s,
        "wall_s": done.wall_s,
    }


def summary_lines(done: Summary, out: Path) -> list[str]:
    """Return a summary in words."""
    tally = done.tally
    before = f"; {done.found} were there before" if done.found else ""
    lines = [f"{out} has a row for each of {done.cases} cases{before}"]
    if tally.rows:
        pace = tally.rows / done.wall_s
        lines.append(f"  new     {tally.rows}, in {done.wall_s:.3g} s ({pace:.3g} a second)")
    if tally.simulated:
        mean = tally.simulated_s / tally.simulated
        lines.append(f"  moved   {tally.simulated} were simulated, in {mean:.2g} s each")
    if tally.spared:
        saved = "" if done.saved_s is None else f", which saved about {done.saved_s:.3g} s"
        lines.append(f"  exact   {tally.spared} were answered by limit analysis{saved}")
        lines.append("          (they are too far from their limit to be worth simulating)")
    if tally.failed:
        lines.append(f"  failed  {tally.failed} could not be answered: their rows say why")
    return lines
