"""An engine of penalty springs in the plane, in numpy: written from the page on scenes alone.

`python penalty.py SCENES ANSWERS.jsonl` answers the planar scenes of a folder.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

STIFFNESS, SLIP, STEP, NEAR = 3e8, 1e-3, 2e-4, 1e-4  # N/m, m/s, s, m


def answer(scene):
    """Return poses at the scene's times; points and vectors are complex numbers."""
    bodies, x_y = scene["bodies"], np.array([1, 1j])
    fixed = np.array([each["fixed"] for each in bodies])
    mass = np.array([b.get("mass", np.inf) for b in bodies])
    inertia = np.array([b.get("inertia", np.inf) for b in bodies])
    place = np.array([b.get("centre", [0, 0]) for b in bodies]) @ x_y
    speed = np.array([b.get("velocity", [0, 0]) for b in bodies]) @ x_y
    spin = np.array([b.get("spin", 0.0) for b in bodies])
    angle, weight = np.zeros(len(bodies)), np.where(fixed, 0, mass) * (scene["gravity"] @ x_y)
    polygons = [np.array(shape) @ x_y for each in bodies for shape in each["polygons"]]
    polygon = np.repeat(np.arange(len(polygons)), [len(each) for each in polygons])
    first = np.unique(polygon, return_index=True)[1]
    owner = np.repeat(np.arange(len(bodies)), [sum(map(len, b["polygons"])) for b in bodies])
    sides = np.concatenate([np.roll(each, -1) - each for each in polygons])
    arms = np.concatenate(polygons) - place[owner]
    other = (owner[:, None] != owner) & ~(fixed[owner][:, None] & fixed[owner])
    names, pushes = [each["name"] for each in bodies], scene["pushes"]
    pushed = np.array([names.index(each["body"]) for each in pushes], int)
    push = np.array([each["force"] for each in pushes]).reshape(-1, 2) @ x_y
    lever = np.array([each["point"] for each in pushes]).reshape(-1, 2) @ x_y - place[pushed]
    damping, found = np.sqrt(STIFFNESS * mass[~fixed].mean()), []
    for steps in np.diff(np.rint(np.array(scene["times"]) / STEP).astype(int), prepend=0):
        for _ in range(steps):
            turn = np.exp(1j * angle)
            at, along = place[owner] + (turn[owner] * arms), turn[owner] * sides / abs(sides)
            # Each corner (rows) seen from each side: real along it, imaginary into its body.
            seen = (at[:, None] - at) * along.conj()
            # Two polygons meet at the side beyond which the other reaches least.
            reach = -np.maximum.reduceat(seen.imag, first, axis=0)
            gap = np.maximum.reduceat(reach, first, axis=1)
            meets = (reach == gap[:, polygon]) & ((gap < 0) & (gap >= gap.T - NEAR))[:, polygon]
            within = (seen.real > -NEAR) & (seen.real < abs(sides) + NEAR) & (seen.imag > 0)
            corner, side = np.nonzero(meets[polygon] & within & other)
            a, b, along = owner[corner], owner[side], along[side]
            arm_a, arm_b = at[corner] - place[a], at[corner] - place[b]
            slip = speed[a] - speed[b] + 1j * (spin[a] * arm_a - spin[b] * arm_b)
            slip = slip * along.conj()
            press = np.maximum(0, STIFFNESS * seen.imag[corner, side] + damping * slip.imag)
            force = (-scene["friction"] * np.clip(slip.real / SLIP, -1, 1) - 1j) * press * along
            total, moment = weight.copy(), np.zeros(len(bodies))
            acting = (a, force, arm_a), (b, -force, arm_b), (pushed, push, turn[pushed] * lever)
            for body, acts, arm in acting:
                np.add.at(total, body, acts)
                np.add.at(moment, body, (arm.conj() * acts).imag)
            speed, spin = speed + STEP * total / mass, spin + STEP * moment / inertia
            place, angle = place + STEP * speed, angle + STEP * spin
        found.append(np.column_stack([place.real, place.imag, angle])[~fixed].tolist())
    return found


head = {"format": "blocksim answers 1", "engine": "penalty springs", "version": "3"}
with Path(sys.argv[2]).open("w") as file:
    print(json.dumps(head | {"settings": f"{STIFFNESS:g} N/m, steps of {STEP:g} s"}), file=file)
    for path in sorted(Path(sys.argv[1]).glob("*.json")):
        scene, started = json.loads(path.read_text()), time.perf_counter()
        if scene["dimensions"] == 2:
            line = {"scene": scene["name"], "poses": answer(scene)}
            print(json.dumps(line | {"seconds": time.perf_counter() - started}), file=file)
