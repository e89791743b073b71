"""Pages do what they say: commands run and print what is shown, tables and numbers hold."""

import doctest
import importlib
import json
import re
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import matplotlib.image
import numpy as np
import pytest
from running import COMMANDS, ENGINES, inside, parameters, ran

from blocksim import __version__, cite

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
EVERY = [*PAGES, *sorted({*ROOT.glob("*.md")} - {*PAGES}), *sorted(ROOT.glob("analysis/*.md"))]
FENCE = re.compile(
    r"^(?:<!-- (?P<note>[^>\n]*) -->\n)?```(?P<about>[^\n]*)\n(?P<text>.*?)^```$",
    flags=re.MULTILINE | re.DOTALL,
)
ELSEWHERE = "other machines"
SAYS_NO = {"check", "report", "validate"}
"""Commands that end with 1 or 3 where something falls, is undecided or differs."""
OTHERS = re.compile(r"python3 -m venv |(BLOCKSIM_\w+=\S+ )?\.venv/bin/(?!blocksim)\w+")
"""Commands of others, in what is said of setting up: the README's are those of `.ci/run`."""
LINK = re.compile(r"\]\(([^)\s:#]+)(?:#[^)]*)?\)")


@dataclass(frozen=True)
class Fence:
    """A block of code in a page: its language, the file it is, and the comment above it."""

    language: str
    title: str
    note: str
    text: str

    @property
    def commands(self) -> list[tuple[str, list[str]]]:
        """Each command of blocksim, with the lines it is said to print."""
        found: list[tuple[str, list[str]]] = []
        for line in self.text.splitlines():
            start = re.match(r"(?:\$ )?(?:\.venv/bin/)?blocksim (.*)", line)
            if start and (line.startswith("$") or self.language == "sh"):
                found.append((start[1].partition(" #")[0].strip(), []))
            elif self.language == "console" and found:
                found[-1][1].append(line)
        return found


def module(name: str) -> ModuleType:
    """Import a script of docs/, which is no package."""
    sys.path.insert(0, str(DOCS))
    try:
        return __import__(name)
    finally:
        sys.path.remove(str(DOCS))


def fences(page: Path) -> Iterator[Fence]:
    yield from fences_of(page.read_text(encoding="utf-8"))


def fences_of(text: str) -> Iterator[Fence]:
    for found in FENCE.finditer(text):
        language, _, rest = found["about"].partition(" ")
        title = re.search(r'title="([^"]+)"', rest)
        note = found["note"] or ""
        yield Fence(language, title[1] if title else "", note, found["text"])


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


ASKING = [page for page in PAGES if any(each.commands for each in fences(page))]
LONG = [page for page in ASKING if any(each.note == "long" for each in fences(page))]


def missing(shown: list[str], printed: str) -> str | None:
    """Return the first line shown that was not printed; `...` is what is left out."""

    def same(text: str) -> str:
        return re.sub(r", [\d.]+ s\)", ", time)", text).rstrip()

    lines, at, skip = [same(line) for line in printed.splitlines()], 0, False
    for line in map(same, shown):
        if line.strip() == "...":
            skip = True
            continue
        whole = not line.endswith("...")
        start = line.removesuffix("...").rstrip()
        places = range(at, len(lines) if skip else min(at + 1, len(lines)))
        fits = (
            n for n in places if lines[n] == line or (not whole and lines[n].startswith(start))
        )
        at, skip = next(fits, -1) + 1, False
        if not at:
            return line
        # What is left out of a line goes on below it.
        while not whole and at < len(lines) and lines[at].startswith(10 * " "):
            at += 1
    return None if skip or not shown or at == len(lines) else f"more than {shown[-1]}"


def false_answers(path: Path) -> list[str]:
    """Return what `validate` found that is false: neither open, nor a mode beside a line."""
    told = json.loads(path.read_text(encoding="utf-8"))
    rows = told["rows"]
    assert len(rows) >= 75
    return [
        f"{row['structure']}: {row['miss']}"
        for row in rows
        if row["miss"]
        and not row["miss"].startswith("undecided")
        and not row["note"].startswith("on a line of the map")
    ]


