"""Blocks in space that move: convex polyhedra with Coulomb's friction, round cones."""

MOST_FRICTION = 100.0
"""Friction above which this is taken: in wider cones Newton's method is lost."""
