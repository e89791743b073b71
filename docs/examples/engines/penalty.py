"""An engine of penalty springs, in numpy: written from the page on scenes alone.

`python penalty.py SCENES ANSWERS.jsonl` answers the planar scenes in a folder.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

STIFFNESS, SLIP, STEP, NEAR = 3e8, 1e-3, 2e-4, 1e-4  # N/m, m/s, s, m


def turned(vectors, angles):
    """Return vectors, each turned by its angle."""
    (x, y), cos, sin = vectors.T, np.cos(angles), np.sin(angles)
    return np.stack([cos * x - sin * y, sin * x + cos * y], 1)


def answer(scene):
    """Return poses at the scene's times."""
    bodies, starts = scene["bodies"], [0]
    shapes = [(at, shape) for at, each in enumerate(bodies) for shape in each["polygons"]]
    for _, shape in shapes:
        starts.append(starts[-1] + len(shape))
    # All corners in one array: whose they are, and which comes next around.
    body = np.repeat([at for at, _ in shapes], np.diff(starts))
    polygon = np.repeat(np.arange(len(shapes)), np.diff(starts))
    following = np.arange(1, starts[-1] + 1)
    following[np.array(starts[1:]) - 1] = starts[:-1]
    starts, fixed = starts[:-1], np.array([each["fixed"] for each in bodies])
    apart = (body[:, None] == body) | (fixed[body][:, None] & fixed[body])
    mass = np.array([[each.get(key, np.inf) for key in ("mass", "inertia")] for each in bodies])
    mass = mass[:, [0, 0, 1]]
    pose = np.array([[*each.get("centre", (0, 0)), 0.0] for each in bodies])
    speed = np.array(
        [[*each.get("velocity", (0, 0)), each.get("spin", 0.0)] for each in bodies]
    )
    local = np.concatenate([shape for _, shape in shapes]) - pose[body, :2]
    damping = np.sqrt(STIFFNESS * mass[~fixed, 0].mean())
    pull = np.zeros_like(mass)
    pull[~fixed, :2] = mass[~fixed, :2] * scene["gravity"]
    place = {each["name"]: at for at, each in enumerate(bodies)}
    pushed = np.array([place[each["body"]] for each in scene["pushes"]], int)
    push = np.array([each["force"] for each in scene["pushes"]]).reshape(-1, 2)
    points = np.array([each["point"] for each in scene["pushes"]]).reshape(-1, 2)
    levers = points - pose[pushed, :2]
    found, now = [], 0
    for until in scene["times"]:
        while now < round(until / STEP):
            now += 1
            at = pose[body, :2] + turned(local, pose[body, 2])
            side = at[following] - at
            long = np.hypot(*side.T)
            along = side / long[:, None]
            out = np.stack([along[:, 1], -along[:, 0]], 1)
            # Two polygons meet at the side beyond which the other reaches least.
            beyond = at @ out.T - (at * out).sum(1)
            on = at @ along.T - (at * along).sum(1)
            reach = np.minimum.reduceat(beyond, starts, axis=0)
            gap = np.maximum.reduceat(reach, starts, axis=1)
            meets = (reach == gap[:, polygon]) & ((gap < 0) & (gap >= gap.T - NEAR))[:, polygon]
            inside = (beyond < 0) & (on > -NEAR) & (on < long + NEAR)
            i, j = np.nonzero(meets[polygon] & ~apart & inside)
            a, b = body[i], body[j]
            both = (a, at[i] - pose[a, :2], 1), (b, at[i] - pose[b, :2], -1)
            slip = sum(
                sign * (speed[own, :2] + speed[own, 2:] * np.stack([-arm[:, 1], arm[:, 0]], 1))
                for own, arm, sign in both
            )
            press = np.maximum(0, -STIFFNESS * beyond[i, j] - damping * (slip * out[j]).sum(1))
            rub = -scene["friction"] * press * np.clip((slip * along[j]).sum(1) / SLIP, -1, 1)
            force = press[:, None] * out[j] + rub[:, None] * along[j]
            total, acting = pull.copy(), [(own, arm, sign * force) for own, arm, sign in both]
            for own, arm, acts in (*acting, (pushed, turned(levers, pose[pushed, 2]), push)):
                moment = arm[:, 0] * acts[:, 1] - arm[:, 1] * acts[:, 0]
                np.add.at(total, own, np.column_stack([acts, moment]))
            speed += STEP * total / mass
            pose += STEP * speed
        found.append(pose[~fixed].tolist())
    return found


def main(folder, out):
    """Answer the scenes of a folder."""
    settings = f"{STIFFNESS:g} N/m, steps of {STEP:g} s"
    said = {"format": "blocksim answers 1", "engine": "penalty springs", "version": "2"}
    lines = [json.dumps(said | {"settings": settings})]
    for path in sorted(Path(folder).glob("*.json")):
        scene, started = json.loads(path.read_text()), time.perf_counter()
        if scene["dimensions"] == 2:
            line = {"scene": scene["name"], "poses": answer(scene)}
            lines.append(json.dumps(line | {"seconds": time.perf_counter() - started}))
    Path(out).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
