"""Bodies that rest on others, where an engine needs something of its own for them.

Such an engine has a module `stacks` in its folder, with its own `build`, and SETTINGS in place of
some of a preset's that is not for stacks otherwise: found by its name, so that what is said there
concerns nothing that stands alone.
"""

from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec

from engines.declaration import Engine
from engines.layouts import Ability


def stacking(engine: Engine, preset: str) -> Engine:
    """Return an engine as one of its presets holds stacks, or as it is where nothing is to add."""
    place, used = f"{engine.build.__module__.rpartition('.')[0]}.stacks", engine.preset(preset)
    able = Ability.STACKED in engine.abilities and used.stacked is not None
    if able or not place.startswith("engines.") or find_spec(place) is None:
        return engine
    own = import_module(place)
    presets = (replace(used, stacked=own.SETTINGS) if it is used else it for it in engine.presets)
    return replace(engine, build=own.build, presets=tuple(presets), abilities=tuple(Ability))