def run(page: Path, *, long: bool) -> int:
    """Run a page in the current folder, in its order; return how many commands that were."""
    count = 0
    for fence in fences(page):
        if fence.note == ELSEWHERE or (fence.note == "long" and not long):
            continue
        if fence.title:
            Path(fence.title).write_text(fence.text, encoding="utf-8")
        if fence.language == "python" and page.name != "examples.md":
            exec(compile(fence.text, name_of(page), "exec"), {})  # noqa: S102
            count += 1
        for command, shown in fence.commands:
            ran = inside(*command.split())
            ends = {0, 1, 3} if command.split()[0] in SAYS_NO else {0}
            assert ran.returncode in ends, (command, ran.stdout, ran.stderr)
            if command.startswith("validate"):
                assert false_answers(Path("out/validate/validate.json")) == []
            assert missing(shown, ran.stdout) is None, (command, ran.stdout)
            count += 1
    return count


pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.mark.parametrize("page", ASKING, ids=name_of)
def test_commands_of_a_page_run_and_print_what_it_shows(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(page, long=False) > 0 or page in LONG


@pytest.mark.long
@pytest.mark.parametrize("page", LONG, ids=name_of)
def test_long_commands_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(page, long=True) > 0


def test_a_page_that_shows_what_is_not_printed_is_seen() -> None:
    printed = "STANDS  (limit, 0.3 s)\n  arch    alpha 90 deg, eta 0.1\n  mode    rrr\n"
    assert missing(["STANDS  (limit, 0.02 s)", "  ..."], printed) is None
    assert (
        missing(["STANDS  (limit, 0.02 s)", "  arch    alpha 90 deg, ...", "..."], printed)
        is None
    )
    assert missing(["COLLAPSES  (limit, 0.02 s)", "  ..."], printed) is not None
    assert missing(["STANDS  (limit, 0.02 s)", "  mode    rrr"], printed) is not None
    assert missing(["STANDS  (limit, 0.02 s)", "..."], printed) is None
    assert missing(["STANDS  (limit, 0.02 s)"], printed) is not None


def escaping(text: str) -> list[str]:
    """Return what a page shows as code or as a command that `run` would pass over."""
    found = list[str]()
    for fence in fences_of(text):
        lines = [line for line in fence.text.splitlines() if line and line[0] != "#"]
        if fence.language in {"json", "toml"}:
            (json if fence.language == "json" else tomllib).loads(fence.text)
        elif fence.language == "sh" and fence.note != ELSEWHERE:
            found += [
                line
                for line in lines
                if line.endswith("\\")
                or not (OTHERS.match(line) or re.match(r"(\.venv/bin/)?blocksim ", line))
            ]
        elif fence.language == "console":
            found += [line for line in lines if line[0] == "$" and line[:11] != "$ blocksim "]
            found += [] if lines[0][0] == "$" else lines[:1]
        elif fence.language not in {"python", "csv", "sh"} or (
            fence.language == "csv" and not fence.title
        ):
            found.append(f"```{fence.language}")
    rest = FENCE.sub("", text)
    outside = r"^\s*(?:```|~~~).*|^(?: {4}|\t)\s*(?:\$ |blocksim ).*"
    found += re.findall(outside, rest, flags=re.MULTILINE)
    return found + [
        code for code in re.findall(r"`([^`]+)`", rest) if not known(" ".join(code.split()))
    ]


def known(code: str) -> bool:
    """Tell whether a command named within a sentence exists, with its options."""
    two = "|".join(name for name in COMMANDS if " " in name)
    asked = re.match(rf"(?:\$ )?(?:\.venv/bin/)?blocksim ({two}|[a-z]\S*)(.*)", code)
    if not asked:
        return True
    if asked[1] not in COMMANDS:
        return False
    options = {name for each in parameters(asked[1]) for name in each.opts}
    return {*re.findall(r"(?<=\s)--[a-z-]+", asked[2])} <= options


@pytest.mark.parametrize("page", EVERY, ids=name_of)
def test_no_command_of_a_page_escapes(page: Path) -> None:
    assert escaping(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "text",
    [
        "```bash\nblocksim check semicircle\n```\n",
        "```\nblocksim check semicircle\n```\n",
        "- item\n\n  ```sh\n  blocksim check semicircle\n  ```\n",
        "~~~sh\nblocksim check semicircle\n~~~\n",
        "So:\n\n    blocksim check semicircle\n\n",
        "```sh\nblocksim check semicircle \\\n  --json\n```\n",
        "```sh\ncd out && blocksim check semicircle\n```\n",
        "```console\nblocksim check semicircle\nSTANDS\n```\n",
        "```console\n$ pip install blocksim\n```\n",
        "Then `blocksim chekc semicircle` tells.\n",
        "Then `blocksim check semicircle --thin` tells.\n",
    ],
)
def test_a_command_that_would_escape_is_seen(text: str) -> None:
    assert escaping(text)


def test_the_readme_is_short_and_has_the_commands() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 133
    blocks = [each.text for each in fences(ROOT / "README.md") if each.language == "sh"]
    # `.ci/run` runs the second one.
    assert ".venv/bin/blocksim validate --quick" in blocks[0]
    assert ".venv/bin/pytest" in blocks[1]
    assert len([each for each in fences(ROOT / "README.md") if each.language == "console"]) == 5


@pytest.mark.parametrize("page", [*PAGES, *ROOT.glob("*.md")], ids=name_of)
def test_links_of_a_page_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    targets = LINK.findall(text)
    assert [target for target in targets if not (page.parent / target).exists()] == []


TABLES = sorted(
    {
        name
        for page in PAGES
        for name in re.findall(r"<!-- table: ([\w ]+) -->", page.read_text(encoding="utf-8"))
    }
)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.long] if name == "validated structures" else [])
        for name in TABLES
    ],
)
def test_tables_in_pages_are_as_code_and_rows_say(name: str) -> None:
    made = f"<!-- table: {name} -->\n{module('tables').made(name)}\n<!-- end -->"
    pages = [page for page in PAGES if f"<!-- table: {name} -->" in page.read_text("utf-8")]
    assert [name_of(page) for page in pages if made not in page.read_text("utf-8")] == []


