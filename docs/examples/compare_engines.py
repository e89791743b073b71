"""Which engine is right? One arch, bracketed by each, against the exact value.

The arch of 11 voussoirs as built is exact by limit analysis; the continuous one has 0.107426.
"""

import matplotlib.pyplot as plt

from blocksim import CircularArch, bracket

ENGINES = ("direct", "pymunk")  # and "pybullet", "mujoco", which take longer
ARCH = CircularArch(half_angle_deg=90, voussoirs=11, weight="centreline", friction=0.7)

exact = bracket(ARCH, method="limit").arch.eta_high
figure, axes = plt.subplots(figsize=(6, 2.6), layout="constrained")
errors = {}
for row, engine in enumerate(ENGINES):
    found = bracket(ARCH, method=engine, tol=0.002).arch
    errors[engine] = (found.eta_low + found.eta_high) / 2 / exact - 1
    print(f"{engine}: between {found.eta_low:.6f} and {found.eta_high:.6f}")
    axes.plot([found.eta_low, found.eta_high], [row, row], lw=8, solid_capstyle="butt")
axes.axvline(exact, color="0.3", ls="--")
axes.set_xticks([found.eta_low, exact, found.eta_high])
axes.set_yticks(range(len(ENGINES)), ENGINES)
axes.set(xlabel="least thickness over radius: fell below, stood above", ylim=(-0.6, 1.6))
figure.savefig("compare_engines.png", dpi=80)

headline = max(abs(error) for error in errors.values())
print(f"largest error: {100 * headline:.3f} %")
