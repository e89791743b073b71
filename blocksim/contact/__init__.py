"""Contact problem of rigid blocks: arrays in, arrays out."""

from blocksim.contact.geometry import Touch as Touch
from blocksim.contact.neighbours import Neighbours as Neighbours
from blocksim.contact.solver import ContactProblem as ContactProblem
from blocksim.contact.solver import Solution as Solution
