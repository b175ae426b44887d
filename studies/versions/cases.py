"""The short study that each release is asked."""

import math
from collections.abc import Iterable
from itertools import islice
from typing import Any

from analytic.block import Rocker
from analytic.motion import Motion
from engines import ENGINES
from studies.cases.drawn import RandomCase, draw
from studies.cases.paper import Case, sweep_cases
from studies.kit.jobs import Job
from studies.versions.releases import Release

FIGURE, SEED = 8, 1
"""Figure of the paper whose cases are asked, and the seed of the random ones."""

RANDOM = 50
"""Random cases, the first ones of `rocking validate`."""

STEP = 1e-3
"""p dt of presets with equal steps of their own choice: finer ones see no more of a change."""

EVERY = 10
"""One in so many cases is asked where it is to be quick."""


def jobs_of(release: Release, quick: bool) -> list[Job]:
    """Return the jobs that put every case to every preset of the release that is installed."""
    return [
        Job(
            labels={"engine": release.engine, "release": release.version, **labels},
            block=block,
            motion=motion,
            source=f"{release.engine}:{preset.name}",
            options={} if math.isnan(preset.step) else {"step": STEP},
        )
        for labels, block, motion in posed(quick)
        for preset in ENGINES[release.engine].presets
    ]


def posed(quick: bool) -> list[tuple[dict[str, Any], Rocker, Motion]]:
    """Return labels, block and motion of every case: those of the figure, then random ones."""
    asked: dict[str, Iterable[Case | RandomCase]] = {
        f"figure {FIGURE}": sweep_cases([FIGURE]),
        "random": islice(draw(SEED), RANDOM),
    }
    every = EVERY if quick else 1
    return [
        (
            {
                "set": name,
                "case": number,
                "aspect": float(case.aspect),
                "width_m": case.width_m,
                "half_cycles": case.motion.half_cycles,
                "amplitude_g": case.amplitude_g,
                "omega_over_p": case.omega_over_p,
            },
            case.block,
            case.motion,
        )
        for name, cases in asked.items()
        for number, case in islice(enumerate(cases), 0, None, every)
    ]
