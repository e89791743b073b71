"""Check a proof that blocks stand or fall: `python verify.py FILE`.

This needs the standard library alone, and shares no code with blocksim. All arithmetic is of
rational numbers, so nothing is rounded. A decimal in the file means the binary number next to
it (IEEE 754, 64 bits), a text "p/q" means that fraction.

The file has a `problem`, which is a structure file, a `claim`, and what proves it:

- "stands": `forces`. At each end of each joint a pair a, b: the force a n + b t on the block
  `b` of the joint, and its opposite on `a`. t leads from the first end to the second, and n is
  t turned by a right angle clockwise; a corner on a face has its `normal` n. Friction holds
  where a >= 0 and |b| <= friction a. All forces on each block, with its weight and loads, have
  to balance.
- "collapses": `rates`, the velocities x, y of the centre of each block and its rate of
  rotation. No joint may close at an end, and each has to open at least by the friction times
  its slip. The weights and loads have to do work. By virtual work no forces as above balance
  them then.

What may be left over is stated as `tolerance`, over the weight of the block: stands means that
the loads as given balance, or others that differ by no more; collapses means that neither do.
"""

from __future__ import annotations

import hashlib
import json
import sys
from fractions import Fraction
from typing import Any

FORMAT = "blocksim proof 1"
MOST = Fraction(1, 10**9)
"""Largest tolerance that is taken."""
BYTES = 10**9
"""Largest file that is read."""


