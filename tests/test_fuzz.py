"""Nothing that a stranger's file can do: no traceback, hang, abort, memory, or file left.

Briefly in every run. For longer, which prints how often each fault was seen:

    BLOCKSIM_FUZZ_MINUTES=20 pytest -n 0 -s -m long tests/test_fuzz.py

What breaks something is kept in `out/fuzz`; mended, it goes to `tests/corpus`, a folder each
with the files and `words.json`, the words of the command. Attacks begin there, too.
"""

import json
import os
import shutil
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from isolated import Ended, Nursery
from strangers import ATTACKS, Attack, corpus, good

ROOT = Path(__file__).parent.parent
CODES = {0, 1, 2, 3}
MINUTES = float(os.environ.get("BLOCKSIM_FUZZ_MINUTES", "0"))
"""For how long from a seed that nobody has tried; else one round from always the same."""
AT_ONCE = 40
"""Attacks of one kind before the next."""


@pytest.fixture(scope="module")
def nursery() -> Iterator[Nursery]:
    with Nursery(ROOT) as made:
        yield made


def faults(nursery: Nursery, attack: Attack, folder: Path) -> tuple[list[str], Ended]:
    """Run an attack in a new folder, and say what is wrong with what became of it."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, text in attack.files.items():
        (folder / name).write_bytes(text)
    ended = nursery.run(attack.words, folder)
    found = list(ended.faults)
    if ended.code >= 0 and ended.code not in CODES and "traceback" not in found:
        found.append("code")
    made = {path.name for path in folder.iterdir()} - set(attack.files)
    if ended.code == 2 and made - ({"o"} if attack.words[0] == "sweep" else set()):
        found.append("left")
    return found, ended


@pytest.mark.parametrize("name", corpus())
def test_what_broke_something_once(name: str, nursery: Nursery, tmp_path: Path) -> None:
    found, ended = faults(nursery, corpus()[name], tmp_path / "run")
    assert not found, ended


@pytest.mark.parametrize("name", good())
def test_what_is_spoilt_was_good(name: str, nursery: Nursery, tmp_path: Path) -> None:
    """Of a file that is refused as it is, nothing beyond that would ever be tried."""
    found, ended = faults(nursery, good()[name](), tmp_path / "run")
    assert not found
    assert ended.code in {0, 1, 3}, ended


@pytest.mark.parametrize("kind", ATTACKS)
def test_briefly(kind: str, nursery: Nursery, tmp_path: Path) -> None:
    health = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]

    @settings(max_examples=3, phases=[Phase.generate], suppress_health_check=health)
    @given(ATTACKS[kind]())
    def attacked(attack: Attack) -> None:
        found, ended = faults(nursery, attack, tmp_path / "run")
        assert not found, ended

    attacked()


@pytest.mark.long
def test_for_long(nursery: Nursery, tmp_path: Path) -> None:
    seen: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    end = time.monotonic() + 60 * MINUTES
    first = number = int(time.time()) if MINUTES else 0

    def one(kind: str, attack: Attack) -> None:
        if MINUTES and time.monotonic() > end:
            return
        found, ended = faults(nursery, attack, tmp_path / "run")
        tried[kind] += 1
        tried[f"exit code {ended.code}"] += 1
        seen.update(found)
        if found:
            keep(attack, found, ended)

    while number == first or time.monotonic() < end:
        for kind, attacks in ATTACKS.items():
            number += 1
            run = settings(
                max_examples=AT_ONCE,
                phases=[Phase.generate],
                suppress_health_check=list(HealthCheck),
                derandomize=False,
            )(given(st.just(kind), attacks())(one))
            seed(number)(run)()
    total = sum(tried[kind] for kind in ATTACKS)
    names = (
        "traceback", "hang", "memory", "abort", "killed", "left", "no line", "unprintable",
        "code",
    )  # fmt: skip
    told = ", ".join(f"{name} {seen[name]}" for name in names)
    print(f"\n{total} attacks in {MINUTES:g} min from seed {first}: {told}")  # noqa: T201
    print(", ".join(f"{name} {count}" for name, count in sorted(tried.items())))  # noqa: T201
    assert not seen


def keep(attack: Attack, found: list[str], ended: Ended) -> None:
    """Keep what broke something, to be looked at and tried again."""
    folder = ROOT / "out" / "fuzz" / f"{'-'.join(found)}-{time.time_ns()}"
    folder.mkdir(parents=True)
    for name, text in attack.files.items():
        (folder / name).write_bytes(text)
    (folder / "words.json").write_text(json.dumps(attack.words))
    (folder.parent / f"{folder.name}.txt").write_bytes(
        f"{ended.code} {ended.seconds:.1f} s {ended.memory >> 20} MB {ended.left}\n".encode()
        + ended.err[-5000:]
    )
