"""Many motions, blocks and intensities: are statistics predicted where single responses are not?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Annotated, Literal

from analytic.block import RigidBlock
from analytic.record import Record
from studies.cases.accelerograms import Baseline, Units, recorded
from studies.cases.motions import FAMILIES
from studies.ensemble import STUDY
from studies.ensemble.report import headline, pictures, report
from studies.kit.arguments import (
    Count,
    Out,
    Place,
    check_sources,
    one_of,
    refuse_given,
    refuse_repeats,
    several_or_none,
)
from studies.kit.jobs import Job
from studies.kit.naming import sources_option
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.sources.groups import core_sources

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

__all__ = ["command", "headline", "pictures", "report"]


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
    yes: bool = False,
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
        Of the records' acceleration, where the files do not state them.
    baseline
        Correct the records by what scipy.signal.detrend takes away: their mean (constant) or the
        line that fits them best (linear).
    sources
        Who is asked beside the exact solution.
    quick
        One block and three intensities.
    yes
        Begin even what takes longer than a day.
    """
    check_sources(sources)
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
