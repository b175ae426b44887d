"""Every engine by its name: the project's own, and those of other packages."""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points

from engines.declaration import Engine

GROUP = "rocking.engines"
"""Entry points of other packages in this group are engines: name -> "module:ENGINE"."""

OWN = {
    "pybullet": "engines.adapters.bullet:ENGINE",
    "mujoco": "engines.adapters.mujoco:ENGINE",
    "pymunk": "engines.adapters.pymunk:ENGINE",
    "dart": "engines.adapters.dart:ENGINE",
    "rapier": "engines.adapters.rapier:ENGINE",
}
"""Name of an engine -> where its declaration stands."""


class Engines(Mapping[str, Engine]):
    """Name -> declaration, read when an engine is first asked for; no library is imported."""

    def __getitem__(self, name: str) -> Engine:
        return _declared(name, _places()[name])

    def __iter__(self) -> Iterator[str]:
        return iter(_places())

    def __len__(self) -> int:
        return len(_places())


ENGINES = Engines()


@cache
def _places() -> dict[str, EntryPoint]:
    """Return where each engine is declared, the project's own first: no other may replace them."""
    own = {name: EntryPoint(name, place, GROUP) for name, place in OWN.items()}
    others = {point.name: point for point in entry_points(group=GROUP)}
    return own | {name: others[name] for name in sorted(others.keys() - own.keys())}


@cache
def _declared(name: str, place: EntryPoint) -> Engine:
    """Load a declaration.

    Raises
    ------
    ValueError
        If what stands there is none, or one of another name.
    """
    try:
        found = place.load()
    except (ImportError, AttributeError) as error:
        raise ValueError(f"engine {name!r} cannot be loaded from {place.value}: {error}") from error
    if not isinstance(found, Engine) or found.name != name:
        raise ValueError(f"engine {name!r}: {place.value} is no declaration of that name")
    return found


def core_engines() -> tuple[str, ...]:
    """Return the names of the engines that the published studies ask by default."""
    return tuple(name for name, engine in ENGINES.items() if engine.core)


def installed_engines() -> tuple[str, ...]:
    """Return the names of the engines whose libraries are here."""
    return tuple(name for name, engine in ENGINES.items() if engine.installed)


def find(name: str) -> Engine:
    """Return an engine by its name.

    Raises
    ------
    ValueError
        If there is none.
    """
    if name not in ENGINES:
        raise ValueError(f"engine is {name!r}; it must be one of {', '.join(ENGINES)}")
    return ENGINES[name]
