"""Polygons from a DXF drawing: three blocks, each 0.2 m beyond the one below.

The stack is 1.4 m long and 1.5 m high; its centre is 0.3 m from the corner it turns about, and
0.75 m above it. So it topples when the table is tilted by atan(0.3/0.75) = 21.80 degrees.
"""

from math import radians

import ezdxf

from blocksim import bracket, check, load_structure


def box(left, bottom, right, top):
    """Give the corners of a rectangle."""
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


# As it would come from a CAD program: closed polylines on the layers `blocks` and `supports`.
drawing = ezdxf.new(units=ezdxf.units.M)
space = drawing.modelspace()
space.add_lwpolyline(box(-2, -1, 4, 0), close=True, dxfattribs={"layer": "supports"})
for row in range(3):
    corners = box(0.2 * row, 0.5 * row, 0.2 * row + 1, 0.5 * row + 0.5)
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "blocks"})
drawing.saveas("stack.dxf")

stack = load_structure("stack.dxf", friction=0.6)
found = bracket(stack, over="tilt", method="direct", tol=0.001)
print(f"by simulation between {found.low:.2f} and {found.high:.2f} degrees")
check(stack.tilted(radians(found.high))).plot().savefig("drawing.png", dpi=70)

headline = (found.low + found.high) / 2
print(f"it topples at {headline:.2f} degrees")
