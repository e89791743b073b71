"""Closed form of the continuous arch (Cocchetti and Rizzi, 2024)."""

from blocksim.arch.theory.arrays import CriticalArrays as CriticalArrays
from blocksim.arch.theory.arrays import least_thicknesses as least_thicknesses
from blocksim.arch.theory.critical import Critical as Critical
from blocksim.arch.theory.critical import least_thickness as least_thickness
from blocksim.arch.theory.regions import Curve as Curve
from blocksim.arch.theory.regions import Landmark as Landmark
from blocksim.arch.theory.regions import landmarks as landmarks
