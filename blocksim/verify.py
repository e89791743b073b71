"""Check a proof that blocks stand or fall: `python verify.py FILE`.

It needs the standard library alone, and shares no code with the rest. Arithmetic is rational: a
decimal means the binary number next to it (IEEE 754, 64 bits), a text "p/q" that fraction. A
file, or each of a list, has a `problem` (a structure file; z is 0 in the plane), a `claim`, and

- "stands": `forces`, a vector at each point of each joint, on its block `b`; the opposite acts
  on `a`. None pulls, or leaves the cone of friction. Forces, weight and loads have to balance.
- "collapses": `rates`, the velocity of the centre of each block, and its rotation. No point of
  a joint may close, and each has to open at least by the friction times its slip. Weights and
  loads have to do work. By virtual work no such forces balance them then.

The `normal` of a joint leads from `a` to `b`; without, it is the way between its two `ends`,
turned clockwise by a right angle. Loads may differ from those given by `tolerance`, over the
weight of each block: the forces are for some such loads; no forces balance any of them.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from fractions import Fraction
from operator import mul
from pathlib import Path
from typing import Any

FORMAT = "blocksim proof 2"
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


def vector(values: Any) -> Vector:
    """Read two or three numbers."""
    require(type(values) is list and len(values) in {2, 3}, f"{values!r} is no vector")
    return [*map(number, values), NOTHING][:3]


def minus(one: Vector, other: Vector) -> Vector:
    """Subtract vectors."""
    return [p - q for p, q in zip(one, other, strict=True)]


def cross(one: Vector, other: Vector) -> Vector:
    """Multiply vectors to a vector."""
    (a, b, c), (p, q, r) = one, other
    return [b * r - c * q, c * p - a * r, a * q - b * p]


def seal(table: dict[str, Any]) -> str:
    """Return the fingerprint of all but the fingerprint."""
    kept = {key: value for key, value in table.items() if key != "sha256"}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()


def plus(total: Vector, force: Vector, arm: Vector, times: Fraction | int = 1) -> Vector:
    """Add a force, so many times, and its moment about a point."""
    more = (*force, *cross(arm, force))
    return [one + times * other for one, other in zip(total, more, strict=True)]


def loads(problem: Any, blocks: Any, centres: dict[str, Vector]) -> dict[str, Vector]:
    """Sum weight and loads on each block: the force, and the moment about its centre."""
    found = {name: [NOTHING] * 6 for name in blocks}
    for factor, key in ((Fraction(1), "dead"), (number(problem["load"]), "live")):
        for load in problem[key]:
            whole, force = "body" in load, vector(load.get("body") or load["force"])
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
    stands, still, work = {"stands": True, "collapses": False}[claim], [NOTHING] * 6, NOTHING
    given = table["forces" if stands else "rates"]
    require(len(given) == len(problem["joints"] if stands else blocks) > 0, "some are missing")
    left = dict.fromkeys(fixed, still) | loads(problem, blocks, centres)
    rates = dict.fromkeys(left, still)
    rates |= {} if stands else {k: [*vector(given[k][0]), *vector(given[k][1])] for k in blocks}
    for at, joint in enumerate(problem["joints"]):
        sides = joint["b"], joint["a"]
        points = [vector(point) for point in joint["points" if "points" in joint else "ends"]]
        x, y, _ = minus(points[-1], points[0])
        n = vector(joint["normal"]) if "normal" in joint else [y, -x, NOTHING]
        mu = joint.get("friction", problem["friction"])
        p, q = (1, 0) if mu == "inf" else (number(mu), 1)
        require(any(n) and p >= 0, f"joint {at}: no normal, or friction below 0")
        # Forces lie in the cone of friction, and motions in its dual.
        p, q = (p, q) if stands else (q, p)
        for point, force in zip(points, given[at] if stands else points, strict=True):
            arms = {name: minus(point, centres.get(name, point)) for name in sides}
            b, a = (minus(rates[k][:3], cross(arms[k], rates[k][3:])) for k in sides)
            way = vector(force) if stands else minus(b, a)
            along, side = sum(map(mul, way, n)), cross(way, n)
            held = q**2 * sum(map(mul, side, side)) <= (p * along) ** 2
            require(along >= 0 and held, f"joint {at}: it pulls, closes, or exceeds friction")
            for name, sign in zip(sides, (1, -1), strict=True):
                left[name] = plus(left[name], way, arms[name], sign if stands else 0)
    for name, block in blocks.items():
        corners = block.get("polygons") or block.get("polyhedra") or [block["vertices"]]
        arms = [minus(vector(p), centres[name]) for part in corners for p in part]
        few = slack * max(number(block["weight"]), NOTHING)
        far = few * max(sum(map(abs, arm)) for arm in arms)
        for most, over, way in zip([few] * 3 + [far] * 3, left[name], rates[name], strict=True):
            require(not stands or abs(over) <= most, f"block {name}: forces do not balance")
            work += over * way - most * abs(way)
    require(stands or work > 0, "loads do no work")
    counts = f"{len(blocks)} blocks and {len(problem['joints'])} joints"
    return f"proved: {claim}, " + re.sub(r"\b1 (\w+)s", r"1 \1", counts)


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
