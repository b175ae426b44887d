"""How each source is drawn, in one place: colour, line and marker of models, solvers, engines."""

from dataclasses import dataclass
from typing import Any

from analytic.models import MODELS
from engines import ENGINES
from studies.measures.presets import Fill, engine_of, look_of, preset_of

LOWEST = 1e-16
"""Errors below are drawn here, on the floor of double precision."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a source is drawn: a model or solver as a line, an engine as markers."""

    colour: str
    line: str = ""
    marker: str = ""
    width: float = 1.4
    fill: Fill = "none"

    def points(self, size: float = 4.5) -> dict[str, Any]:
        """Return how its points are drawn, as arguments of `Axes.plot`."""
        return {
            **{"color": self.colour, "linestyle": "none", "markersize": size},
            **{"marker": self.marker or ".", "fillstyle": self.fill if self.marker else "full"},
        }


# the palette of Okabe and Ito, which colour-blind readers tell apart
STYLES = {
    "exact": Style("#000000", "-", width=2.2),
    "housner": Style("#D55E00", "--"),
    "modified": Style("#0072B2", "-."),
    "onset-matched": Style("#CC79A7", ":", width=1.8),
    "rk4": Style("#56B4E9", "-", width=1.0),
    "average-acceleration": Style("#E69F00", "--", width=1.0),
}

# from Tol's muted palette, but for the first two; an engine has a marker of its own besides,
# because no eleven colours stay apart for every reader; with 9 markers they make 99 looks
ENGINE_COLOURS = (
    *("#009E73", "#7A4FBF", "#882255", "#999933", "#332288", "#44AA99", "#AA4499", "#661100"),
    *("#CC6677", "#117733", "#DDAA33"),
)
ENGINE_MARKERS = "o^sDvPXph"


def look_at(place: int) -> tuple[str, str]:
    """Return the colour and the marker of the engine at a place among all."""
    colours, markers = len(ENGINE_COLOURS), len(ENGINE_MARKERS)
    return ENGINE_COLOURS[place % colours], ENGINE_MARKERS[place % markers]


def style_of(source: str) -> Style:
    """Return the style of a source: an engine's by its place among all, filled by its preset."""
    plain, _, preset = source.partition(":")
    if plain not in ENGINES:
        return STYLES.get(plain, Style("#777777", marker="D"))
    colour, marker = look_at(list(ENGINES).index(plain))
    return Style(colour, marker=marker, fill=look_of(preset).fill)


def line_of(source: str) -> str:
    """Return the line of a source that is drawn as one: a model's own, or that of its preset."""
    return style_of(source).line or look_of(source.partition(":")[2]).line


def title_of(source: str) -> str:
    """Return the name of a source without its preset, an engine's as its makers spell it."""
    engine = engine_of(source)
    return ENGINES[engine].title if engine in ENGINES else engine


def full_name(source: str) -> str:
    """Return how a source is called in a picture: an engine by its title, with its preset."""
    if source in MODELS:
        return MODELS[source].title
    preset = preset_of(source)
    return f"{title_of(source)}, {look_of(preset).short}" if preset else title_of(source)
