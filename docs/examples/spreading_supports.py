"""Supports that spread: by how much of its span may an arch grow?

An arch of 20 voussoirs and t/r = 0.15 falls when its span has grown by 5.393 %, by an
independent statics of hinges on the displaced arch (the problem of Ochsendorf, 2006).
"""

import matplotlib.pyplot as plt

from blocksim import bracket, structure_of

shares = {}
for ratio in (0.12, 0.15):
    arch = structure_of(
        {
            "kind": "circular-arch",
            "friction": "inf",
            "radius": 0.5,  # so that the span is 1 m
            "thickness": 0.5 * ratio,
            "voussoirs": 20,
        }
    )
    found = bracket(arch, over="spread", method="limit")
    shares[ratio] = 100 * found.limit
    print(f"t/r {ratio}: the span may grow by {shares[ratio]:.3f} %")

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.barh([f"t/r = {ratio}" for ratio in shares], list(shares.values()), color="#b5522b")
axes.set(xlabel="growth of the span at collapse, %")
figure.savefig("spreading_supports.png", dpi=80)

headline = shares[0.15]
