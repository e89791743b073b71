"""Limit analysis in space: second-order cones, with a gap that is stated."""

from blocksim.limit.space.statics import SpatialEquilibrium as SpatialEquilibrium
from blocksim.limit.space.statics import can_rest as can_rest
from blocksim.limit.space.statics import largest_load as largest_load
from blocksim.limit.space.statics import observed_joints as observed_joints
from blocksim.limit.space.statics import unit_rates as unit_rates
