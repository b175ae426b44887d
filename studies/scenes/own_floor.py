"""The exact answer on the floor that an engine really made."""

import numpy as np

from analytic import Record, RigidBlock, simulate
from analytic.motion import Motion
from analytic.response import Response
from engines import ENGINES, Scene
from engines.run.drive import Stepper, build
from engines.run.monitor import Monitor


def exact_on_its_floor(engine: str, preset: str, block: RigidBlock, motion: Motion) -> Response:
    """Return the exact response to the motion that an engine's floor made under a block.

    Parameters
    ----------
    engine, preset : str
        Whose floor; one that says nowhere where it is, is where it should be.
    block : RigidBlock
    motion : Motion
        How the floor should move.

    Returns
    -------
    Response
        Under the second differences of the floor's places, joined by straight lines.
    """
    declared = ENGINES[engine]
    used = declared.preset(preset)
    scene = used.posed(Scene(system=block, motion=motion, preset=preset, compiled=False))
    world, dt_s = build(declared, scene), used.ordinary_step_s(scene)
    try:
        if not hasattr(world, "base_x_m"):
            return simulate(block, motion)
        monitor = Monitor(scene, dt_s, used.stepping, world.moment, declared.resolution(block))
        walk, places = Stepper(monitor, world, used.stepping), [0.0, 0.0]
        while walk.go(1):
            places.append(float(world.base_x_m))
    finally:
        world.close()
    samples = np.diff(places, 2) / dt_s**2
    return simulate(block, Record(samples=samples, dt=dt_s))
