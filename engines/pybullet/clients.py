"""PyBullet's clients, each used for one run after another: most runs are shorter than connecting.

A reset gives a client a new world with a solver and settings of its own; what it keeps is put back.
"""

from threading import Lock
from typing import Any

from engines.parts.quiet import silence
from engines.pybullet.settings import LIBRARY_BREAKING_THRESHOLD, LIBRARY_STEP_S

RENDERER = "tinyRendererPlugin"
"""The library's name of what draws, or would."""

held_for_all = Lock()
"""Whose gap it is up to which contacts are kept: the library holds it for the whole process, and
looks at it when two bodies meet first, on a plane while a scene is built."""

idle: list[int] = []
"""Clients of this process whose run has ended."""


def taken(p: Any) -> int:
    """Return a client of the library `p` that no run uses, as good as new."""
    return idle.pop() if idle else connected(p)


def connected(p: Any) -> int:
    """Connect a client without a renderer, whose meshes take longer to make than the bodies."""
    client = int(p.connect(p.DIRECT))
    with silence():  # a build that has none says so past Python
        renderer = p.loadPlugin(RENDERER, physicsClientId=client)
    if renderer >= 0:
        p.unloadPlugin(renderer, physicsClientId=client)
    return client


def given_back(p: Any, client: int) -> None:
    """Empty a client, and give the library back what it holds for the process.

    Parameters
    ----------
    p : module, pybullet
    client : int, from `taken`; its run has ended
    """
    p.resetSimulation(physicsClientId=client)
    with held_for_all:
        p.setPhysicsEngineParameter(
            contactBreakingThreshold=LIBRARY_BREAKING_THRESHOLD,
            fixedTimeStep=LIBRARY_STEP_S,
            physicsClientId=client,
        )
    idle.append(client)
