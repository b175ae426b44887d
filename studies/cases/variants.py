"""One factor at a time: from the best setting of an engine, and from its library's defaults."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from engines import ENGINES
from engines.declaration import AT_REST, PASTED
from engines.factors import (
    AS_BEST,
    BEST,
    BOTH,
    BY_DEFAULT,
    DEFAULT,
    LEFT_OUT,
    OWN_STEP,
    OWN_STEPS,
    Factor,
)

STILL = f"{OWN_STEP}, on a base at rest"
"""The defaults at their own step once more, in the other frame."""

AT_ONCE = f"{OWN_STEP}, shaken at once"
"""The same without the rest before the motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """One way to set an engine: a preset, which factor differs from it, and how.

    A preset as it is has no factor, and its title as level. `settings` and `scene` replace those
    of the preset; `trap` says why it goes wrong without a word, where it does.
    """

    engine: str
    preset: str
    factor: str = ""
    level: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    scene: Mapping[str, Any] = field(default_factory=dict)
    trap: str = ""

    @property
    def source(self) -> str:
        """The engine's preset."""
        return f"{self.engine}:{self.preset}"


def variants(engine: str) -> Iterator[Variant]:
    """Yield every way to set an engine, each preset as it is before what differs from it."""
    declared = ENGINES[engine]
    plain = {
        use.name: Variant(engine=engine, preset=use.name, level=use.title)
        for use in declared.presets
    }
    for name in [name for name in plain if name not in (*BOTH, AT_REST, PASTED)]:
        yield plain[name]
        for help_, settings in declared.preset(name).helped_by.items():
            if settings is not None:
                level = help_.name.lower()
                yield replace(plain[name], factor=LEFT_OUT, level=level, settings=settings)
    for name in [name for name in BOTH if name in plain]:
        yield plain[name]
        if name == DEFAULT:
            own = replace(plain[name], factor=OWN_STEPS, level=OWN_STEP)
            yield own
            yield replace(own, level=AT_ONCE, scene={"rest_s": 0.0})
            if declared.preset(name).frame == "world":
                yield replace(own, level=STILL, scene={"frame": "base"})
        for factor in declared.factors:
            if set(BOTH) <= plain.keys():
                yield from _exchanged(plain[name], factor)
            yield from _levels(plain[name], factor)


def _levels(plain: Variant, factor: Factor) -> Iterator[Variant]:
    """Yield one of the two presets with each level of a factor that it has."""
    for item in factor.levels:
        if plain.preset in item.presets:
            varied = {each: getattr(item, each) for each in ("settings", "scene", "trap")}
            yield replace(plain, factor=factor.name, level=item.name, **varied)


def _exchanged(plain: Variant, factor: Factor) -> Iterator[Variant]:
    """Yield one of the two presets with the other's values of a factor, where these differ."""
    untuned = plain.preset == DEFAULT
    chosen = [ENGINES[plain.engine].preset(name).settings for name in (DEFAULT, BEST)]
    default, best = ({name: getattr(of, name) for name in factor.settings} for of in chosen)
    own, wanted = (default, best) if untuned else (best, default)
    if wanted != own and (untuned or factor.by_default):
        level, trap = AS_BEST if untuned else BY_DEFAULT, factor.traps.get(plain.preset, "")
        yield replace(plain, factor=factor.name, level=level, settings=wanted, trap=trap)
