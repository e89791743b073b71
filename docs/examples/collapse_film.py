"""A film of a collapse: an arch of 9 voussoirs, 2 % thinner than it must be.

The exact map says that such a semicircle turns at hinges 54.5 degrees from the crown. With 9
voussoirs there are joints at 50 degrees and at 70.
"""

from math import degrees

from blocksim import CircularArch, bracket, check, simulate
from blocksim.view.video import render

ARCH = CircularArch(half_angle_deg=90, voussoirs=9, weight="centreline", friction=0.7)

least = bracket(ARCH, method="limit").arch.eta_high
arch = ARCH.but(eta=0.98 * least)
answer = check(arch, method="direct")
hinges = [degrees(joint.angle) for joint in answer.joints if "intrados" in str(joint.state)]
print(answer.verdict, "with hinges at the intrados at", hinges)

recording = simulate(arch, method="direct", duration=2.4)
render([recording], "collapse_film.gif", height=180, slow=1)
render([recording], "collapse_film.png", height=480, at=1.9)

headline = max(hinges)
print(f"inner hinge at {headline:.1f} degrees")
