"""Scenes in, answers out: what adapters in Python have in common.

An engine is a class with `NAME`, `VERSION`, `SETTINGS` (documented, best: words and numbers),
`DIMENSIONS`, and the methods `add(body)`, `push(body, force, lever)`, `step()` and `pose(body,
late)`. `python ENGINE.py SCENES ANSWERS.jsonl [best]` answers a folder of scenes.
"""

import json
import math
import sys
import time
from pathlib import Path


def answer(engine, scene, settings):
    """Return poses at the scene's times."""
    world = engine(scene, settings)
    moving = [world.add(body) for body in scene["bodies"]]
    moving = [each for each, body in zip(moving, scene["bodies"]) if not body["fixed"]]
    names = [body["name"] for body in scene["bodies"] if not body["fixed"]]
    pushes = [(moving[names.index(p["body"])], p["force"], p["point"]) for p in scene["pushes"]]
    arms = [arm(scene, push) for push in scene["pushes"]]
    found, steps = [], 0
    for until in scene["times"]:
        while steps < round(until / settings["step"]):
            for (body, force, _), lever in zip(pushes, arms):
                world.push(body, force, lever)
            world.step()
            steps += 1
        # The step nearest to that time; engines that tell velocities go on from there.
        late = until - steps * settings["step"]
        found.append([world.pose(body, late) for body in moving])
    return found


def arm(scene, push):
    """Return where a push acts, from its body's centre of mass."""
    body = next(each for each in scene["bodies"] if each["name"] == push["body"])
    return [at - centre for at, centre in zip(push["point"], body["centre"])]


def local(body, shape):
    """Return the corners of a shape about the centre of mass; a fixed body has it at 0."""
    centre = body.get("centre", [0.0] * len(shape[0]))
    return [[at - middle for at, middle in zip(corner, centre)] for corner in shape]


def prism(body, shape, depth=None):
    """Return the corners of a polygon's prism about the centre of mass, z out of the plane."""
    corners = local(body, shape)
    if len(corners[0]) == 3:
        return corners
    half = (depth or body["depth"]) / 2
    return [[x, y, z] for z in (-half, half) for x, y in corners]


def angle(quaternion):
    """Return the angle about z of a quaternion w, x, y, z."""
    w, _, _, z = quaternion
    return 2 * math.atan2(z, w)


def fits(poses):
    """Whether all numbers are such as may be written."""
    return all(abs(each) < 1e9 for frame in poses for pose in frame for each in pose)


def main(engine):
    """Answer a folder of scenes as the command line says."""
    folder, out, kind = (*sys.argv[1:], "documented")[:3]
    words, settings = engine.SETTINGS[kind]
    head = {"engine": engine.NAME, "version": engine.VERSION, "settings": f"{kind}: {words}"}
    with Path(out).open("w") as file:
        print(json.dumps({"format": "blocksim answers 1"} | head), file=file)
        for path in sorted(Path(folder).glob("*.json")):
            scene = json.loads(path.read_text())
            if scene["dimensions"] not in engine.DIMENSIONS:
                continue
            started = time.process_time()
            poses = answer(engine, scene, settings)
            line = {"scene": scene["name"], "seconds": round(time.process_time() - started, 4)}
            line |= {"poses": poses} if fits(poses) else {"verdict": "open"}
            print(json.dumps(line), file=file, flush=True)
