"""Blocks, the joints between them, and how joints move."""
