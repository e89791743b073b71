"""Limit analysis of any assembly of blocks."""

from blocksim.limit.programme import Collapse as Collapse
from blocksim.limit.programme import Equilibrium as Equilibrium
from blocksim.limit.programme import collapse as collapse
from blocksim.limit.programme import equilibrium as equilibrium
from blocksim.limit.programme import falling as falling
from blocksim.limit.programme import settling as settling
