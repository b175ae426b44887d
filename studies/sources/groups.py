"""Several sources by one word: the engines that the published studies ask, or all that are here."""

from collections.abc import Iterable, Iterator

from engines import ENGINES, core_engines, installed_engines
from studies.sources.registry import presets_of, resolve


def original_of(name: str) -> str:
    """Return the engine whose models another one steps: its packages are among the other's."""
    whole = set(ENGINES[name].packages)
    known = ((other, set(engine.packages)) for other, engine in ENGINES.items())
    return next((other for other, packages in known if packages and packages < whole), "")


def ports() -> tuple[str, ...]:
    """Return the names of the engines that are here and step another one's models."""
    return tuple(filter(original_of, installed_engines()))


GROUPS = {"core": core_engines, "engines": installed_engines, "ports": ports}
"""Word -> the names of the engines for which it stands."""


def core_sources(*presets: str) -> tuple[str, ...]:
    """Return the core engines by name, each with some presets; "" is its best."""
    return tuple(
        f"{name}:{preset}" if preset else name
        for name in core_engines()
        for preset in presets or ("",)
    )


def expanded(names: Iterable[str]) -> Iterator[str]:
    """Yield the names with those of engines in place of a group's; "engines:fixed" has a preset.

    Engines of a group that have no such preset are left out, unless none has it.
    """
    for name in names:
        group, colon, preset = name.partition(":")
        if group not in GROUPS:
            yield name
            continue
        engines = GROUPS[group]()
        having = [e for e in engines if not colon or preset in presets_of(resolve(e))]
        yield from (f"{engine}{colon}{preset}" for engine in having or engines)
