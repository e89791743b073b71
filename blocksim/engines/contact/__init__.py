"""Contact problem of rigid blocks: arrays in, arrays out."""

from blocksim.engines.contact.geometry import Touch as Touch
from blocksim.engines.contact.neighbours import Neighbours as Neighbours
from blocksim.engines.contact.solver import ContactProblem as ContactProblem
from blocksim.engines.contact.solver import Solution as Solution
