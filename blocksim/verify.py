"""Check a proof that blocks stand or fall: `python verify.py FILE`.

It needs the standard library alone, and shares no code with the rest. All arithmetic is of
rational numbers. A decimal means the binary number next to it (IEEE 754, 64 bits), a text "p/q"
that fraction. The file, or each of its list, has a `problem` (a structure file), a `claim`, and

- "stands": `forces`, a pair a, b at both ends of each joint: the force a n + b t on block `b`,
  and its opposite on block `a`. t leads from the first end to the second, n is t turned
  clockwise by a right angle; a corner on a face has its `normal` n. Friction holds where a >= 0
  and |b| <= friction a. Forces, weight and loads have to balance on each block.
- "collapses": `rates`, the velocity x, y of the centre of each block and its rate of rotation.
  No end of a joint may close, and each has to open at least by the friction times its slip.
  Weights and loads have to do work. By virtual work no such forces balance them then.

Loads may differ from those given by `tolerance`, over the weight of each block (0: not at all):
the forces are for some such loads; no forces balance any of them.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

FORMAT = "blocksim proof 1"
NOTHING = Fraction(0)
Vector = list[Fraction]


def require(holds: bool, words: str) -> None:
    """Refuse what does not hold."""
    if not holds:
        raise ValueError(words)


def number(value: Any) -> Fraction:
    """Read a number, or the text of a fraction."""
    plain = isinstance(value, str) and re.fullmatch(r"-?[0-9]+(/[0-9]+)?", value)
    require(bool(plain) or type(value) in {int, float}, f"{value!r} is no number")
    return Fraction(value)


def vector(values: Any, size: int = 2) -> Vector:
    """Read so many numbers."""
    require(type(values) is list and len(values) == size, f"{values!r} is no vector")
    return [number(value) for value in values]


def minus(one: Vector, other: Vector) -> Vector:
    """Subtract vectors."""
    return [one[0] - other[0], one[1] - other[1]]


def seal(table: dict[str, Any]) -> str:
    """Return the fingerprint of all but the fingerprint."""
    kept = {key: value for key, value in table.items() if key != "sha256"}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()


def plus(total: Vector, force: Vector, arm: Vector, times: Fraction | int = 1) -> Vector:
    """Add a force, so many times, and its moment about a point."""
    more = (*force, arm[0] * force[1] - arm[1] * force[0])
    return [one + times * other for one, other in zip(total, more, strict=True)]


def loads(problem: Any, blocks: Any, centres: dict[str, Vector]) -> dict[str, Vector]:
    """Sum weight and loads on each block: x, y, and the moment about its centre."""
    found = {name: [NOTHING] * 3 for name in blocks}
    for factor, key in ((Fraction(1), "dead"), (number(problem["load"]), "live")):
        for load in problem[key]:
            whole = "body" in load
            force = vector(load["body"][:2] if whole else load["force"])
            for name in load.get("blocks", blocks) if whole else [load["block"]]:
                times = factor * (number(blocks[name]["weight"]) if whole else 1)
                point = vector(load["point"]) if "point" in load else centres[name]
                found[name] = plus(found[name], force, minus(point, centres[name]), times)
    return found


def verify(table: Any) -> str:
    """Return what is proved; raise ValueError where it is not."""
    require(table["format"] == FORMAT, f"the format is not {FORMAT!r}")
    require(table["sha256"] == seal(table), "the file was changed after it was written")
    problem, slack, claim = table["problem"], number(table["tolerance"]), table["claim"]
    require(0 <= slack <= Fraction(1, 10**9), "the tolerance is out of range")
    fixed = {each["id"] for each in problem["blocks"] if each.get("fixed")}
    blocks = {each["id"]: each for each in problem["blocks"] if not each.get("fixed")}
    require(len(fixed) + len(blocks) == len(problem["blocks"]), "blocks share a name")
    centres = {name: vector(block["centre"]) for name, block in blocks.items()}
    left = loads(problem, blocks, centres)
    stands, still, work = {"stands": True, "collapses": False}[claim], [NOTHING] * 3, NOTHING
    given = table["forces" if stands else "rates"]
    require(len(given) == len(problem["joints"] if stands else blocks) > 0, "some are missing")
    rates = {} if stands else {name: vector(given[name], 3) for name in blocks}
    for at, joint in enumerate(problem["joints"]):
        before, after = joint["a"], joint["b"]
        require({before, after} <= fixed | blocks.keys(), f"joint {at}: a block is missing")
        ends = [vector(point) for point in joint["ends"]]
        t = minus(ends[1], ends[0]) if len(ends) == 2 else []
        n = [t[1], -t[0]] if t else vector(joint["normal"])
        t = t or [-n[1], n[0]]
        mu = joint.get("friction", problem["friction"])
        rough, mu = mu == "inf", NOTHING if mu == "inf" else number(mu)
        require(mu >= 0, f"joint {at}: friction is below 0")
        for point, force in zip((ends * 2)[:2], given[at] if stands else (0, 0), strict=True):
            arms = {name: minus(point, centres.get(name, point)) for name in (before, after)}
            if stands:
                a, b = vector(force)
                require(a >= 0, f"joint {at}: a force pulls")
                require(rough or abs(b) <= mu * a, f"joint {at}: a force exceeds friction")
                push = [a * n[0] + b * t[0], a * n[1] + b * t[1]]
                for name, sign in ((before, -1), (after, 1)):
                    left[name] = plus(left.get(name, still), push, arms[name], sign)
                continue
            moved = [(rates.get(name, still), arms[name]) for name in (after, before)]
            way = minus(*([x - turn * q, y + turn * p] for (x, y, turn), (p, q) in moved))
            opens, slips = (way[0] * each[0] + way[1] * each[1] for each in (n, t))
            lawful = mu * abs(slips) <= opens and not (rough and slips)
            require(lawful, f"joint {at}: it closes, or slips without opening")
    for name, block in blocks.items():
        arms = [minus(vector(p), centres[name]) for part in block["polygons"] for p in part]
        allowed = slack * number(block["weight"])
        far = allowed * max(abs(x) + abs(y) for x, y in arms)
        require(far >= 0, f"block {name}: its weight is below 0")
        for at, most in enumerate((allowed, allowed, far)):
            over, rate = left[name][at], rates.get(name, still)[at]
            require(not stands or abs(over) <= most, f"block {name}: forces do not balance")
            work += over * rate - most * abs(rate)
    require(stands or work > 0, "loads do no work")
    return f"proved: {claim}, {len(blocks)} blocks and {len(problem['joints'])} joints"


def checked(text: str) -> str:
    """Check the proof that a text is, or each of a list; raise ValueError where it is none."""
    try:
        one: Any = json.loads(text)
        return "\n".join(map(verify, one if text.strip()[0] == "[" else [one])) or verify(one)
    except Exception as error:  # whatever it is, nothing is proved
        raise ValueError(f"not proved: {error}") from error


if __name__ == "__main__":
    try:
        print(checked(Path(sys.argv[1]).read_text(encoding="utf-8")))  # noqa: T201
    except (ValueError, OSError) as problem:
        sys.exit(str(problem))
