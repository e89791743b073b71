"""Long use and strange surroundings: nothing grows, and nothing needed may be missing."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from running import PROGRAM

QUESTION = ("check", "--alpha", "90", "--mu", "0.7", "--voussoirs", "9", "--eta", "0.12")
FALLS = ("check", "--alpha", "90", "--mu", "0.7", "--voussoirs", "9", "--eta", "0.08")
LONG = pytest.mark.long
CHECKS = int(os.environ.get("BLOCKSIM_LONG_CHECKS", "1000"))

GROWS = """
import json, os, sys
from pathlib import Path
from blocksim import Arch, CircularArch, check
method, count = sys.argv[1], int(sys.argv[2])

def used():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20, len(os.listdir("/proc/self/fd"))

rows = []
for number in range(count):
    # No two are the same, so that nothing is known already; nine in ten fall: sooner seen.
    stands = number % 10 == 9
    eta = (0.2 if stands else 0.07) * (1 + 1e-6 * number)
    arch = Arch(half_angle=1.5, eta=eta, voussoirs=4)
    found = check(CircularArch.of(arch, friction=0.7), method=method)
    assert found.verdict.value == ("stands" if stands else "collapses"), found.reason
    if number % max(1, count // 10) == count // 10 - 1:
        rows.append(used())
print(json.dumps(rows))
"""


@pytest.mark.long
@pytest.mark.parametrize("method", ["limit", "direct", "pymunk", "pybullet", "mujoco"])
def test_memory_and_files_are_flat(method: str) -> None:
    """Once half is done, less than a kilobyte a check by the line through what follows.

    MuJoCo's heap grows until some 4,000 models were built, and then no more; that of pymunk's
    checks for the first 2,000: of 5,000 the later half adds 0.06 kB each.
    """
    if method in {"pybullet", "mujoco"}:
        pytest.importorskip(method)
    count = CHECKS * {"mujoco": 2, "pymunk": 4}.get(method, 1)
    words = [sys.executable, "-c", GROWS, method, str(count)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    # pybullet says when it was built.
    rows = np.array(json.loads(done.stdout.splitlines()[-1]))[4:]
    checks = count / 10 * np.arange(5, 11)
    rise = np.polyfit(checks, rows[:, 0], 1)[0] * 1024
    print(f"\n{method}: {rows[:, 0].round(1)} MB, {rise:.2f} kB a check")  # noqa: T201
    assert set(rows[:, 1]) == {rows[0, 1]}
    assert rise < 1


@pytest.mark.long
def test_a_dozen_at_once_answer_alike() -> None:
    running = [
        subprocess.Popen([*PROGRAM, *QUESTION, "--method", "pymunk", "--json"], stdout=-1)
        for _ in range(12)
    ]
    answers = [json.loads(each.communicate()[0]) for each in running]
    assert [each.returncode for each in running] == [0] * 12
    assert {(one["verdict"], one["state_hash"]) for one in answers} == {
        ("stands", answers[0]["state_hash"])
    }


def run(*words: str, cwd: Path | None = None, **where: str | None) -> tuple[int, str, str]:
    """Run it in an environment with some names changed, or gone where they are None."""
    given = {**os.environ, **where}
    kept = {name: value for name, value in given.items() if value is not None}
    done = subprocess.run(
        [*PROGRAM, *words], capture_output=True, env=kept, cwd=cwd, check=False
    )
    return done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode()


@pytest.mark.parametrize(
    "words",
    [pytest.param(QUESTION, marks=LONG), ("render", "semicircle", "--out", "x.svg")],
)
def test_surroundings_that_lack_something(words: tuple[str, ...], tmp_path: Path) -> None:
    """No home, nothing that is writable, the C locale."""
    gone = dict.fromkeys(("XDG_CACHE_HOME", "XDG_CONFIG_HOME", "USER"))
    where = {"TMPDIR": "/nowhere", "HOME": "/proc/nobody", "LC_ALL": "C", "LANG": "C"}
    plain = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    code, out, error = run(*words, cwd=tmp_path, **gone, **where, **plain)
    assert (code, error) == (0, "")
    assert out.startswith("STANDS" if words == QUESTION else "wrote x.svg")


@pytest.mark.parametrize(
    "words",
    [QUESTION, *(pytest.param(each, marks=LONG) for each in (("--help",), ("doctor",)))],
)
def test_a_terminal_of_twenty_columns_in_the_c_locale(words: tuple[str, ...]) -> None:
    where = {"COLUMNS": "20", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    code, out, error = run(*words, **where)
    assert (code, error) == (0, "")
    assert out


@pytest.mark.parametrize(
    ("words", "closed"),
    [
        (FALLS, ">&- 2>&-"),
        *(
            pytest.param(words, closed, marks=LONG)
            for words, closed in (
                (FALLS, ">&-"),
                (FALLS, ">/dev/full"),
                (QUESTION, "2>&-"),
                (QUESTION, "<&-"),
                (("--help",), ">/dev/full"),
            )
        ),
    ],
)
def test_streams_that_are_closed_or_full(words: tuple[str, ...], closed: str) -> None:
    program = " ".join(PROGRAM)
    done = subprocess.run(
        ["/bin/sh", "-c", f"{program} {' '.join(words)} {closed}"],
        capture_output=True,
        check=False,
    )
    if closed == ">/dev/full":
        # What was to be said is lost, and that is said.
        assert done.returncode == 74
        assert done.stderr.count(b"\n") == 1
        assert b"No space left on device" in done.stderr
    else:
        assert done.returncode == (1 if words == FALLS else 0)
        assert done.stderr == b""
