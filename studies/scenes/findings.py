"""What the summaries of frames, slides and floors show, in a sentence each."""

from __future__ import annotations

import pandas as pd

from engines import ENGINES
from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import listed
from studies.measures.words import part as share

LATE_M = 1e-4
"""From which lag on a floor is late [m]."""

RIDES = 0.9
"""Part of a floor's way over which a block that rides on it is carried at least."""


def frame_sentence(lines: pd.DataFrame) -> str:
    """Say for each preset how far off the engines' frames are."""
    if lines.empty:
        return "No engine that was asked is built for frames."
    said = [
        f"{in_words(preset)} by up to {share(found['largest_error'].max())} "
        f"(median {share(found['median_error'].median())}{_wrong(found)})"
        for preset, found in _by_preset(lines)
    ]
    return f"The peak of a rocking frame is off {', '.join(said)}."


def slide_sentence(lines: pd.DataFrame) -> str:
    """Say for each preset how far off the slips are, and who creeps or lifts."""
    if lines.empty:
        return "No engine was asked about slides."
    said = [
        f"{in_words(preset)} by up to {_mm(part['largest_slip_error_m'].max())}"
        for preset, part in _by_preset(lines)
    ]
    creeps, lifts = (
        lines.sort_values(name).dropna(subset=[name]).iloc[-1] for name in ("creep_m", "lift_m")
    )
    return (
        f"The slips of a block are off {', '.join(said)}; held at nine tenths of its friction "
        f"for two seconds it creeps by up to {_mm(creeps['creep_m'])} ({creeps['source']}), and "
        f"one launched along its base lifts by up to {_mm(lifts['lift_m'])} ({lifts['source']})."
    )


def floor_sentence(lines: pd.DataFrame) -> str:
    """Say which ways of moving a floor carry a block, and which not; empty without any."""
    if lines.empty:
        return ""
    alone = lines["floor"] == "position"
    left = lines[~alone & (lines["carried"] > RIDES) & ~(lines["carried_after_rest"] > RIDES)]
    asleep = [ENGINES[str(name)].title for name in left["engine"].unique()]
    slept = f"; after a second of rest it sleeps on in {listed(asleep)}" if asleep else ""
    most = share(float(lines.loc[alone, "carried"].abs().max()))
    engines = lines.loc[alone, "engine"].nunique()
    least = lines.loc[~alone, "carried"].min()
    return (
        f"A floor that is moved by position alone carries a block by no more than {most} of its "
        f"way in any of {engines} engines, one moved by the other ways by {share(least)} and "
        f"more{slept}."
    )


def block_sentence(lines: pd.DataFrame) -> str:
    """Say what floors that lag cost a block's peak; empty where none does."""
    late = lines[lines["floor_lag_m"] > LATE_M]
    said = [
        f"{row['source']}, whose floor lags by up to {_mm(row['floor_lag_m'])}, errs by "
        f"{share(row['median_error'])}, "
        f"on the floor as it moved by {share(row['median_own_error'])}"
        for row in late.to_dict("records")
    ]
    return f"In the median {'; '.join(said)}." if said else ""


def _wrong(part: pd.DataFrame) -> str:
    wrong = part[part["wrong"] > 0]
    named = [
        f"{engine_of(row['source'])} {row['wrong']} of {row['frames']}"
        for row in wrong.to_dict("records")
    ]
    return f"; the outcome wrong: {', '.join(named)}" if named else ""


def _by_preset(lines: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    presets = lines["source"].map(preset_of)
    return [(preset, lines[presets == preset]) for preset in in_order(presets)]


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.2g} mm"
