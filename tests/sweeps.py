"""Designs that several tests sweep, and the rows that come of them."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from blocksim import Summary, load_design, read_rows, sweep

GRID = """
half_angle_deg = { low = 60, high = 150, steps = 4 }
mu = [0.5, 0.9, inf]
voussoirs = [9, 12]
eta = [0.05, 0.1]
weight = ["centreline", "sector"]
method = ["theory", "limit"]
"""
SIMULATED = """
half_angle_deg = { low = 60, high = 150 }
mu = { low = 0.4, high = 2, log = true }
voussoirs = { low = 7, high = 12 }
eta = { low = 0.05, high = 0.2 }
method = ["limit", "direct"]
[random]
count = 20
seed = 7
"""
Rows = dict[str, dict[str, object]]


def design_of(folder: Path, text: str) -> Any:
    path = folder / "design.toml"
    path.write_text(text)
    return load_design(path)


def swept(asked: Any, folder: Path, **how: Any) -> Summary:
    """Sweep a design, its table or its text, within this process."""
    design = design_of(folder, asked) if isinstance(asked, str) else asked
    with ThreadPoolExecutor(1) as executor:
        return sweep(design, folder, executor=executor, **how)


def rows_of(folder: Path) -> Rows:
    """Rows by identity without their times; none may be there twice."""
    rows = list(read_rows(folder))
    found = {str(row["id"]): {**row, "wall_s": None} for row in rows}
    assert len(found) == len(rows)
    return found


def written(folder: Path, text: str) -> tuple[str, ...]:
    """Write a design, and return how to ask for a sweep of it into `folder/out`."""
    design = folder / "design.toml"
    design.write_text(text)
    return "sweep", str(design), "--out", str(folder / "out")
