"""A block on ground that moves off with 0.5 g: how long a pulse does it survive?

Housner's equation of a rocking block (1963) says: one of 1 by 4 m is overturned if the pulse
lasts 0.3677 s.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from blocksim import check, load_structure

block = load_structure("pulse_1x4_05")
lengths = np.array([0.33, 0.355, 0.38])
falls, turned = [], []
for seconds in lengths:
    shaken = replace(block, shaking=replace(block.shaking, duration=seconds))
    answer = check(shaken, method="pymunk")
    falls.append(answer.verdict == "collapses")
    turned.append(answer.shaken.rocking.rotation)
    print(f"{seconds:.3f} s: {answer.verdict}")

figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
axes.bar([f"{each:g} s" for each in lengths], np.degrees(turned), color="#b5522b")
axes.axhline(np.degrees(np.arctan(0.25)), color="0.5", ls="--", label="balanced on its corner")
axes.set(xlabel="length of the pulse", ylabel="largest rotation, degrees")
axes.legend()
figure.savefig("shaking.png", dpi=80)

first = falls.index(True)
headline = (lengths[first - 1], lengths[first])
print("overturned between", *headline, "s")
