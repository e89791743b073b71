"""Blocks in space that move: convex polyhedra with Coulomb's friction, round cones."""
