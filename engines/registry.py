"""Every engine by its name: the project's own, and those of other packages."""

import inspect
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from engines.declaration import Builder, Engine, Preset, landing
from engines.settings import Settings, setting

FURTHER = "ROCKING_ENGINES"
"""Environment variable: engines that no package announces, as "name=module:ENGINE name=..."."""

GROUP = "rocking.engines"
"""Entry points of other packages in this group are engines: name -> "module:ENGINE"."""

NAMES = ("pybullet", "mujoco", "pymunk", "box2d", "dart", "rapier", "drake", "newton", "physx")
OWN = {name: f"engines.{name}:ENGINE" for name in NAMES}
"""Name of an engine -> where its declaration stands."""


class UnloadableError(OSError, ValueError):
    """An engine that stands nowhere; the message is one line that says why."""


class Engines(Mapping[str, Engine]):
    """Name -> declaration, read when an engine is first asked for; no library is imported."""

    def __getitem__(self, name: str) -> Engine:
        return loaded(name, _places()[name])

    def __iter__(self) -> Iterator[str]:
        return iter(_places())

    def __len__(self) -> int:
        return len(_places())


ENGINES = Engines()


@cache
def _places() -> dict[str, EntryPoint]:
    """Return where each engine is declared, the project's own first: no other may replace them."""
    own = {name: EntryPoint(name, place, GROUP) for name, place in OWN.items()}
    others = {point.name: point for point in (*entry_points(group=GROUP), *_further())}
    return own | {name: others[name] for name in sorted(others.keys() - own.keys())}


def _further() -> list[EntryPoint]:
    words = os.environ.get(FURTHER, "").split()
    for word in words:
        if not re.fullmatch(r"[\w.-]+=[\w.]+:[\w.]+", word):
            raise UnloadableError(f"{FURTHER} holds {word!r}; it must be like mine=my_file:ENGINE")
    pairs = (word.partition("=") for word in words)
    return [EntryPoint(name, place, GROUP) for name, _, place in pairs]


def named(place: str) -> str:
    """Return the name of the engine at "module:ENGINE" or "module:build"; ValueError if none."""
    if not re.fullmatch(r"[\w.]+:[\w.]+", place):
        raise ValueError(f"engine is {place!r}; it must be like my_package.mine:ENGINE")
    module = place.partition(":")[0]
    found = _found(place, EntryPoint(module, place, GROUP))
    if isinstance(found, Engine):
        if re.fullmatch(r"[\w.-]+", found.name):
            return found.name
        words = "a name is made of letters, digits, '-', '_' and '.'"
        raise ValueError(f"engine {place!r} is called {found.name!r}; {words}")
    if not callable(found) or inspect.isbuiltin(found):
        raise ValueError(f"engine {place!r} is neither a declaration nor what builds a world")
    try:
        inspect.signature(found).bind("scene", "settings", "dt_s")
    except TypeError:
        words = f"it takes {inspect.signature(found)}, and what builds a world takes"
        raise ValueError(f"engine {place!r} is none; {words} (scene, settings, dt_s)") from None
    except ValueError:
        pass  # what is compiled may not say what it takes
    return module.rpartition(".")[2]


def announce(place: str, name_of: Callable[[str], str] = named) -> str:
    """Make an engine known that no package announces; return its name, if that is not taken."""
    name = name_of(place)
    if name in ENGINES:
        raise ValueError(f"engine {place!r} is called {name!r}, as another is")
    os.environ[FURTHER] = " ".join([*os.environ.get(FURTHER, "").split(), f"{name}={place}"])
    _places.cache_clear()
    return ENGINES[name].name


def _found(name: str, place: EntryPoint) -> object:
    here, own = str(Path.cwd()), __name__.partition(".")[0]
    if place.module.partition(".")[0] != own and place.dist is None and sys.path[0] != here:
        sys.path.insert(0, here)  # no package announces it: it may stand in this folder
    try:
        return place.load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # it is anybody's code
        words = f"cannot be loaded from {place.value}: {str(error) or type(error).__name__}"
        raise UnloadableError(f"engine {name!r} {words}") from error


@cache
def loaded(name: str, place: EntryPoint) -> Engine:
    """Return an engine as its code declares it; ValueError if none is."""
    found = _found(name, place)
    if callable(found) and place in _further():
        return undeclared(name, found, place.module.partition(".")[0])
    if not isinstance(found, Engine) or found.name != name:
        own = f", but of {found.name!r}" if isinstance(found, Engine) else ""
        words = f"{place.value} is no declaration of that name{own}"
        raise UnloadableError(f"engine {name!r}: {words}")
    return found


def core_engines() -> tuple[str, ...]:
    """Return the names of the engines that the published studies ask by default.

    >>> core_engines()
    ('pybullet', 'mujoco')
    """
    return tuple(name for name, engine in ENGINES.items() if engine.core)


def installed_engines() -> tuple[str, ...]:
    """Return the names of the engines whose libraries are here.

    >>> set(installed_engines()) <= set(ENGINES)
    True
    """
    return tuple(name for name, engine in ENGINES.items() if engine.installed)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainSettings(Settings):
    """The one setting that every engine must take: friction between block and base."""

    friction: float = setting(1.0, above=0.0)


def undeclared(name: str, build: Builder, library: str) -> Engine:
    """Return an engine known by what builds its world alone, of one body, in `PlainSettings`."""
    fixed = Preset(name="tuned", title="equal steps", settings=PlainSettings(), step=1e-3)
    return Engine(
        name=name,
        title=name,
        library=library,
        packages=(),
        install=library,
        build=build,
        presets=(fixed, landing(PlainSettings())),
        frames=("base",),
    )
