"""Engines pulse by pulse over twelve planes, of blocks that similarity makes alike."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import Delayed
from studies.cases.paper import PULSES
from studies.kit.jobs import Job, Question
from studies.kit.say import part
from studies.measures.presets import titled
from studies.measures.wrongness import FALL, KINDS, kinds_of
from studies.sources.registry import resolve

ASPECTS, WIDTHS_M = (2.0, 3.0, 4.0), (0.5, 2.0)
RATIOS = tuple((0.5 * np.arange(1, 17)).tolist())
ONSETS = tuple((1.0 + 0.6 * (np.arange(15) + 0.5)).tolist())
"""ω/p, and amplitudes over g tan α."""
CLOSE = 0.1
"""A peak within this part of the exact one is close."""
CASE = ["pulse", "aspect", "width_m", "onsets", "omega_over_p", "rest_s"]
RIGHT, FALSE, MISSED, OFF, INVALID = "right", "false", "missed", "peak off", "invalid"
"""Verdicts, beside kinds of wrong outcomes; invalid where the block should slide or lift off."""


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each pulse, block and source."""
    every = 3 if quick else 1
    pulses, aspects = (("full-sine",), (3.0,)) if quick else (tuple(PULSES), ASPECTS)
    found = []
    for pulse, aspect, width_m, onsets, ratio in product(
        pulses, aspects, WIDTHS_M, ONSETS[::every], RATIOS[::every]
    ):
        block, motion = posed(pulse, aspect, width_m, onsets, ratio)
        # before every other pulse of a plane all is at rest, and an engine may fall asleep
        rest_s = float((ONSETS.index(onsets) + RATIOS.index(ratio)) % 2)
        labels = {
            **{"pulse": pulse, "aspect": aspect, "width_m": width_m},
            "amplitude_g": onsets * math.tan(block.alpha),
            **{"onsets": onsets, "omega_over_p": ratio, "rest_s": rest_s},
        }
        case = Question(system=block, motion=Delayed(motion, rest_s) if rest_s else motion)
        found += [Job(labels=labels, case=case, source=source) for source in sources]
    return found


def posed(
    pulse: str, aspect: float, width_m: float, onsets: float, omega_over_p: float
) -> tuple[RigidBlock, SinePulse]:
    """Return the block and the pulse of a case, whose amplitude is so many times g tan α."""
    block = RigidBlock(width=width_m, height=aspect * width_m)
    return block, SinePulse(
        amplitude=onsets * math.tan(block.alpha) * block.gravity,
        omega=omega_over_p * block.p,
        half_cycles=PULSES[pulse],
    )


def verdicts(found: ArrayLike, exact: ArrayLike) -> NDArray[np.str_]:
    """Return for each outcome RIGHT, FALSE or MISSED (of an overturning), or its other kind."""
    kinds = kinds_of(found, exact)
    side = np.where(np.asarray(exact) == "overturned", MISSED, FALSE)
    return np.select([kinds == "", kinds == FALL], [RIGHT, side], kinds)


def with_verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Add to the rows of planes the error of a peak and the verdict."""
    exact = rows[rows["source"] == "exact"].set_index(CASE)[["outcome", "peak_ratio"]]
    # of the block without the rest before; inf if it would lift off
    exact["needed"] = [simulate(*posed(*case[:-1])).friction_needed for case in exact.index]
    right = exact.reindex(pd.MultiIndex.from_frame(rows[CASE])).reset_index(drop=True)
    found = rows.reset_index(drop=True)
    verdict = verdicts(found["outcome"], right["outcome"])
    with np.errstate(invalid="ignore"):
        error = (found["peak_ratio"] / right["peak_ratio"] - 1.0).where(
            (verdict == RIGHT) & (right["outcome"] != "overturned")
        )
    asked = {name: resolve(name) for name in found["source"].unique()}
    friction = {name: it.used.settings.friction for name, it in asked.items() if it.engine}
    slides = right["needed"] > found["source"].map(friction)
    verdict = np.where(slides, INVALID, np.where(error.abs() > CLOSE, OFF, verdict))
    return found.assign(error=error, verdict=verdict)


def tables(rows: pd.DataFrame) -> Mapping[str, pd.DataFrame]:
    """Return the rows, and a line for each engine and width, and for each engine and rest."""
    known = with_verdicts(rows)
    written = known.drop(columns="error")
    known = known[(known["source"] != "exact") & (known["verdict"] != INVALID)]
    sides = {"false_overturnings": FALSE, "missed_overturnings": MISSED}
    verdict = known["verdict"].replace({FALSE: FALL, MISSED: FALL})
    known = known.assign(
        **{kind: verdict == kind for kind in KINDS},
        **{name: known["verdict"] == side for name, side in sides.items()},
        **{"close": verdict == RIGHT, "far": verdict == OFF, "size": known["error"].abs()},
    )

    def sums(*names: str) -> dict[str, tuple[str, str]]:
        return {name: (name, "sum") for name in names}

    by_width, by_rest = (known.groupby(["source", by], sort=False) for by in ("width_m", "rest_s"))
    parts = by_width.agg(
        cases=("close", "size"),
        **sums("close", "far", *sides),
        median_error=("size", "median"),
        p90_error=("size", lambda size: size.quantile(0.9)),
        **sums("wall_s", *KINDS),
    )
    rests = by_rest.agg(cases=("close", "size"), **sums("close", *KINDS))
    return {"defaults": written, "parts": parts.reset_index(), "rests": rests.reset_index()}


def finding(parts: pd.DataFrame) -> str:
    """Say between which parts of the pulses the engines predict."""
    sums = parts.groupby("source", sort=False)[["close", "cases"]].sum()
    shares = (sums["close"] / sums["cases"]).sort_values()
    if shares.empty:
        return "The exact solution stands alone: --sources names no engine."
    ends = [f"{titled(name)} predicts {part(shares[name])}" for name in shares.index[[0, -1]]]
    return f"{' and '.join(dict.fromkeys(ends))} of the pulses, with peaks within {part(CLOSE)}."
