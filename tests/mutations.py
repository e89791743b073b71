"""Wrong lines that the tests must see: each is put into a copy, and the tests beside it run.

    python tests/mutations.py             all, about a quarter of an hour on 2 cores
    python tests/mutations.py legend      those whose name has that word

Tests marked `long` are left out, as in the usual run. A line that is no longer there is an
error: put another in its place.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent


class Mutation(NamedTuple):
    """A line, what is put in its place, and the tests that must fail."""

    name: str
    file: str
    line: str
    wrong: str
    tests: str


LISTED = Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
MUTATIONS = [Mutation(**row) for row in json.loads(LISTED)]


def caught(mutation: Mutation, copy: Path) -> bool:
    """Put a wrong line into the copy, run the tests, and put the right one back."""
    file = copy / "blocksim" / mutation.file
    right = file.read_text(encoding="utf-8")
    if right.count(mutation.line) != 1:
        raise SystemExit(f"{mutation.file}: not once there: {mutation.line!r}")
    file.write_text(right.replace(mutation.line, mutation.wrong), encoding="utf-8")
    tests = [f"tests/{each}" for each in mutation.tests.split()]
    run = [sys.executable, "-m", "pytest", "-n", "0", "-x", *tests]
    # Those of the copy, not of an installed blocksim; what is compiled is kept beside it.
    where = {**os.environ, "PYTHONPATH": str(copy)}
    where.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run(run, cwd=copy, env=where, capture_output=True, check=False)
    file.write_text(right, encoding="utf-8")
    if done.returncode not in {0, 1}:
        raise SystemExit(done.stdout.decode())
    return done.returncode == 1


def main(word: str = "") -> int:
    """Try all whose name has a word, and return how many survived."""
    survived = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "blocksim"
        left = shutil.ignore_patterns(".*", "__pycache__", "out")
        shutil.copytree(ROOT, copy, ignore=left)
        for mutation in MUTATIONS:
            if word in mutation.name:
                seen = caught(mutation, copy)
                survived += not seen
                sys.stdout.write(f"{'caught' if seen else 'SURVIVED'}: {mutation.name}\n")
                sys.stdout.flush()
    return survived


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
