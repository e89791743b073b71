"""The list of wrong lines that tests must see is of lines that are there."""

import pytest
from mutations import MUTATIONS, ROOT, Mutation


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_the_line_is_there_once_and_so_are_its_tests(mutation: Mutation) -> None:
    text = (ROOT / "blocksim" / mutation.file).read_text(encoding="utf-8")
    assert text.count(mutation.line) == 1
    assert all((ROOT / "tests" / each).is_file() for each in mutation.tests.split())
