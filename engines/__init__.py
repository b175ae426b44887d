"""Physics engines on the rocking block: one scene, any engine, one way of looking at it.

An adapter builds the scene, chooses the engine's settings and decides when it steps. It never
decides what the state becomes: no rotation or velocity is written, and the impact is the engine's.
"""

from engines.drive import ENGINES, run
from engines.scene import ACCURACIES, FRAMES, PRESETS, Scene

__all__ = ["ACCURACIES", "ENGINES", "FRAMES", "PRESETS", "Scene", "run"]
