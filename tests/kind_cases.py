"""Structures of the corpus as kinds make them: parameters that give the same blocks."""

import json
from pathlib import Path
from typing import Any

import blocksim
from blocksim import Maker, SolidMaker

_KNOWN: dict[str, Any] = json.loads(
    (Path(__file__).parent / "structures" / "kinds.json").read_text(encoding="utf-8")
)
LEAST = _KNOWN["LEAST"]
"""Of which the least thickness is known: all but the thickness."""
CATENARY = _KNOWN["CATENARY"]
PIERS = _KNOWN["PIERS"]
"""Of which the least width of the piers is known."""
FACTORS = _KNOWN["FACTORS"]
"""Of which a load factor is known, with their loads."""
STACKS = _KNOWN["STACKS"]
"""That are known to stand or to fall."""
_PUBLIC = [getattr(blocksim, name) for name in blocksim.__all__]
KINDS: dict[str, Any] = {
    each.name: each
    for each in _PUBLIC
    if isinstance(each, type)
    and issubclass(each, Maker | SolidMaker)
    and each not in (Maker, SolidMaker)
}
"""Makers of all kinds, by the names that files call them."""
PLANAR = sorted(name for name, kind in KINDS.items() if not kind.in_space)
