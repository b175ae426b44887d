"""Engines as documented, asked over the plane of pulses, of blocks that similarity makes alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import Delayed
from engines import ENGINES
from engines.disclosure import Deviation
from studies.cases.paper import PULSES
from studies.defaults import STUDY
from studies.drawing.kept import tell
from studies.drawing.styles import engine_title
from studies.old.arguments import Out
from studies.old.jobs import Job
from studies.old.naming import Sources
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, carry_out
from studies.old.tables import write_table
from studies.measures.words import listed, part
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, kinds_of
from studies.sources.registry import core_sources, resolve

if TYPE_CHECKING:
    from pandas.core.groupby import DataFrameGroupBy

ASPECTS, WIDTHS_M = (2.0, 3.0, 4.0), (0.5, 2.0)
RATIOS = tuple((0.5 * np.arange(1, 17)).tolist())
"""ω/p."""
ONSETS = tuple((1.0 + 0.6 * (np.arange(15) + 0.5)).tolist())
"""Amplitudes over g tan α."""
REST_S = 1.0
"""For how long all is at rest before every other pulse [s], in which an engine may fall asleep."""

QUICK_ASPECTS, QUICK_PULSES, QUICK_EVERY = (3.0,), ("full-sine",), 3
DEFAULT_SOURCES = ("exact", *core_sources("naive"))


def command(
    *,
    out: Out,
    sources: Sources = DEFAULT_SOURCES,
    frame: Literal["base", "world"] | None = None,
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Ask engines as documented over frequency and amplitude of a pulse, and two sizes of a block.

    Parameters
    ----------
    sources
        Who is asked; the exact solution always is.
    frame
        base: the motion of the base is a body force; world: the engines move the base. By default
        as an engine's documentation does it.
    quick
        Full sines at H/B 3 alone, and every third frequency and amplitude.
    """
    asked = tuple(dict.fromkeys(("exact", *sources)))
    plan = Plan(
        jobs=grid_jobs(asked, frame, quick),
        settings={"frame": frame, "quick": quick},
        growing={"source": asked},
        needed=lambda rows: [row for row in rows if row["source"] == "exact"],
    )
    return carry_out(STUDY, plan, out, running, report)


def grid_jobs(sources: Sequence[str], frame: str | None, quick: bool) -> list[Job]:
    """Return a job for each pulse, block and source."""
    every = QUICK_EVERY if quick else 1
    cases = product(
        QUICK_PULSES if quick else PULSES,
        QUICK_ASPECTS if quick else ASPECTS,
        WIDTHS_M,
        ONSETS[::every],
        RATIOS[::every],
    )
    jobs = []
    for pulse, aspect, width_m, onsets, ratio in cases:
        block, motion = posed(pulse, aspect, width_m, onsets, ratio)
        labels = {
            "pulse": pulse,
            "aspect": aspect,
            "width_m": width_m,
            "amplitude_g": onsets * math.tan(block.alpha),
            "onsets": onsets,
            "omega_over_p": ratio,
            # every other pulse of a map
            "rest_s": REST_S * ((ONSETS.index(onsets) + RATIOS.index(ratio)) % 2),
        }
        shaken = Delayed(motion, REST_S) if labels["rest_s"] else motion
        for source in sources:
            options = {"frame": frame} if frame and resolve(source).engine else {}
            jobs.append(
                Job(labels=labels, block=block, motion=shaken, source=source, options=options)
            )
    return jobs


def report(folder: Path) -> str:
    """Reduce and draw a folder's defaults.csv; return the findings as text."""
    rows = read(folder)
    parts, rested = shares(rows), rests(rows)
    write_table(folder / "parts.csv", parts)
    write_table(folder / "rests.csv", rested)
    tables = {
        "Pulses by the width of the block": parts,
        "Pulses by the rest before them": rested,
        f"Part of the pulses in which two widths differ in outcome or by {CLOSE:g}": similarity(
            rows
        ),
    }
    return tell(STUDY, folder, tables)


def read(folder: Path) -> pd.DataFrame:
    """Read a defaults.csv back, with a verdict on every row."""
    rows = pd.read_csv(folder / "defaults.csv", dtype={"message": str})
    return with_verdicts(rows.fillna({"message": ""}))


CLOSE = 0.1
"""A peak within this part of the exact one is close."""
CASE = ["pulse", "aspect", "width_m", "onsets", "omega_over_p", "rest_s"]
ALIKE = ["pulse", "aspect", "onsets", "omega_over_p", "source"]
"""Columns that similarity lets answers depend on."""

RIGHT = ("both rock", "both overturn")
OFF, FALSE, MISSED = "peak off", "false overturning", "missed overturning"
KIND = {FALSE: FALL, MISSED: FALL, REST: REST, NO_ANSWER: NO_ANSWER}
"""Verdict on a wrong outcome -> its kind; a fall that is wrong has two sides."""
INVALID = "invalid"
"""Where the block should slide or lift off, which the reference does not."""


