"""Run blocksim as `python -m blocksim`."""

from blocksim.cli import main

main()
