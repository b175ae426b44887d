"""What the summaries of frames, slides and floors show, in a sentence each."""

from __future__ import annotations

import pandas as pd

from engines import ENGINES
from studies.measures.presets import in_order, in_words, preset_of
from studies.measures.words import listed, part

LATE_M = 1e-4
"""From which lag on a floor is late [m]."""

RIDES = 0.9
"""Part of a floor's way over which a block that rides on it is carried at least."""


def frame_sentence(lines: pd.DataFrame) -> str:
    """Say for each preset how far off the engines' frames are; empty without any."""
    said = [f"{part(most)} {words}" for words, most in _largest(lines, "largest_error")]
    return f"The peak of a rocking frame is off by up to {listed(said)}." if said else ""


def cart_sentence(lines: pd.DataFrame) -> str:
    """Say for each preset how far off the peaks on carts are; empty without any."""
    said = [f"{part(most)} {words}" for words, most in _largest(lines, "largest_error")]
    return f"The peak of a block on a cart is off by up to {listed(said)}." * bool(said)


def slide_sentence(lines: pd.DataFrame) -> str:
    """Say for each preset how far off the slips are; empty without any."""
    largest = _largest(lines, "largest_slip_error_m")
    said = [f"{float(f'{1e3 * most:.2g}'):g} mm {words}" for words, most in largest]
    return f"The slips of a block are off by up to {listed(said)}." if said else ""


def _largest(lines: pd.DataFrame, column: str) -> list[tuple[str, float]]:
    presets = lines["source"].map(preset_of)
    return [
        (in_words(preset), float(lines.loc[presets == preset, column].max()))
        for preset in in_order(presets)
    ]


def floor_sentence(lines: pd.DataFrame) -> str:
    """Say which ways of moving a floor carry a block, and which not; empty without any."""
    if lines.empty:
        return ""
    alone = lines["floor"] == "position"
    left = lines[~alone & (lines["carried"] > RIDES) & ~(lines["carried_after_rest"] > RIDES)]
    asleep = [ENGINES[str(name)].title for name in left["engine"].unique()]
    slept = f"; after a second of rest it sleeps on in {listed(asleep)}" if asleep else ""
    most, least = lines.loc[alone, "carried"].abs().max(), lines.loc[~alone, "carried"].min()
    return (
        f"A floor that is moved by position alone carries a block by no more than {part(most)} of "
        f"its way, one moved by the other ways by {part(least)} and more{slept}."
    )
