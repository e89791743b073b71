"""blocksim's own methods, by the same files as all others and the public calls.

`python blocksim_engines.py SCENES ANSWERS.jsonl METHOD`, one of limit, direct, pymunk, pybullet,
mujoco. They decide whether blocks stand; scenes in time are left to what moves.
"""

import json
import sys
import time
from pathlib import Path

from blocksim import __version__, check, structure_of

SAYS = {"stands": "stands", "collapses": "falls", "undecided": "open"}
G = 9.81


def structure(scene):
    """Return a scene as a structure file says it."""
    return {
        "friction": scene["friction"],
        "blocks": [
            {
                "id": body["name"],
                "polygons": body["polygons"],
                "fixed": body["fixed"],
                **({} if body["fixed"] else {"weight": body["mass"] * G, "centre": body["centre"]}),
            }
            for body in scene["bodies"]
        ],
        "dead": [{"body": [each / G for each in scene["gravity"]]}]
        + [
            {"block": push["body"], "force": push["force"], "point": push["point"]}
            for push in scene["pushes"]
        ],
    }


def main(folder, out, method):
    """Answer the planar scenes of a folder that ask whether blocks stand."""
    head = {"engine": f"blocksim {method}", "version": __version__, "settings": "its own rule"}
    with Path(out).open("w") as file:
        print(json.dumps({"format": "blocksim answers 1"} | head), file=file)
        for path in sorted(Path(folder).glob("*.json")):
            scene = json.loads(path.read_text())
            if scene["dimensions"] != 2 or scene["question"] != "stands":
                continue
            started = time.perf_counter()
            said = SAYS[check(structure_of(structure(scene)), method=method).verdict.value]
            line = {"scene": scene["name"], "verdict": said}
            line["seconds"] = round(time.perf_counter() - started, 4)
            print(json.dumps(line), file=file, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
