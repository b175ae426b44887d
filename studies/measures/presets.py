"""The presets of the engines: their order, and their names in a sentence."""

from collections.abc import Iterable

from engines import ENGINES
from studies.sources.registry import resolve

WORDS = {
    "naive": "with the libraries' defaults",
    "fixed": "with a tuned contact and a fixed step",
    "error-controlled": "with the engine's own error-controlled steps",
    "landing": "with steps that land on impacts",
}
"""Preset -> what it is, as part of a sentence about engines that have it."""


def is_engine(source: str) -> bool:
    """Say whether a source is an engine."""
    return resolve(source).kind == "engine"


def preset_of(source: str) -> str:
    """Return the preset that an engine's name stands for; none of other sources."""
    return str(resolve(source).preset)


def engine_of(source: str) -> str:
    """Return the engine that a source is a preset of; any other source is its own."""
    return source.partition(":")[0]


def in_words(preset: str) -> str:
    """Return a preset as part of a sentence."""
    return WORDS.get(preset, f"with the preset {preset}")


def in_order(names: Iterable[str]) -> list[str]:
    """Return presets from the libraries' own to the best there is, as the engines declare them."""
    declared = [preset.name for engine in ENGINES.values() for preset in engine.presets]
    places = {name: place for place, name in reversed(list(enumerate(declared)))}
    last = "landing"  # what the plain names stand for, whatever stands between in some engine
    return sorted(set(names), key=lambda name: (name == last, places[name]))