@pytest.mark.parametrize("which", ["structure", "design"])
def test_every_key_of_a_file_is_described(which: str) -> None:
    table = module("tables").made(f"format {which}")
    rows = re.findall(r"^\| (`\w+`)(?: .*)? \| ([^|]*) \|$", table, flags=re.MULTILINE)
    assert len(rows) > 10
    assert [name for name, said in rows if not said.strip()] == []


def test_numbers_quoted_are_those_of_the_rows() -> None:
    quotes = module("quotes")
    texts = [page.read_text(encoding="utf-8") for page in quotes.pages()]
    found = [quote for text in texts for quote in quotes.quotes(text)]
    comments = sum(len(re.findall(r"<!-- (?!table|file)\w+: ", text)) for text in texts)
    assert len(found) == comments >= 36
    assert [quote for quote in found if not quote.holds] == []


def test_a_number_that_the_rows_do_not_say_is_seen() -> None:
    quotes = module("quotes")
    (right,) = quotes.quotes("0.26<!-- rubble_pymunk: largest(rise) -->")
    (wrong,) = quotes.quotes("0.28<!-- rubble_pymunk: largest(rise) -->")
    (whole,) = quotes.quotes("10,001<!-- random_truth: len(index) -->")
    assert right.holds
    assert not wrong.holds
    assert not whole.holds


