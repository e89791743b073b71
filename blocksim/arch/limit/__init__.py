"""Exact statics of the n voussoirs as built."""

from blocksim.arch.limit.statics import LimitState as LimitState
from blocksim.arch.limit.statics import least_thickness as least_thickness
from blocksim.arch.limit.statics import slack as slack
from blocksim.arch.limit.statics import weakest_joints as weakest_joints
