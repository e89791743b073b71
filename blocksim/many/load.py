"""Design files: of symmetric circular arches, or of the kind of structure they name."""

from __future__ import annotations

from blocksim.common.errors import InputError
from blocksim.common.files import AnyPath, read_file, toml_of
from blocksim.many.design import Design, load_arch_design
from blocksim.many.kinddesign import KindDesign, load_kind_design

LARGEST_PEEK = 1 << 20
"""Bytes of a file that are looked at for its kind."""


def load_design(path: AnyPath) -> Design | KindDesign:
    """Read a design.

    Parameters
    ----------
    path : Path
        TOML file with the fields of `Design`; with `kind`, those of `KindDesign`.

    Raises
    ------
    InputError
        In one line, with file, field, value and what is allowed.
    """
    try:
        table = toml_of(read_file(path, "design", "an existing .toml file", LARGEST_PEEK))
    except (InputError, ValueError):
        table = {}  # the reader of designs says what is wrong with it
    return load_kind_design(path, table) if "kind" in table else load_arch_design(path)
