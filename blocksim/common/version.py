"""The version of blocksim, and of every method that is its own."""

__version__ = "0.1.0"
