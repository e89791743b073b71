"""Sweeps that are killed, run out of disk or meet each other lose no row."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from running import alive, blocksim, children, inside, ran, small_files, started, until
from sweeps import SIMULATED, Rows, design_of, rows_of, swept, written

FOR_MINUTES = SIMULATED.replace("count = 20", "count = 4000")


def test_a_write_that_was_interrupted_loses_nothing(
    tmp_path: Path, uninterrupted: Rows
) -> None:
    design = design_of(tmp_path, SIMULATED)
    swept(design, tmp_path)
    shards = sorted(tmp_path.glob("rows-*.jsonl"), key=lambda path: path.stat().st_size)
    whole = shards[-1].read_bytes()
    (tmp_path / f".{shards[-1].name}.part").write_bytes(whole[:100])
    shards[-1].write_bytes(whole[:-30])
    shards[0].write_bytes(b'{"id": "0a')
    done = swept(design, tmp_path)
    assert 0 < done.tally.rows < 40
    assert rows_of(tmp_path) == uninterrupted
    assert not list(tmp_path.glob(".rows-*"))


def test_a_folder_is_for_one_sweep_at_a_time(tmp_path: Path) -> None:
    asked, out = written(tmp_path, FOR_MINUTES), tmp_path / "out"
    with started(*asked, "--workers", "1") as driver:
        until(lambda: shards(out) > 0, driver)
        part = out / ".rows-x.jsonl.part"
        part.write_text("what the other is writing")
        done = inside(*asked, "--workers", "1")
        driver.kill()
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert f"--out = '{out}': must be a folder no other sweep is at work in" in done.stderr
    assert part.exists()


@pytest.mark.usefixtures("in_this_process")
def test_a_full_disk_is_one_line_and_the_next_run_goes_on(
    tmp_path: Path, uninterrupted: Rows
) -> None:
    asked, out = written(tmp_path, SIMULATED), tmp_path / "out"

    # A row of each method is known to fit; all others are one chunk, which does not.
    chunks = "from blocksim.sweeps import run\nrun.SHORTEST = run.LONGEST = 1e9\n"
    done = blocksim(*asked, "--workers", "1", before=chunks + small_files(2500))
    assert done.returncode == 74
    assert done.stderr.count("\n") == 1
    assert "the system says 'File too large'" in done.stderr
    assert not list(out.glob(".rows-*"))
    assert 0 < len(rows_of(out)) < 40
    ran(*asked, "--workers", "1")
    assert rows_of(out) == uninterrupted


def shards(out: Path) -> int:
    return len(list(out.glob("rows-*")))


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("killed", ["driver", "worker"])
def test_what_is_killed_leaves_no_process_and_loses_no_row(
    tmp_path: Path, uninterrupted: Rows, killed: str
) -> None:
    """Of a sweep that would go on for minutes, and of a small one that begins as it did."""
    asked, out = written(tmp_path, FOR_MINUTES), tmp_path / "out"
    with started(*asked, "--workers", "1") as driver:
        until(lambda: shards(out) > 0, driver)
        workers = children(driver.pid)
        assert workers
        if killed == "worker":
            for pid in workers:
                os.kill(pid, signal.SIGKILL)
            until(lambda: bool({*children(driver.pid)} - {*workers}), driver)
            there = shards(out)
            until(lambda: shards(out) > there + 1, driver)
            workers += children(driver.pid)
        driver.kill()
    until(lambda: not any(alive(pid) for pid in workers))
    kept = rows_of(out)
    assert kept
    ran(*written(tmp_path, SIMULATED), "--workers", "1")
    found = rows_of(out)
    assert {name: found[name] for name in kept} == kept
    assert {name: found[name] for name in uninterrupted} == uninterrupted


CLUSTER = """
import sys
from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(
        n_workers=int(sys.argv[1]), threads_per_worker=1, dashboard_address=None
    ) as cluster:
        print(cluster.scheduler_address, flush=True)
        input()
"""
PATIENT = {f"DASK_DISTRIBUTED__COMM__TIMEOUTS__{name}": "300s" for name in ("CONNECT", "TCP")}
"""A machine that is busy elsewhere is no fault."""


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, int]]:
    """A cluster in processes of its own: its address, and the process that has its workers."""
    pytest.importorskip("distributed")
    program = folder / "cluster.py"
    program.write_text(CLUSTER)
    with subprocess.Popen(
        [sys.executable, str(program), str(workers)], stdin=-1, stdout=-1,
        env={**os.environ, **PATIENT}, text=True,
    ) as process:  # fmt: skip
        try:
            yield process.stdout.readline().strip(), process.pid
        finally:
            process.communicate("\n")


def test_a_dask_cluster_gives_the_same_rows(tmp_path: Path, uninterrupted: Rows) -> None:
    asked = written(tmp_path, SIMULATED)
    with cluster(tmp_path, 1) as (address, _):
        done = inside(*asked, "--scheduler", address, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["rows"] == 40
    assert rows_of(tmp_path / "out") == uninterrupted
