"""What is below the questions: engines held, let go and stepped, arches by their statics.

Tests that ask it take it from here, so that one file says where it is.
"""

from blocksim.arch.modes import observed_mode as observed_mode
from blocksim.blocks.joints import classify as classify
from blocksim.blocks.joints import joint_motion as joint_motion
from blocksim.blocks.joints import overlap_and_slip as overlap_and_slip
from blocksim.engines import direct
from blocksim.engines import get_engine as get_engine
from blocksim.engines.base import Engine as Engine
from blocksim.engines.base import Quality as Quality
from blocksim.engines.base import trusted as trusted
from blocksim.engines.contact.solver import ContactProblem as ContactProblem
from blocksim.engines.direct import Blocks as Blocks
from blocksim.engines.ground import ground_level as ground_level
from blocksim.limit import least_motion as least_motion
from blocksim.simulation.motion import moving_run as moving_run
from blocksim.simulation.observation import hold as hold
from blocksim.simulation.observation import observe as observe
from blocksim.simulation.onset import onset as onset
from blocksim.simulation.simulated import Simulation as Simulation

DIRECT = direct.ENGINE
