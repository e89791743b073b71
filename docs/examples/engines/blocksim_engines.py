"""blocksim's own methods, by the same files as all others and the public calls.

`python blocksim_engines.py SCENES ANSWERS.jsonl METHOD`: limit, direct, pymunk, pybullet or
mujoco; in space limit and direct. They decide whether blocks stand; scenes in time are left to
what moves.
"""

import json
import sys
import time
from pathlib import Path

from blocksim import __version__, check
from blocksim.kinds.files import load_structure

SAYS = {"stands": "stands", "collapses": "falls", "undecided": "open"}


def main(folder, out, method):
    """Answer the scenes of a folder that ask whether blocks stand."""
    head = {"engine": f"blocksim {method}", "version": __version__, "settings": "its own rule"}
    with Path(out).open("w") as file:
        print(json.dumps({"format": "blocksim answers 1"} | head), file=file)
        for path in sorted(Path(folder).glob("*.json")):
            scene = json.loads(path.read_text())
            if scene["question"] != "stands":
                continue
            started = time.perf_counter()
            said = SAYS[check(load_structure(path), method=method).verdict.value]
            line = {"scene": scene["name"], "verdict": said}
            line["seconds"] = round(time.perf_counter() - started, 4)
            print(json.dumps(line), file=file, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
