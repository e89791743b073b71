"""How thin can a semicircle be, and how many voussoirs make it the continuous arch?

The continuous semicircle needs eta = 0.107426 (Cocchetti and Rizzi, 2020, Table 3).
"""

from math import radians

import matplotlib.pyplot as plt

from blocksim import CircularArch, bracket

HALF_ANGLE, MU = radians(90), 0.7

exact = bracket(
    CircularArch(half_angle=HALF_ANGLE, friction=MU, voussoirs=27, weight="centreline"),
    method="theory",
).arch.eta_high
counts = [5, 7, 9, 13, 19, 27, 39, 55, 101]
least = [
    bracket(
        CircularArch(half_angle=HALF_ANGLE, friction=MU, voussoirs=n, weight="centreline"),
        method="limit",
    ).arch.eta_high
    for n in counts
]

figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
axes.axhline(exact, color="0.5", ls="--", label="continuous arch")
axes.semilogx(counts, least, "o-", color="#b5522b", label="n voussoirs")
axes.set_xticks(counts, [str(n) for n in counts])
axes.minorticks_off()
axes.set(xlabel="number of voussoirs", ylabel="least thickness over radius")
axes.legend()
figure.savefig("least_thickness.png", dpi=80)

headline = exact
print(f"least thickness over radius: {headline:.6f}")