def with_verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with the exact peak of each case, the relative error and a verdict."""
    exact = rows[rows["source"] == "exact"].set_index(CASE)[["outcome", "peak_ratio"]]
    needed = exact.index.to_frame(index=False).apply(friction_needed, axis=1).to_numpy()
    right = exact.assign(needed=needed).reindex(pd.MultiIndex.from_frame(rows[CASE]))
    found, over = rows["outcome"].to_numpy(), right["outcome"].to_numpy() == "overturned"
    with np.errstate(invalid="ignore"):
        error = rows["peak_ratio"].to_numpy() / right["peak_ratio"].to_numpy() - 1.0
    wrong = kinds_of(found, right["outcome"].to_numpy())
    verdict = np.select(
        [
            right["needed"].to_numpy() > rows["source"].map(friction_of).to_numpy(),
            wrong == NO_ANSWER,
            wrong == REST,
            (wrong == FALL) & over,
            wrong == FALL,
            over,
            np.abs(error) > CLOSE,
        ],
        [INVALID, NO_ANSWER, REST, MISSED, FALSE, RIGHT[1], OFF],
        RIGHT[0],
    )
    both_rocked = (wrong == "") & ~over
    return rows.assign(error=np.where(both_rocked, error, np.nan), verdict=verdict)


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


def friction_needed(case: pd.Series[Any]) -> float:
    """Return the friction without which the block would slide; inf if it would lift off."""
    return simulate(*posed(*case[CASE[:-1]])).friction_needed


def friction_of(source: str) -> float:
    """Return the friction of an engine's preset; that of a model is without bound."""
    engine, _, preset = source.partition(":")
    if engine not in ENGINES:
        return math.inf
    return float(ENGINES[engine].preset(preset or None).settings.friction)


def shares(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and width: how many pulses by verdict, and errors.

    Of pulses under which the block neither slides nor lifts off.
    """
    return (
        _judged(rows, "width_m")
        .agg(
            cases=("close", "size"),
            **_sums("close", "far", "false_overturnings", "missed_overturnings"),
            median_error=("size", "median"),
            p90_error=("size", lambda size: size.quantile(0.9)),
            **_sums("wall_s", *KINDS),
        )
        .reset_index()
    )


def rests(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and rest before the pulse: how many pulses by verdict."""
    counts = _judged(rows, "rest_s").agg(cases=("close", "size"), **_sums("close", *KINDS))
    return counts.reset_index()


def _judged(rows: pd.DataFrame, by: str) -> DataFrameGroupBy[Any, Any]:
    """Return the engines' rows that are judged, their verdicts as columns, by source and `by`."""
    rows = rows[(rows["source"] != "exact") & (rows["verdict"] != INVALID)]
    verdict = rows["verdict"]
    judged = rows.assign(
        close=verdict.isin(RIGHT),
        far=verdict == OFF,
        false_overturnings=verdict == FALSE,
        missed_overturnings=verdict == MISSED,
        size=rows["error"].abs(),
        **{kind: verdict.map(KIND) == kind for kind in KINDS},
    )
    return judged.groupby(["source", by], sort=False)


def _sums(*names: str) -> dict[str, tuple[str, str]]:
    return {name: (name, "sum") for name in names}


def rest_claim(table: pd.DataFrame) -> str:
    """Say which engines lose answers when all is at rest before a pulse; empty if none does."""
    said = []
    for source, found in table.groupby("source", sort=False):
        close = (found["close"] / found["cases"]).groupby(found["rest_s"] > 0.0).mean()
        if len(close) == 2 and close[False] - close[True] > CLOSE:
            ends = f"from {_whole(close[False])} to {_whole(close[True])}"
            asleep = Deviation.SLEEP in resolve(str(source)).used.deviations
            said.append(f"{engine_title(str(source))} falls {ends}{', asleep' * asleep}")
    return f"After 1 s of rest {listed(said)}." if said else ""


def finding(table: pd.DataFrame, rested: pd.DataFrame) -> str:
    """Say between which parts of all pulses the engines get right, and who loses by a rest.

    Parameters
    ----------
    table, rested : DataFrame
        The columns of parts.csv and of rests.csv.
    """
    sums = table.groupby("source", sort=False)[["close", "cases"]].sum()
    parts = (sums["close"] / sums["cases"]).sort_values()
    ends = dict.fromkeys(
        f"{_whole(parts[name])} ({engine_title(str(name))})" for name in parts.index[[0, -1]]
    )
    said = (
        f"As documented, outcome and peak (within {part(CLOSE)}) are right in "
        f"{' to '.join(ends)} of {int(sums['cases'].iloc[0])} pulses that neither slide a block "
        "nor lift it off."
    )
    return " ".join(filter(None, (said, rest_claim(rested))))


def _whole(value: float) -> str:
    """Return a part in whole per cent, and all of it only where it is all."""
    return "all" if value == 1.0 else f"{min(value, 0.99):.0%}".replace("%", " %")


def similarity(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: the part of pulses in which two blocks answer differently.

    The smallest and the largest, which by similarity answer alike; outcomes differ, or peaks by
    more than CLOSE.
    """
    rows = rows[rows["verdict"] != INVALID]
    widths = rows["width_m"]
    pair = [
        rows[widths == width].set_index(ALIKE)["peak_ratio"]
        for width in (widths.min(), widths.max())
    ]
    small, large = pair[0].align(pair[1], join="inner")
    both = np.isfinite(small) & np.isfinite(large)
    differ = (small != large) & ~(both & ((small - large).abs() <= CLOSE * small.abs()))
    differ &= ~(small.isna() & large.isna())
    parts = differ.groupby(level="source", sort=False).mean()
    return pd.DataFrame({"source": parts.index, "differ": parts.to_numpy()})
