"""Limit analysis of any assembly of blocks."""

from blocksim.limit.equilibrium import equilibrium as equilibrium