def number(value: Any) -> Fraction:
    """Read a number, or the text of a fraction."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError(f"{value!r} is no number")
    return Fraction(value)


def vector(values: Any, size: int = 2) -> list[Fraction]:
    """Read so many numbers."""
    if not isinstance(values, list) or len(values) != size:
        raise ValueError(f"{values!r} must be {size} numbers")
    return [number(value) for value in values]


def cross(one: list[Fraction], other: list[Fraction]) -> Fraction:
    """Return the moment of a force about a point."""
    return one[0] * other[1] - one[1] * other[0]


def seal(table: dict[str, Any]) -> str:
    """Return the fingerprint of all but the fingerprint."""
    kept = {key: value for key, value in table.items() if key != "sha256"}
    text = json.dumps(kept, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def loads(problem: dict[str, Any], blocks: dict[str, Any]) -> dict[str, list[Fraction]]:
    """Sum weight and loads on each block: x, y, and the moment about its centre."""
    found = {name: [Fraction(0)] * 3 for name in blocks}
    for factor, key in ((Fraction(1), "dead"), (number(problem["load"]), "live")):
        for load in problem[key]:
            if "body" in load:
                on = [(str(name), number(blocks[str(name)]["weight"]))
                      for name in load.get("blocks", blocks)]  # fmt: skip
                force = vector(load["body"][:2])
            else:
                on, force = [(str(load["block"]), Fraction(1))], vector(load["force"])
            for name, times in on:
                x, y = (factor * times * each for each in force)
                moment = Fraction(0)
                if "point" in load:
                    centre = vector(blocks[name]["centre"])
                    arm = [p - c for p, c in zip(vector(load["point"]), centre, strict=True)]
                    moment = cross(arm, [x, y])
                found[name] = [a + b for a, b in zip(found[name], (x, y, moment), strict=True)]
    return found


def verify(table: dict[str, Any]) -> str:
    """Return what is proved; raise ValueError where it is not."""
    if table.get("format") != FORMAT:
        raise ValueError(f"the format is not {FORMAT!r}")
    if table.get("sha256") != seal(table):
        raise ValueError("the file was changed after it was written")
    problem, slack = table["problem"], number(table["tolerance"])
    if not 0 <= slack <= MOST:
        raise ValueError("the tolerance is too large")
    fixed = {str(each["id"]) for each in problem["blocks"] if each.get("fixed")}
    blocks = {str(each["id"]): each for each in problem["blocks"] if not each.get("fixed")}
    if len(fixed) + len(blocks) != len(problem["blocks"]) or not blocks:
        raise ValueError("blocks need names of their own, and one has to be free")
    centres = {name: vector(each["centre"]) for name, each in blocks.items()}
    pull = loads(problem, blocks)
    still = [Fraction(0)] * 3
    stands = table["claim"] == "stands"
    if not stands and table["claim"] != "collapses":
        raise ValueError("the claim is neither stands nor collapses")
    given = table["forces" if stands else "rates"]
    if len(given) != len(problem["joints"] if stands else blocks):
        raise ValueError("forces or rates are missing")
    rates = {} if stands else {name: vector(given[name], 3) for name in blocks}
    for at, joint in enumerate(problem["joints"]):
        sides, ends = (str(joint["a"]), str(joint["b"])), [vector(p) for p in joint["ends"]]
        if any(side not in blocks and side not in fixed for side in sides):
            raise ValueError(f"joint {at}: a block is missing")
        if len(ends) == 1:
            n = vector(joint["normal"])
            ends, t = ends * 2, [-n[1], n[0]]
        else:
            t = [q - p for p, q in zip(*ends, strict=True)]
            n = [t[1], -t[0]]
        mu = joint.get("friction", problem["friction"])
        mu = None if mu == "inf" else number(mu)
        if mu is not None and mu < 0:
            raise ValueError(f"joint {at}: friction below 0")
        for end, point in enumerate(ends):
            if stands:
                a, b = vector(given[at][end])
                if a < 0 or (mu is not None and abs(b) > mu * a):
                    raise ValueError(f"joint {at}: a force pulls, or exceeds friction")
                force = [a * p + b * q for p, q in zip(n, t, strict=True)]
                for side, sign in zip(sides, (-1, 1), strict=True):
                    if side in blocks:
                        arm = [p - c for p, c in zip(point, centres[side], strict=True)]
                        wrench = [*force, cross(arm, force)]
                        pull[side] = [
                            p + sign * w for p, w in zip(pull[side], wrench, strict=True)
                        ]
            else:
                way = [Fraction(0)] * 2
                for side, sign in zip(sides, (-1, 1), strict=True):
                    x, y, turn = rates.get(side, still)
                    c = centres.get(side, point)
                    way[0] += sign * (x - turn * (point[1] - c[1]))
                    way[1] += sign * (y + turn * (point[0] - c[0]))
                opens = way[0] * n[0] + way[1] * n[1]
                slips = abs(way[0] * t[0] + way[1] * t[1])
                if opens < 0 or (slips > 0 if mu is None else mu * slips > opens):
                    raise ValueError(f"joint {at}: it closes, or slips without opening")
    work = Fraction(0)
    for name, block in blocks.items():
        corners = [vector(p) for part in block["polygons"] for p in part]
        c, weight = centres[name], number(block["weight"])
        reach = max(abs(x - c[0]) + abs(y - c[1]) for x, y in corners)
        most = [slack * weight, slack * weight, slack * weight * reach]
        for left, allowed, rate in zip(pull[name], most, rates.get(name, still), strict=True):
            if stands and abs(left) > allowed:
                raise ValueError(f"block {name}: forces do not balance")
            work += left * rate - allowed * abs(rate)
    if not stands and work <= 0:
        raise ValueError("the loads do no work")
    exact = "" if slack else ", exactly"
    return f"proved: {table['claim']}{exact} ({len(blocks)} blocks, {len(problem['joints'])} joints)"


def main(path: str) -> str:
    """Check the proof in a file."""
    try:
        with open(path, encoding="utf-8") as file:
            return verify(json.loads(file.read(BYTES)))
    except (ValueError, TypeError, KeyError, LookupError, AttributeError, OverflowError,
            ZeroDivisionError, RecursionError) as error:  # fmt: skip
        raise ValueError(f"not proved: {error}") from error


if __name__ == "__main__":
    try:
        print(main(sys.argv[1]))  # noqa: T201
    except (ValueError, OSError) as problem:
        sys.exit(str(problem))
