"""Limit analysis of any assembly of blocks."""

from blocksim.limit.capacity import Capacity as Capacity
from blocksim.limit.capacity import Collapse as Collapse
from blocksim.limit.least import LeastMotion as LeastMotion
from blocksim.limit.least import least_motion as least_motion
from blocksim.limit.margins import Margins as Margins
from blocksim.limit.margins import Thrust as Thrust
from blocksim.limit.margins import margins as margins
from blocksim.limit.margins import nearest_mechanism as nearest_mechanism
from blocksim.limit.margins import thrust_range as thrust_range
from blocksim.limit.programme import Equilibrium as Equilibrium
from blocksim.limit.programme import falling as falling
from blocksim.limit.programme import settling as settling
from blocksim.limit.resultants import Reaction as Reaction
from blocksim.limit.resultants import Resultants as Resultants
from blocksim.limit.resultants import in_world as in_world
from blocksim.limit.resultants import reactions as reactions
from blocksim.limit.resultants import resultants as resultants
from blocksim.limit.statics import collapse as collapse
from blocksim.limit.statics import equilibrium as equilibrium
