"""The command line: options to questions, answers to text."""

from blocksim.cli.commands import main as main
