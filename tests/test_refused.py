"""Wrong input: one line that says what is wrong, exit code 2, and nothing left behind.

Each row of `refused.json` is a command, the files it finds, and what its line has to say.
"""

import json
import shlex
from pathlib import Path
from typing import Any

import pytest
from running import refused

REFUSED = json.loads(Path(__file__).with_name("refused.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("row", REFUSED, ids=[each["said"] for each in REFUSED])
def test_what_cannot_be_is_told_in_one_line(row: dict[str, Any], tmp_path: Path) -> None:
    for name, text in row.get("files", {}).items():
        written = text if isinstance(text, str) else json.dumps(text)
        (tmp_path / name).write_text(written, encoding="utf-8", errors="surrogateescape")
    said = refused(*shlex.split(row["asked"]), cwd=tmp_path)
    assert row["said"] in said
    assert len(said) <= len("blocksim: ") + 700 + 1
    assert {path.name for path in tmp_path.iterdir()} == set(row.get("files", {}))
