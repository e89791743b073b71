"""How far can a wall with a window be tilted?

Wall 3 of Ferris and Tin-Loi (2001) falls when it is pushed by 0.40369 of its weight. Tilted by
an angle, gravity pushes by the tangent of that angle: so it must fall at atan(0.40369).
"""

from dataclasses import replace
from math import radians, tan

from blocksim import bracket, check, load_structure

wall = replace(load_structure("ferris_tinloi_3"), live=())
found = bracket(wall, over="tilt", method="limit", tol=1e-4)
print(f"it stands up to {found.low:.3f} degrees, and falls at {found.high:.3f}")

# A little beyond: how does it fall?
answer = check(wall.tilted(radians(found.high * 1.02)))
answer.plot().savefig("tilted_wall.png", dpi=70)

headline = tan(radians((found.low + found.high) / 2))
print(f"tangent of the angle: {headline:.5f}")
