"""How each source is drawn, in one place: colour, line and marker of models, solvers, engines."""

from dataclasses import dataclass
from typing import Any

from analytic.models import MODELS
from engines import ENGINES
from studies.measures.presets import Fill, engine_of, preset_of, told

LOWEST = 1e-16
"""Errors below are drawn here, on the floor of double precision."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a source is drawn: its colour, and its line (models and solvers) or marker (engines).

    Attributes
    ----------
    colour : str
    line : str
        Empty for sources that are drawn as points.
    marker : str
        Empty for sources that are drawn as lines.
    width : float
    fill : str
        How much of the marker is filled.
    """

    colour: str
    line: str = ""
    marker: str = ""
    width: float = 1.4
    fill: Fill = "none"

    def points(self, size: float = 4.5) -> dict[str, Any]:
        """Return how its points are drawn, as arguments of `Axes.plot`."""
        return {
            "color": self.colour,
            "linestyle": "none",
            "marker": self.marker or ".",
            "markersize": size,
            "fillstyle": self.fill if self.marker else "full",
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

OTHER = Style("#777777", marker="D")
"""Of a source without a style of its own."""


def look_at(place: int) -> tuple[str, str]:
    """Return the colour and the marker of the engine at a place among all."""
    return (
        ENGINE_COLOURS[place % len(ENGINE_COLOURS)],
        ENGINE_MARKERS[place % len(ENGINE_MARKERS)],
    )


def engine_style(engine: str, preset: str) -> Style:
    """Return colour and marker of an engine, by its place among all, and the preset's fill.

    Parameters
    ----------
    engine : str
        A name in `ENGINES`.
    preset : str
        Empty where the engine is named without one.

    Raises
    ------
    ValueError
        If there is no such engine.
    """
    colour, marker = look_at(list(ENGINES).index(engine))
    return Style(colour, marker=marker, fill=told(preset).fill)


def title_of(engine: str) -> str:
    """Return an engine's name as its makers spell it; that of any other source as it is."""
    return ENGINES[engine].title if engine in ENGINES else engine


def engine_title(source: str) -> str:
    """Return the title of the engine that a source is a preset of."""
    return title_of(source.partition(":")[0])


def name_of(source: str) -> str:
    """Return how a source is called in a picture: an engine by its title, with its preset."""
    engine, colon, preset = source.partition(":")
    return title_of(engine) + (f", {told(preset).short}" if colon else "")


def full_name(source: str) -> str:
    """Return the same for an engine's plain name, too, which stands for its best preset.

    A model is called by its title.
    """
    if source in MODELS:
        return MODELS[source].title
    preset = preset_of(source)
    return name_of(f"{engine_of(source)}:{preset}") if preset else name_of(source)


def style_of(source: str) -> Style:
    """Return the style of a source; one without a style of its own is grey."""
    plain, _, preset = source.partition(":")
    if plain in ENGINES:
        return engine_style(plain, preset)
    return STYLES.get(plain, OTHER)


def line_of(source: str) -> str:
    """Return the line of a source that is drawn as one: a model's own, or that of its preset."""
    return style_of(source).line or told(source.partition(":")[2]).line
