"""Exact statics of the n voussoirs as built."""

from blocksim.limit.equilibrium import equilibrium as equilibrium
from blocksim.limit.statics import LimitState as LimitState
from blocksim.limit.statics import least_thickness as least_thickness
from blocksim.limit.statics import slack as slack
from blocksim.limit.statics import stands as stands
from blocksim.limit.statics import weakest_joints as weakest_joints
