"""Physics engines on scenes with exact answers: any scene, any engine, one way of looking at it.

A scene is data: bodies, where they begin, which faces touch, and how the base moves
(`engines.scene`). An adapter builds it, chooses the engine's settings, decides when it steps
and how its contact holds. It never decides what the state becomes: places and velocities are set
once, before the first step, and the impact is the engine's. What a preset does besides setting the
engine is declared (`engines.declaration.Help`), and so is which scenes it can hold.

To add an engine, write one file beside these and put its name into ``engines.registry.OWN``, or
declare it in a package of your own under the entry point group ``rocking.engines``::

    [project.entry-points."rocking.engines"]
    mine = "my_package.rocking:ENGINE"

A file that no package announces is scored as it is, `rocking score my_file:ENGINE`, and known to
every command, ``--sources exact mine:tuned``, where ``ROCKING_ENGINES="mine=my_file:ENGINE"`` is
set in the environment; mine is the name that the declaration has.

It holds

- a frozen settings class, whose defaults are the library's own (`engines.settings`); one setting is
  called ``friction``, and where they exist ``geometry`` ("box", "corners", "hull"), ``planar``
  (False frees a body in space) and ``floor`` (how a base that moves is moved, "position" being by
  position alone) are called so, because studies put them back;
- a world (`engines.world`): ``moment``, ``step`` or ``advance``, ``state``, ``fault``, ``close``.
  It starts from `Scene.bodies`. A `Step` carries all that it needs: the gravity that gives the
  velocity its kick, along the base too where the frame is "base", and the base's velocity and
  place where it is "world", in which an adapter may say how far the base lags (``lag_m``), and
  moves it vertically, too, where the engine declares so (``lifts``);
- ``build(scene, settings, dt_s)``, the only place that may import the library, so that
  declarations are read without it: a library that is missing is a row "not available";
- where it can be, ``script``: the scene in the library's own words, by which `rocking export`
  writes it out and `rocking advise` says what to set. The world is built once more with a library
  whose calls are noted (`engines.run.export`), so that a script says what a run does. Much of this
  is alike for most libraries, and stands in `engines.parts.Adapter`;
- where its library can be stepped from compiled code, ``drive``: to the bit what ``step`` and
  ``state`` give;
- where it can hold several bodies, and bodies that rest on others, ``stacks``;
- ``ENGINE``, an `engines.declaration.Engine`: what it can do, its presets from "default" (as the
  library's own documentation shows it, each setting with its source) to the best there is, and
  what the studies try of its contact. Where its world moves no base, ``frames=("base",)`` says so:
  a `Step` then carries the motion as gravity along the base. A preset "landing" needs no more than
  ``stepping=Stepping.LANDING``, for which steps are chosen outside the engine.

The conformance tests run over the registry and take their tolerances from the declaration.
"""

from engines.registry import ENGINES, core_engines, installed_engines
from engines.scene import ACCURACIES, FRAMES, Scene

__all__ = ["ACCURACIES", "ENGINES", "FRAMES", "Scene", "core_engines", "installed_engines"]
