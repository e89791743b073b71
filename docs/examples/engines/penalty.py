"""An engine of penalty springs, in numpy: written from the page on scenes alone.

`python penalty.py SCENES ANSWERS.jsonl` answers the planar scenes in a folder.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

STIFFNESS, DAMPING, SLIP, STEP = 3e8, 1.0, 1e-3, 2e-4  # N/m, of critical, m/s, s


def answer(scene):
    """Return poses at the scene's times."""
    bodies = sorted(scene["bodies"], key=lambda each: each["fixed"])
    count = sum(not each["fixed"] for each in bodies)
    shapes = [(at, np.array(s)) for at, each in enumerate(bodies) for s in each["polygons"]]
    most = max(len(shape) for _, shape in shapes)
    owner = np.array([at for at, _ in shapes])
    centre = np.array([each.get("centre", [0, 0]) for each in bodies], dtype=float)
    corners = np.array([shape[np.minimum(np.arange(most), len(shape) - 1)] for _, shape in shapes])
    arms = corners - centre[owner][:, None]
    following = np.array([np.append(shape[1:], np.repeat(shape[:1], most + 1 - len(shape), 0), 0)
                          for _, shape in shapes])
    side = following - corners
    length = np.hypot(*side.transpose(2, 0, 1))
    real = length > 0
    normals = np.stack([side[..., 1], -side[..., 0]], -1) / np.where(real, length, 1)[..., None]
    mass = np.array([each.get("mass", np.inf) for each in bodies])
    inverse = 1 / np.array([[m, m, each.get("inertia", np.inf)] for m, each in zip(mass, bodies)])
    pose = np.column_stack([centre, np.zeros(len(bodies))])
    speed = np.array([[*each.get("velocity", [0, 0]), each.get("spin", 0)] for each in bodies])
    pull = np.zeros((len(bodies), 3))
    pull[:count, :2] = mass[:count, None] * scene["gravity"]
    apart = (owner[:, None] == owner) | ((owner >= count)[:, None] & (owner >= count))
    damping = DAMPING * np.sqrt(STIFFNESS * mass[:count].mean())
    names = [each["name"] for each in bodies]
    pushes = [(names.index(p["body"]), np.array(p["force"]), np.array(p["point"])) for p in scene["pushes"]]
    found, now = [], 0
    for until in scene["times"]:
        for _ in range(round(until / STEP) - now):
            cos, sin = np.cos(pose[owner, 2]), np.sin(pose[owner, 2])
            turn = np.stack([np.stack([cos, -sin], -1), np.stack([sin, cos], -1)], -2)
            arm, out = np.einsum("sij,skj->ski", turn, arms), np.einsum("sij,skj->ski", turn, normals)
            at = pose[owner, None, :2] + arm
            # a's corner v beyond b's side e, with axes (a, b, v, e); the best side parts them most.
            beyond = np.einsum("avi,bei->abve", at, out) - np.einsum("bei,bei->be", at, out)[:, None]
            parted = np.where(real, beyond.min(2), -np.inf)
            best, gap = parted.argmax(-1), parted.max(-1)
            a, b = np.nonzero((gap < 0) & (gap >= gap.T - 1e-4) & ~apart)
            e = best[a, b]
            depth, normal = -beyond[a, b, :, e], out[b, e]
            along = np.stack([-normal[:, 1], normal[:, 0]], -1)
            offset = at[a] - at[b, e][:, None]
            on = np.einsum("pvi,pi->pv", offset, along)
            p, v = np.nonzero((depth > 0) & (on > -1e-4) & (on < length[b, e][:, None] + 1e-4))
            a, b, normal, along = owner[a[p]], owner[b[p]], normal[p], along[p]
            point = at[np.nonzero((gap < 0) & (gap >= gap.T - 1e-4) & ~apart)[0][p], v]
            arm_a, arm_b = point - pose[a, :2], point - pose[b, :2]
            slip = (speed[a, :2] - speed[b, :2] + speed[a, 2:] * np.stack([-arm_a[:, 1], arm_a[:, 0]], -1)
                    - speed[b, 2:] * np.stack([-arm_b[:, 1], arm_b[:, 0]], -1))
            press = np.maximum(0, STIFFNESS * depth[p, v] - damping * (slip * normal).sum(-1))
            rub = -scene["friction"] * press * np.clip((slip * along).sum(-1) / SLIP, -1, 1)
            force = press[:, None] * normal + rub[:, None] * along
            total = pull.copy()
            for body, push, where in pushes:
                c, s = np.cos(pose[body, 2]), np.sin(pose[body, 2])
                lever = np.array([[c, -s], [s, c]]) @ (where - centre[body])
                total[body] += [*push, lever[0] * push[1] - lever[1] * push[0]]
            for body, lever, sign in ((a, arm_a, 1), (b, arm_b, -1)):
                moment = lever[:, 0] * force[:, 1] - lever[:, 1] * force[:, 0]
                np.add.at(total, body, sign * np.column_stack([force, moment]))
            speed += STEP * total * inverse
            pose += STEP * speed
        now = round(until / STEP)
        found.append(pose[:count].tolist())
    return found


def main(folder, out):
    """Answer all scenes of a folder."""
    with Path(out).open("w") as file:
        said = {"format": "blocksim answers 1", "engine": "penalty springs", "version": "1",
                "settings": f"{STIFFNESS:g} N/m, steps of {STEP:g} s"}
        print(json.dumps(said), file=file)
        for path in sorted(Path(folder).glob("*.json")):
            scene, started = json.loads(path.read_text()), time.perf_counter()
            poses = answer(scene) if scene["dimensions"] == 2 else None
            line = {"scene": scene["name"], "seconds": round(time.perf_counter() - started, 4)}
            if poses is not None:
                print(json.dumps(line | {"poses": poses}), file=file, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
