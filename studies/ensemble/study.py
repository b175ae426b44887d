"""Many motions, blocks and intensities: are statistics predicted where single responses are not?"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from analytic.record import Record
from analytic.synthetic import kanai_tajimi, near_fault, ricker
from studies.cases.accelerograms import Baseline, Units, recorded
from studies.drawing.kept import tell
from studies.ensemble import STUDY
from studies.ensemble.agreement import (
    BLOCK,
    BOUNDS,
    CLOSE,
    DIGITS,
    LEVEL,
    Fragilities,
    bounds,
    confusion,
    settled,
    share_bounds,
)
from studies.kit.arguments import (
    Count,
    Out,
    Place,
    Yes,
    one_of,
    refuse_given,
    refuse_repeats,
    several_or_none,
)
from studies.kit.jobs import Job
from studies.kit.naming import sources_option
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import write_table
from studies.measures.words import listed
from studies.sources.registry import core_sources


def noise(seed: int) -> Record:
    """Return 12 s of noise on firm soil, strong for 3 s."""
    return kanai_tajimi(seed, peak=1.0, duration=12.0, omega=12.0, rise=2.0, fall=5.0)


def pulses(seed: int) -> Record:
    """Return a near-fault pulse of 0.5 to 2 Hz, of 1.2 to 3 cycles and any phase."""
    draw = np.random.default_rng(seed)
    frequency = math.exp(draw.uniform(math.log(0.5), math.log(2.0)))
    gamma, phase = draw.uniform(1.2, 3.0), draw.uniform(0.0, 2.0 * math.pi)
    return near_fault(1.0, frequency, gamma, phase).scaled_to(1.0)


def wavelets(seed: int) -> Record:
    """Return a Ricker wavelet of 0.5 to 4 Hz."""
    draw = np.random.default_rng(seed)
    return ricker(1.0, math.exp(draw.uniform(math.log(0.5), math.log(4.0))))


FAMILIES: Mapping[str, Callable[[int], Record]] = {
    "noise": noise,
    "near-fault": pulses,
    "ricker": wavelets,
}
"""Name -> the motion of a seed, its largest absolute acceleration being 1 m/s2."""


Family = Literal["noise", "near-fault", "ricker"]

SIZES_M = ((0.5, 1.5), (1.0, 2.0), (1.0, 4.0))
"""Width and height of the blocks."""

INTENSITIES = (1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest ground acceleration over the one that lifts the block, g tan alpha."""

STRONGER = 1.01
"""Every case is also solved exactly with its motion this many times as strong: what the response
itself makes of a small uncertainty, beside which the sources' errors are to be seen."""

QUICK_SIZES_M = SIZES_M[:1]
QUICK_INTENSITIES = INTENSITIES[1:4]
QUICK_MOTIONS = 8

BESIDE = sources_option("Beside the exact solution: ")
DEFAULT_SOURCES = (
    *("housner", "modified"),
    *core_sources("naive"),
    *core_sources(),
)

MOTION_BYTES = 1.2e4
"""About what a motion scaled to an intensity holds."""


def drawn(family: str, count: int, seed: int) -> list[Record]:
    """Draw motions of a family; motion i of a seed has the seed 10^6 seed + i."""
    return [FAMILIES[family](10**6 * seed + i) for i in range(count)]


def ensemble_jobs(
    family: str,
    motions: Sequence[Record],
    sources: Sequence[str],
    sizes: Sequence[tuple[float, float]] = SIZES_M,
    intensities: Sequence[float] = INTENSITIES,
) -> Iterator[Job]:
    """Yield the jobs that put every case to some sources, and a stronger one to the exact."""
    for (number, motion), size, intensity in product(enumerate(motions), sizes, intensities):
        block = RigidBlock(width=size[0], height=size[1])
        for strength, asked in ((1.0, sources), (STRONGER, ("exact",))):
            peak = strength * intensity * (block.gravity * size[0] / size[1])
            motion = motion.scaled_to(peak)
            labels = {
                **{"family": family, "motion": number, "width_m": size[0], "height_m": size[1]},
                **{"intensity": intensity, "strength": strength},
            }
            for source in asked:
                yield Job(labels=labels, block=block, motion=motion, source=source)


