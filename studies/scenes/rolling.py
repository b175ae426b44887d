"""The cylinders that roll, which every engine in space is asked about."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

from analytic import RollingCylinder, Still
from studies.kit.jobs import Job
from studies.measures.rolling import TURNS
from studies.scenes.places import own_step

CYLINDERS = (
    RollingCylinder(radius=0.5, height=0.5, tilt=0.2),
    RollingCylinder(radius=0.5, height=2.0, tilt=0.1),
    RollingCylinder(radius=1.0, height=0.1, tilt=0.3),
)
"""A flat one, a tall one and a coin."""

PARTS = (1.0, 0.5)
"""Parts of its step at which a source is asked about the fewest turns."""


def cylinders(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of cylinders that roll.

    Parameters
    ----------
    sources : sequence of str
        Names; asked are exact and the engines with equal steps.
    quick : bool
        One cylinder over the fewest turns.

    Yields
    ------
    Job
        Its labels are scene, radius_m, height_m, tilt_rad, turns and step_part, the part of its own
        step at which a source is asked.
    """
    for cylinder, source in product(CYLINDERS[: 1 if quick else None], sources):
        sizes = {"radius_m": cylinder.radius, "height_m": cylinder.height}
        sizes["tilt_rad"] = cylinder.tilt
        step = own_step(source, cylinder.p)
        equal = math.isfinite(step)
        if not equal and source != "exact":
            continue
        for turns in TURNS[: 1 if quick else None]:
            for part in PARTS if equal and turns == TURNS[0] else PARTS[:1]:
                yield Job(
                    labels={"scene": "cylinder", **sizes, "turns": turns, "step_part": part},
                    block=cylinder,
                    motion=Still(),
                    source=source,
                    duration=turns * cylinder.turn,
                    options={} if part == 1.0 else {"step": part * step},
                )
