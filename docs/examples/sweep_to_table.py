"""A sweep to a table: least thickness over friction, for three half-angles.

The paper gives eta = 0.4208869 at 125 degrees and mu = 0.9 (Fig. 17).
"""

import csv
from concurrent.futures import ThreadPoolExecutor

import matplotlib.pyplot as plt

from blocksim import sweep, write_csv

asked = {
    "half_angle_deg": [90, 125, 140],
    "mu": {"low": 0.3, "high": 1.5, "steps": 121},
    "method": "theory",
}
with ThreadPoolExecutor(1) as executor:  # with processes, put it into a main()
    sweep(asked, "sweep", executor=executor)
write_csv("sweep", "sweep.csv")
with open("sweep.csv", newline="") as file:
    rows = [row for row in csv.DictReader(file) if row["eta_high"]]

figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
for angle in (90, 125, 140):
    own = [row for row in rows if float(row["half_angle_deg"]) == angle]
    points = sorted((float(row["mu"]), float(row["eta_high"])) for row in own)
    axes.plot(*zip(*points, strict=True), label=f"{angle} degrees")
axes.set(xlabel="friction coefficient", ylabel="least thickness over radius")
axes.legend()
figure.savefig("sweep_to_table.png", dpi=80)

headline = next(
    float(row["eta_high"])
    for row in rows
    if float(row["half_angle_deg"]) == 125 and abs(float(row["mu"]) - 0.9) < 1e-9
)
print(f"125 degrees, mu 0.9: {headline:.7f}")
