"""One way to ask, whatever is asked about: an arch, a shipped structure, a file, a kind.

Oppenheim's arch bears 0.3705 of its weight sideways.
"""

from pathlib import Path

from blocksim import CircularArch, Wall, bracket, check, load, simulate

# Two blocks on the ground, as any file has them.
Path("stack.json").write_text(
    '{"friction": 0.6, "live": [{"body": [1, 0]}], "blocks": ['
    '{"id": "ground", "fixed": true, "vertices": [[-2, -1], [2, -1], [2, 0], [-2, 0]]},'
    '{"id": 1, "vertices": [[0, 0], [1, 0], [1, 2], [0, 2]]},'
    '{"id": 2, "vertices": [[0, 2], [1, 2], [1, 4], [0, 4]]}]}'
)
asked = {
    "arch": CircularArch(span=8, rise=3, thickness=0.45, voussoirs=31, friction=0.7),
    "oppenheim": load("oppenheim_7"),
    "file": load("stack.json"),
    "wall": Wall(friction=0.6),
}
tilts = {}
for name, each in asked.items():
    tilts[name] = bracket(each, over="tilt").limit
    print(f"{name}: {check(each).verdict}, falls when tilted by {tilts[name]:.4g} deg")
    check(each).plot().savefig(f"{name}.png", dpi=70)

falling = load("stack.json").tilted(0.3)
simulate(falling, method="direct").save("fall.npz")

check(asked["arch"]).plot().savefig("one_way.png", dpi=70)
headline = bracket(asked["oppenheim"], over="load").limit
print(f"Oppenheim's arch bears {headline:.4f} of its weight sideways")
