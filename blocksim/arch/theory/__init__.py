"""Closed form of the continuous arch (Cocchetti and Rizzi, 2024)."""

from blocksim.arch.theory.arrays import CriticalArrays as CriticalArrays
from blocksim.arch.theory.arrays import least_thicknesses as least_thicknesses
from blocksim.arch.theory.critical import Critical as Critical
from blocksim.arch.theory.critical import least_thickness as least_thickness
from blocksim.arch.theory.map import MapPoints as MapPoints
from blocksim.arch.theory.map import SpecialAngles as SpecialAngles
from blocksim.arch.theory.map import at_points as at_points
from blocksim.arch.theory.map import divide_friction as divide_friction
from blocksim.arch.theory.map import iso_half_angle as iso_half_angle
from blocksim.arch.theory.map import special_angles as special_angles
from blocksim.arch.theory.regions import Curve as Curve
from blocksim.arch.theory.regions import Landmark as Landmark
from blocksim.arch.theory.regions import crown_hinge as crown_hinge
from blocksim.arch.theory.regions import divide as divide
from blocksim.arch.theory.regions import divide_half_angle as divide_half_angle
from blocksim.arch.theory.regions import equal_angles as equal_angles
from blocksim.arch.theory.regions import first_sliding as first_sliding
from blocksim.arch.theory.regions import landmarks as landmarks
