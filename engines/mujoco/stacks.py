"""MuJoCo: bodies that rest on others, on a contact that yields at its surface.

Velocities are held and places follow, so that in every step a pivot is lifted by (theta' dt)^2 R/2
along the base's normal. A contact makes up for it where it yields as much to its force: by
(1 - d)/d, d being its impedance, times force over mass. One that yields by less at its surface lets
go, and three columns or more need not come together again (EQUATIONS.md, "The rocking frame"). One
that yields by much less a little deeper overshoots from step to step, and the columns hand their
load on. Both ask for a surface in proportion to the lift, which is that of theta' = p alpha.
"""

import math
from dataclasses import replace
from functools import wraps

from engines.mujoco.build import MujocoWorld, world_of
from engines.mujoco.settings import MujocoSettings
from engines.scene import Scene


def softened(scene: Scene, s: MujocoSettings) -> MujocoSettings:
    """Return settings whose soft surface is in proportion to sin(alpha)^2.

    Parameters
    ----------
    scene : Scene, of bodies that rest on others
    s : MujocoSettings, of which soft_surface is the greatest (1 - d)/d and the depth, both over
        sin(alpha)^2; where it is None, they are left as they are

    Returns
    -------
    MujocoSettings
        With soft_surface over g dt^2, and the impedance at the surface.
    """
    if s.impedance is None or s.soft_surface is None:
        return s
    yields = s.soft_surface * math.sin(scene.system.alpha) ** 2
    surface, *below = s.impedance
    softest = min(surface, 1.0 / (1.0 + yields))
    return replace(s, impedance=(softest, *below), soft_surface=yields)


@wraps(world_of, assigned=(), updated=())  # a script calls what both do
def stacks_of(scene: Scene, settings: MujocoSettings, dt_s: float) -> MujocoWorld:
    """Build a scene of bodies that rest on others; see `engines.mujoco.build.world_of`."""
    return world_of(scene, softened(scene, settings), dt_s)
