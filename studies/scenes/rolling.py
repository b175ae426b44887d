"""The cylinders that roll, which every engine in space is asked about, and what becomes of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import pandas as pd

from analytic import RollingCylinder, Still
from analytic.response import RollingOutcome
from engines.declaration import Stepping
from studies.kit.jobs import Job
from studies.measures.rolling import ERRORS, TURNS
from studies.sources.registry import resolve

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
    for cylinder in CYLINDERS[: 1 if quick else None]:
        sizes = {"radius_m": cylinder.radius, "height_m": cylinder.height}
        sizes["tilt_rad"] = cylinder.tilt
        for source in sources:
            asked = resolve(source)
            equal = asked.engine and asked.used.stepping is Stepping.FIXED
            if not equal and source != "exact":
                continue
            step = _step(source, cylinder) if equal else math.nan
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


def _step(source: str, cylinder: RollingCylinder) -> float:
    """Return the ordinary step of an engine in units of 1/p."""
    used = resolve(source).used
    return used.step if math.isfinite(used.step) else used.step_s * cylinder.p


def cylinder_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of cylinders without what is told of blocks alone."""
    kept = rows.drop(columns=["scene", "peak_ratio", "impacts"], errors="ignore")
    return kept.rename(columns={"outcome": "became"})


def cylinder_summary(rows: pd.DataFrame) -> pd.DataFrame:
    """Return for each source and number of turns how far off its cylinders are, at most.

    Those that do not roll on count as lost; half_step_tilt_error_rad is at half of the step.
    """
    lines = []
    for (source, turns), part in _asked(rows):
        whole, half = (part[part["step_part"] == step] for step in PARTS)
        sizes = whole[list(ERRORS)].abs().max()
        lines.append(
            {
                "source": source,
                "turns": turns,
                "cylinders": len(whole),
                "lost": int((whole["outcome"] != RollingOutcome.ROLLED.value).sum()),
                **sizes.to_dict(),
                "half_step_tilt_error_rad": half["tilt_error_rad"].abs().max(),
                "tilt_growth": whole["tilt_growth"].max(),
                "phase_growth": whole["phase_growth"].max(),
                "us_a_step": 1e6 * whole["wall_s"].sum() / max(whole["steps"].sum(), 1),
            }
        )
    return pd.DataFrame(lines)


def _asked(rows: pd.DataFrame) -> list[tuple[tuple[str, float], pd.DataFrame]]:
    if rows.empty:
        return []
    asked = rows[rows["reason"].fillna("") != "UNAVAILABLE"]
    return list(asked.groupby(["source", "turns"], sort=False))  # type: ignore[arg-type]
