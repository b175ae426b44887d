"""The reference: exact rocking of a rigid block, its linearizations and the paper's solvers.

Conventions: SI units and radians; width B and height H are full dimensions; theta > 0 turns the
block about its corner O, and a positive ground acceleration drives it to theta < 0 first; times
are ground times, from the start of the base motion. What is unknown or out of range is refused by a
ValueError that says what is allowed.
"""

from analytic.block import GRAVITY, RigidBlock, housner_restitution
from analytic.cases import peak_ratios
from analytic.conditioning import condition_numbers, conditioning, sensitivities, sensitivity
from analytic.frame import Rocker, RockingFrame, frame_restitution
from analytic.frame_forces import frame_demands
from analytic.maps import Modes, overturning_modes
from analytic.models import MODELS
from analytic.motion import Delayed, Motion, SinePulse, Still
from analytic.record import Record
from analytic.response import History, Impact, Outcome, Response
from analytic.simulate import simulate
from analytic.slide import SlidingBlock
from analytic.steppers import integrate

__all__ = ["GRAVITY", "MODELS", "Delayed", "History", "Impact", "Modes", "Motion"]
__all__ += ["Outcome", "Record", "Response", "RigidBlock", "Rocker"]
__all__ += ["RockingFrame", "SinePulse", "SlidingBlock", "Still"]
__all__ += ["condition_numbers", "conditioning", "frame_demands", "frame_restitution"]
__all__ += ["housner_restitution", "integrate", "overturning_modes", "peak_ratios"]
__all__ += ["sensitivities", "sensitivity", "simulate"]