PUBLISHED = {
    # Cocchetti and Rizzi (2020), Table 3; half of its weight, 22 times half the area between
    # circles through the clear span of 8 m and rise of 3 m; Ferris and Tin-Loi (2001); atan of
    # 0.3 over 0.75; Cocchetti and Rizzi (2024), Fig. 17 and Table 1; Housner's equation; the
    # problem of Ochsendorf (2006), solved independently.
    "least_thickness": pytest.approx(0.107426, abs=5e-7),
    "engineers_arch": pytest.approx(
        22 * np.arctan2(4, 4**2 / 6 - 1.5) * ((25 / 6 + 0.45) ** 2 - (25 / 6) ** 2) / 2,
        rel=1e-9,
    ),
    "one_way": pytest.approx(0.3705, abs=5e-5),
    # The centre of a trapezoid, 4 m high, 1 m and 0.5 m wide, is 16/9 m above its base.
    "own_maker": pytest.approx(np.degrees(np.arctan(0.5 / (16 / 9))), rel=0.005),
    "tilted_wall": pytest.approx(0.40369, abs=1e-5),
    "drawing": pytest.approx(np.degrees(np.arctan(0.4)), rel=1e-3),
    "sweep_to_table": pytest.approx(0.4208869, abs=5e-8),
    "own_points": pytest.approx((1.415270827756886, 0.679604732098886), rel=1e-12),
    "spreading_supports": pytest.approx(5.393, abs=5e-4),
    "compare_engines": pytest.approx(0.0, abs=1e-3),
    "reduce": pytest.approx(0.107426, rel=5e-4),
    # One of the joints beside the hinge of the continuous arch, 54.5 degrees.
    "collapse_film": pytest.approx(50.0),
}
SLOW = {"collapse_film", "one_way", "shaking", "spreading_supports"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(path.stem, marks=[pytest.mark.long] if path.stem in SLOW else [])
        for path in sorted((DOCS / "examples").glob("*.py"))
        # That one is no script: `test_own_engine` asks it.
        if path.stem != "own_engine"
    ],
)
def test_examples_find_what_is_known_and_draw_their_picture(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    script = DOCS / "examples" / f"{name}.py"
    assert 20 <= len(script.read_text(encoding="utf-8").splitlines()) <= 45
    found = runpy.run_path(str(script), run_name="__main__")["headline"]
    if name == "shaking":
        assert found[0] < 0.367707743061444 < found[1]
    else:
        assert found == PUBLISHED[name]
    drawn, kept = (
        matplotlib.image.imread(folder / f"{name}.png")[:, :, :3]
        for folder in (tmp_path, DOCS / "examples")
    )
    assert drawn.shape == kept.shape
    assert (np.abs(drawn - kept).max(axis=2) > 0.25).mean() < 0.01
    assert (kept.std(axis=(0, 1)) > 0.02).any()
    assert (DOCS / "examples" / f"{name}.png").stat().st_size < 100_000


def test_references_are_of_what_a_method_rests_on() -> None:
    def keys(*methods: str) -> list[str]:
        return [re.match(r"@\w+\{(\w+),", each)[1] for each in cite(*methods).split("\n\n")]  # type: ignore[index]

    assert keys() == ["blocksim", "CocchettiRizzi2024"]
    assert {"Moreau1988", "AlartCurnier1991", "Jean1999"} < {*keys("direct")}
    assert {"Mehrotra1992", "DeSaxceFeng1998", "Acary2024", "Lemke1965"} < {*keys("direct")}
    assert keys("mujoco") == [*keys(), "Todorov2012"]
    methods = ("theory", "limit", *ENGINES)
    every = keys(*methods)
    assert len(every) == len({*every})
    for method in methods:
        assert len(keys(method)) > 2, method
    printed = ran("cite", "--method", "pymunk")
    assert [*keys("all")] == every
    balance = [entry.count("{") - entry.count("}") for entry in cite("all").split("\n\n")]
    assert balance == [0] * len(every)
    assert printed.count("@") == len(keys("pymunk"))
    assert printed == cite("pymunk") + "\n"


def test_help_and_version_are_where_they_are_looked_for() -> None:
    assert inside("-h").stdout == inside("--help").stdout
    program = str(Path(sys.executable).with_name("blocksim"))
    said = subprocess.run([program, "--version"], capture_output=True, check=False).stdout
    assert said.decode().split() == ["blocksim", __version__]
    pages = (DOCS / "guide" / "commands.md").read_text(encoding="utf-8")
    assert all(f"\n## {name}\n" in pages for name in ("check", "bracket", "sweep", "cite"))


WITH_EXAMPLES = [
    path
    for path in sorted((ROOT / "blocksim").rglob("*.py"))
    if "    >>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("path", WITH_EXAMPLES, ids=name_of)
def test_examples_of_docstrings_say_what_comes_of_them(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # for what they write
    place = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    module = importlib.import_module(place.removesuffix(".__init__"))
    done = doctest.testmod(module)
    assert done.attempted
    assert done.failed == 0
