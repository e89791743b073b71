"""Closed form of the continuous arch (Cocchetti and Rizzi, 2024)."""

from blocksim.theory.arrays import CriticalArrays as CriticalArrays
from blocksim.theory.arrays import least_thicknesses as least_thicknesses
from blocksim.theory.critical import Critical as Critical
from blocksim.theory.critical import least_thickness as least_thickness
from blocksim.theory.regions import Curve as Curve
from blocksim.theory.regions import Landmark as Landmark
from blocksim.theory.regions import landmarks as landmarks
