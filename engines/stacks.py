"""Bodies that rest on others, in steps that land: what an engine needs for them beside its block.

Such an engine has a module `stacks` in its folder, with SETTINGS, in place of some of those by
which it lands otherwise, and with its own `build`: found by its name, so that what is said there
concerns nothing that stands alone.
"""

from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec

from engines.declaration import Engine


def stacking(engine: Engine) -> Engine:
    """Return an engine as its best preset holds stacks, or as it is where it needs nothing."""
    place = f"{engine.build.__module__.rpartition('.')[0]}.stacks"
    if not place.startswith("engines.") or find_spec(place) is None:
        return engine
    own = import_module(place)
    best = replace(engine.best, stacked=own.SETTINGS)
    return replace(engine, build=own.build, presets=(*engine.presets[:-1], best))
