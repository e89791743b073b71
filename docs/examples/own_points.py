"""A map with points of your own: three bridges on the exact map.

The map's Triple point, where four modes meet, is at mu = 1.415271, eta = 0.679605 (the paper's
Table 1). Arches to the right of the lines fall by turning only.
"""

from math import radians

from blocksim import theory
from blocksim.view.mapfigure import map_figure

BRIDGES = {"a": (100, 0.75), "b": (125, 0.9), "c": (140, 1.6)}  # half-angle, friction

figure = map_figure(title="Least thickness of three arches")
axes = figure.axes[0]
for name, (angle, mu) in BRIDGES.items():
    least = theory.least_thickness(radians(angle), mu)
    print(f"{name}: {angle} degrees, mu {mu}: eta {least.eta:.4f}, mode {least.mode}")
    axes.plot(mu, least.eta, "o", color="white", mec="black", ms=9, zorder=9)
    axes.annotate(name, (mu, least.eta), xytext=(7, -12), textcoords="offset points", zorder=9)
triple = theory.landmarks()["T"]
axes.plot(triple.mu, triple.eta, "*", color="black", ms=13, zorder=9)
figure.savefig("own_points.png", dpi=80)

headline = (triple.mu, triple.eta)
