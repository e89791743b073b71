"""Polyhedral blocks in space: hulls, the joints between them, problems and their files."""