def command(
    *,
    out: Out,
    family: Annotated[Family, one_of(Family)] | None = None,
    motions: Count | None = None,
    seed: Count | None = None,
    records: Annotated[tuple[Place, ...] | None, several_or_none] = None,
    units: Annotated[Units, one_of(Units)] | None = None,
    baseline: Annotated[Baseline, one_of(Baseline)] | None = None,
    sources: Annotated[tuple[str, ...], BESIDE] = DEFAULT_SOURCES,
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
    yes: Yes = False,
) -> int:
    """Shake blocks by many motions of rising intensity, through every named source.

    Parameters
    ----------
    family
        noise, the default: Kanai-Tajimi noise under an envelope; near-fault: pulses of Mavroeidis
        and Papageorgiou; ricker: wavelets.
    motions
        Number of motions; 40 by default, 8 with --quick.
    seed
        Seed of the motions, a positive whole number, 1 by default; another one draws others.
    records
        Recorded accelerograms instead of a family, files as `rocking compare --record` takes them;
        at best several.
    units
        Of the records' acceleration: needed where a file does not state them, refused where one
        states others.
    baseline
        Correct the records by what scipy.signal.detrend takes away: their mean (constant) or the
        line that fits them best (linear).
    sources
        Who is asked beside the exact solution.
    quick
        One block and three intensities.
    """
    sizes, intensities = (QUICK_SIZES_M, QUICK_INTENSITIES) if quick else (SIZES_M, INTENSITIES)
    if records is not None:
        refuse_given({"family": family, "motions": motions, "seed": seed}, "only without --records")
        refuse_repeats("--records", records)
        name, ground = "records", recorded(records, units, baseline)
    else:
        refuse_given({"units": units, "baseline": baseline}, "only with --records")
        name, count = family or "noise", motions or (QUICK_MOTIONS if quick else 40)
        many, everyone = count * len(sizes) * len(intensities), ("exact", "exact", *sources)
        running.refuse_too_much(
            f"--motions is {count}", many, everyone, yes=yes, case_bytes=MOTION_BYTES
        )
        ground = drawn(name, count, seed or 1)
    asked = list(dict.fromkeys(["exact", *sources]))
    jobs = list(ensemble_jobs(name, ground, asked, sizes, intensities))
    settings = {
        "motions": [path.name for path in records] if records else [name, str(seed or 1)],
        "sizes_m": sizes,
        "intensities": intensities,
        **({"baseline": baseline or "none"} if records else {}),
    }
    growing = {"motion": range(len(ground)), "source": asked}
    plan = Plan(jobs=jobs, settings=settings, growing=growing)
    return carry_out(STUDY, plan, out, running, report)


POINTS = 60
"""Points of a fragility curve."""

ONE_BY_ONE = [
    *(*BLOCK, "source", "cases", "failed", "right", "false", "missed"),
    *("median_error", "p90_error", "predicted"),
]
IN_DISTRIBUTION = [
    *(*BLOCK, "source", "ks", "ks_p", "mcnemar_p", "capacity", "capacity_ratio"),
    *("ratio_low", "ratio_high", "ratio_at_edge", "beta"),
]
SETTLED = dict.fromkeys(("capacity", "capacity_ratio", *BOUNDS), DIGITS)
"""Digits after the point of what motions that are drawn again leave open."""


def read_rows(folder: Path) -> pd.DataFrame:
    """Read ensemble.csv; the exact solution of stronger motions is a source of its own."""
    rows = pd.read_csv(folder / "ensemble.csv", dtype={"message": str})
    stronger = rows["source"] + rows["strength"].map(" at {:g}".format)
    return rows.assign(source=rows["source"].where(rows["strength"] == 1.0, stronger))


