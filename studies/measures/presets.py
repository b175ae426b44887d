"""The presets of the engines: their order, their names in a sentence, and how they are drawn."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from engines import ENGINES
from engines.declaration import AT_REST, RECOMMENDED, Preset
from studies.sources.registry import resolve

Fill = Literal["none", "left", "bottom", "full"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """How a preset is told of.

    Attributes
    ----------
    words : str
        What it is, as part of a sentence about engines that have it.
    short : str
        After the name of an engine.
    colour : str
        Where presets are compared, and the engines are named.
    line, fill : str
        Where an engine is drawn as a line, and how much of its marker is filled.
    """

    words: str
    short: str
    colour: str = "#777777"
    line: str = "-"
    fill: Fill = "none"


PRESETS = {
    "naive": Told(
        words="as their documentation shows them",
        short="as documented",
        colour="#D55E00",
        line=":",
        fill="full",
    ),
    AT_REST: Told(
        words="as documented but on a base at rest",
        short="base at rest",
        colour="#E69F00",
        line=":",
    ),
    RECOMMENDED: Told(
        words="as their documentation recommends",
        short="as recommended",
        colour="#56B4E9",
        line="-.",
        fill="bottom",
    ),
    "fixed": Told(
        words="with a tuned contact and a fixed step",
        short="fixed step",
        colour="#0072B2",
        line="--",
        fill="left",
    ),
    "error-controlled": Told(
        words="with the engine's own error-controlled steps",
        short="its own steps",
        colour="#CC79A7",
        line="-.",
        fill="bottom",
    ),
    "landing": Told(
        words="with steps that land on impacts",
        short="landing steps",
        colour="#009E73",
    ),
}
"""Preset -> how it is told of, from the libraries' own to the best there is."""


def told(preset: str) -> Told:
    """Return how a preset is told of; one of another package by its name, in grey."""
    if preset in PRESETS:
        return PRESETS[preset]
    return Told(words=f"with the preset {preset}", short=preset)


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
    """Return an engine's presets, without the varied frame of what is documented."""
    return [use for use in ENGINES[engine].presets if use.name != AT_REST]


def in_words(preset: str) -> str:
    """Return a preset as part of a sentence."""
    return told(preset).words


def in_order(names: Iterable[str]) -> list[str]:
    """Return presets from the libraries' own to the best there is, others before the last."""
    *first, last = PRESETS
    places = {**{name: place for place, name in enumerate(first)}, last: len(PRESETS)}
    return sorted(set(names), key=lambda name: (places.get(name, len(first)), name))
