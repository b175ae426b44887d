"""The presets of the engines: their order, their names in a sentence, and how they are drawn."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from engines import ENGINES
from engines.declaration import AT_REST, PASTED, RECOMMENDED, Preset
from engines.factors import BEST
from studies.kit.say import capital
from studies.sources.registry import resolve

Fill = Literal["none", "left", "bottom", "full"]


@dataclass(frozen=True, slots=True)
class Look:
    """How a preset is named, in a sentence about engines and after the name of one, and drawn."""

    words: str
    short: str
    colour: str = "#777777"
    line: str = "-"
    fill: Fill = "none"


PRESETS = {
    "default": Look("with default settings", "default", "#D55E00", ":", "full"),
    AT_REST: Look(
        "with default settings and a floor at rest", "default, floor at rest", "#E69F00", ":"
    ),
    RECOMMENDED: Look("with recommended settings", "recommended", "#56B4E9", "-.", "bottom"),
    PASTED: Look("with a few lines to paste", "pasted", "#009E73", "--", "bottom"),
    "tuned": Look("with tuned settings", "tuned", "#0072B2", "--", "left"),
    "error-controlled": Look(
        "with error-controlled steps", "error-controlled", "#CC79A7", "-.", "bottom"
    ),
    "landing": Look("with landing steps", "landing", "#009E73"),
}
"""Preset -> how it is named and drawn, from the libraries' own to the best there is."""


def look_of(preset: str) -> Look:
    """Return how a preset is named and drawn; one of another package by its name, in grey."""
    return PRESETS.get(preset) or Look(f"with the preset {preset}", preset)


def is_engine(source: str) -> bool:
    """Say whether a source is an engine."""
    return resolve(source).kind == "engine"


def preset_of(source: str) -> str:
    """Return the preset that an engine's name stands for; none of other sources."""
    return str(resolve(source).preset)


def engine_of(source: str) -> str:
    """Return the engine that a source is a preset of; any other source is its own."""
    return source.partition(":")[0]


def uses_of(engine: str) -> list[Preset]:
    """Return an engine's presets, without those that are for a floor at rest alone."""
    return [use for use in ENGINES[engine].presets if use.name not in (AT_REST, PASTED)]


def pasted_of(engine: str) -> str:
    """Return the preset to paste for a free body: the tuned one where that holds one as it is."""
    return PASTED if PASTED in [use.name for use in ENGINES[engine].presets] else BEST


def in_order(names: Iterable[str]) -> list[str]:
    """Return presets from the libraries' own to the best there is, others before the last."""
    *first, last = PRESETS
    places = {**{name: place for place, name in enumerate(first)}, last: len(PRESETS)}
    return sorted(set(names), key=lambda name: (places.get(name, len(first)), name))


def titled(source: str) -> str:
    """Return a source as the subject of a sentence: "MuJoCo (landing steps)", "Housner"."""
    if not (preset := preset_of(source)):
        return capital(source)
    return f"{ENGINES[engine_of(source)].title} ({look_of(preset).short})"
