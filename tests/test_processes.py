"""Processes end with the work they were started for, whatever ends it."""

from __future__ import annotations

import signal
import time
from multiprocessing import active_children
from pathlib import Path

import pytest
from running import alive, children, started, until

from blocksim.common.processes import Hands


def test_work_that_is_broken_off_ends_at_once() -> None:
    with pytest.raises(KeyboardInterrupt), Hands(2) as hands:  # noqa: PT012
        long = [hands.submit(time.sleep, 3600) for _ in range(5)]
        until(lambda: long[0].running() and len(active_children()) == 2)
        raise KeyboardInterrupt
    until(lambda: not active_children())
    until(lambda: not any(each.running() for each in long[2:]))


def test_work_that_is_done_is_had() -> None:
    with Hands(2) as hands:
        asked = [hands.submit(abs, each) for each in range(-3, 0)]
        assert [each.result() for each in asked] == [3, 2, 1]
    until(lambda: not active_children())


def at_work(pid: int) -> list[int]:
    """Workers that have begun: with threads of their own."""
    return [each for each in children(pid) if len([*Path(f"/proc/{each}").glob("task/*")]) > 1]


@pytest.mark.long
@pytest.mark.parametrize(
    ("sent", "code"),
    [(signal.SIGINT, 130), (signal.SIGTERM, 143)],
)
def test_an_interrupted_validation_leaves_nothing(
    tmp_path: Path, sent: signal.Signals, code: int
) -> None:
    out = tmp_path / "out"
    with started("validate", "--full", "--out", str(out)) as driver:
        until(lambda: len(at_work(driver.pid)) == 2, driver)
        workers = children(driver.pid)
        driver.send_signal(sent)
        assert driver.stderr is not None
        assert driver.stderr.read() == b"blocksim: interrupted\n"
        assert driver.wait() == code
    until(lambda: not any(alive(pid) for pid in workers))
    assert list(out.iterdir()) == []