def report(folder: Path) -> str:
    """Reduce a folder's ensemble.csv to its tables, its drawing and its findings; return these."""
    rows = read_rows(folder)
    fitted, agreed = settled(rows)
    tables = {"stripes": stripes(rows), "curves": curves(rows, fitted), "agreement": agreed}
    tables["confusion"] = confusion(rows)
    for name, table in tables.items():
        write_table(folder / f"{name}.csv", table)
    by = ["source", "exact_outcome", "outcome"]
    outcomes = tables["confusion"].groupby(by, sort=False)["cases"].sum().unstack(fill_value=0)
    others = agreed[agreed["source"] != "exact"]
    shown = {
        f"Single responses, predicted within {CLOSE:g} (exact at 1.01: the exact solution of "
        "motions 1 % stronger)": others[ONE_BY_ONE],
        f"Distributions, and the capacity over the exact one with bounds of "
        f"{agreed['resamples'].max()} samples of the motions (at_edge: one lies at the least or "
        "the largest intensity, or beyond)": agreed[IN_DISTRIBUTION].round(SETTLED),
        f"Tests of all blocks that tell statistics from the exact ones, at the level {LEVEL:g} "
        "(Kolmogorov and Smirnov's errs on the side of equality, the others are paired)": (
            told(others)
        ),
        "Outcomes beside the exact ones, all blocks and intensities": outcomes.reset_index(),
    }
    motions, levels = rows["motion"].nunique(), sorted(rows["intensity"].unique())
    head = (
        f"{motions} motions of {rows['family'].iloc[0]!r} at {len(levels)} intensities "
        f"(PGA over g tan α: {', '.join(f'{level:g}' for level in levels)})."
    )
    return tell(STUDY, folder, shown, f"{finding(agreed)} {head}")


def finding(agreed: pd.DataFrame) -> str:
    """Say whose statistics tests tell from the exact ones, and whose they do not."""
    tests = told(agreed[agreed["source"] != "exact"]).set_index("source")
    any_does = tests[["capacity_off", "mcnemar_rejected", "ks_rejected"]].any(axis=1)
    found, untold = (listed(list(tests.index[some])) for some in (any_does, ~any_does))
    if not any_does.any():
        return f"Over many records, no test tells the statistics of {untold} from the exact ones."
    rest = "" if any_does.all() else f"; not those of {untold}"
    return f"Over many records, tests tell from the exact statistics those of {found}{rest}."


def told(agreed: pd.DataFrame) -> pd.DataFrame:
    """Return for each source the tests that tell its statistics from the exact ones, of all blocks.

    Parameters
    ----------
    agreed : DataFrame
        Lines of agreement.csv, without those of the exact solution.

    Returns
    -------
    DataFrame
        predicted: share of the single responses that are; capacity_off: blocks whose interval of
        the ratio of capacities leaves out 1; mcnemar_rejected: those of which as many overturn
        falsely as are missed is no chance; ks_rejected of ks_tests distributions.
    """
    lines = agreed.assign(
        predicted=agreed["predicted"] * agreed["cases"],
        blocks=1,
        capacity_off=(agreed["ratio_low"] > 1.0) | (agreed["ratio_high"] < 1.0),
        mcnemar_rejected=agreed["mcnemar_p"] < LEVEL,
    )
    kept = ["cases", "predicted", "blocks", "capacity_off", "mcnemar_rejected"]
    table = lines.groupby("source", sort=False)[[*kept, "ks_rejected", "ks_tests"]].sum()
    return table.assign(predicted=table["predicted"] / table["cases"]).reset_index()


def stripes(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the share overturned of each block, source and intensity, with its bounds."""
    counted = rows.assign(
        **{name: rows["outcome"] == name for name in ("failed", "overturned")},
        cases=rows["outcome"] != "failed",
    ).groupby([*BLOCK, "source", "intensity"], sort=False)
    table = counted[["cases", "failed", "overturned"]].sum()
    pairs = table[["overturned", "cases"]].to_numpy().tolist()
    low, high = zip(*(share_bounds(*pair) for pair in pairs), strict=True)
    return table.assign(
        share=table["overturned"] / table["cases"],
        share_low=low,
        share_high=high,
        median_peak=counted["peak_ratio"].median(),
    ).reset_index()


def curves(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return the fitted probability of overturning against intensity, with its bounds."""
    grid = np.geomspace(0.7 * rows["intensity"].min(), 1.2 * rows["intensity"].max(), POINTS)
    parts = []
    for names, known in fitted.items():
        low, high = bounds(known.resampled.probability(grid))
        columns = {
            **dict(zip([*BLOCK, "source"], names, strict=True)),
            "intensity": grid,
            "probability": known.fit.probability(grid),
            "low": low,
            "high": high.clip(max=1.0),
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)
