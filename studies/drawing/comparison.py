"""How a comparison is shown: as JSON, as a table, as time histories over each other."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic import simulate
from analytic.block import RigidBlock
from analytic.motion import Motion, SinePulse
from analytic.record import Record
from analytic.response import Outcome, Response
from analytic.simulate import strongest
from studies.cases.paper import PULSES
from studies.kit.journal import Row
from studies.measures.differences import scientific

DRIFT = 1e-6
"""Part of its largest velocity up to which a base that comes to rest may miss it, by rounding."""


def json_lines(rows: list[Row], note: str = "") -> str:
    """Return one JSON object a line; a peak that is not finite is null, a note in each message."""
    names = ("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message")
    objects: list[dict[str, Any]] = [{name: row[name] for name in names} for row in rows]
    for item in objects:
        item["message"] = "; ".join(words for words in (item["message"], note) if words)
        if not math.isfinite(item["peak_ratio"]):
            item["peak_ratio"] = None
    return "\n".join(json.dumps(item, allow_nan=False) for item in objects)


def table_text(
    block: RigidBlock, motion: Motion, window: float, rows: list[Row], note: str = ""
) -> str:
    """Return the table with its head, a note on the motion in it, and the messages under it."""
    table = pd.DataFrame(
        {
            "source": [row["source"] for row in rows],
            "outcome": [row["outcome"] for row in rows],
            "θmax/θcr": [_peak(row) for row in rows],
            "vs exact": [_difference(row) for row in rows],
            "impacts": [row["impacts"] for row in rows],
            "ratio": [_fixed(row["velocity_ratio"]) for row in rows],
            "slip/B": [_slip(row["response"].slip_m / block.width) for row in rows],
            "steps": [row["steps"] for row in rows],
            "time": [_duration(row["wall_s"]) for row in rows],
        }
    )
    notes = [f"{row['source']}: {row['message']}" for row in rows if row["message"]]
    return "\n".join(
        [
            f"block   B = {block.width:g} m, H = {block.height:g} m: "
            f"α = θcr = {block.alpha:.5g} rad, p = {block.p:.5g} rad/s",
            f"ground  {motion_name(motion)}, {strongest(motion) / block.gravity:.6g} g, "
            f"{motion_details(motion)}; observed for {window:.4g} s",
            *([f"base    {note}"] if note else []),
            f"ratio   velocity after over before an impact, the median; Housner's η = "
            f"{block.restitution:.6g}",
            f"valid   {validity(block, motion)}",
            "",
            table.to_string(index=False),
            *notes,
        ]
    )


def validity(block: RigidBlock, motion: Motion) -> str:
    """Say what the exact solution needs to be one: no slip, no lift-off of the pivot."""
    exact = simulate(block, motion)
    if exact.outcome is Outcome.FAILED:
        return "unknown: there is no exact solution to tell"
    if exact.min_normal < 0.0:
        return "not here: the pivot would lift off, and an engine is right to differ"
    least = f"the normal force stays above {exact.min_normal:.3g} of the weight"
    return f"with friction of {exact.friction_needed:.3g} or more; {least}"


def pulse_name(half_cycles: int) -> str:
    """Return what a pulse of so many half cycles is called."""
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(half_cycles, f"{half_cycles} half cycles")


def motion_name(motion: Motion) -> str:
    """Return what a ground motion is called."""
    return pulse_name(motion.half_cycles) if isinstance(motion, SinePulse) else "record"


def motion_details(motion: Motion) -> str:
    """Say what a reader needs to know of a ground motion besides its name and its peak."""
    if isinstance(motion, SinePulse):
        return f"{motion.omega:g} rad/s, {motion.duration:.4g} s"
    times = np.array(motion.breakpoints)
    speed = float(np.abs(motion.velocity(times)).max())
    step = motion.duration / (times.size - 1)
    return f"{speed:.3g} m/s, {times.size} samples every {step:.4g} s, {motion.duration:.4g} s"


def baseline_note(record: Record, baseline: str | None) -> str:
    """Say how a record was corrected, and what velocity it leaves the base with; or nothing."""
    words = [] if baseline in (None, "none") else [f"baseline corrected by detrend, {baseline}"]
    largest = float(np.abs(record.velocity(record.breakpoints)).max())
    if abs(record.final_velocity) > DRIFT * largest:
        part = abs(record.final_velocity) / largest
        words.append(
            f"the record's velocity ends at {record.final_velocity:.3g} m/s, {part:.2g} of its "
            "largest, and the base keeps it" + ("" if words else "; --baseline corrects it")
        )
    return "; ".join(words)


def _peak(row: Row) -> str:
    return f"{row['peak_ratio']:.6f}" if math.isfinite(row["peak_ratio"]) else "-"


def _difference(row: Row) -> str:
    value = row["difference"]
    return ("" if value < 0 else "+") + scientific(value) if math.isfinite(value) else "-"


def _fixed(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.6f}"


def _slip(value: float) -> str:
    return "-" if math.isnan(value) else scientific(value)


def _duration(seconds: float) -> str:
    return f"{seconds * 1e6:.0f} µs" if seconds < 1e-3 else f"{seconds * 1e3:.1f} ms"


def draw(rows: list[Row], block: RigidBlock, motion: Motion, path: Path) -> None:
    """Draw the histories of the rows over each other."""
    from studies.drawing.figures import draw_histories, save

    labels = {
        "panel": "",
        "pulse": motion_name(motion),
        "width_m": block.width,
        "height_m": block.height,
        "amplitude_g": strongest(motion) / block.gravity,
    }
    parts = [
        samples(row["response"], block, motion, {**labels, "source": row["source"]})
        for row in rows
        if row["response"].history is not None
    ]
    if parts:
        save(draw_histories(pd.concat(parts), "The same block, the same shaking"), path)


def samples(
    response: Response, block: RigidBlock, motion: Motion, labels: dict[str, Any]
) -> pd.DataFrame:
    """Return the history of a response as a tidy table, with the ground acceleration.

    Raises
    ------
    ValueError
        If no history was asked for, or the response failed before it had one.
    """
    history = response.history
    if history is None:
        raise ValueError("the response has no history")
    return pd.DataFrame(
        {
            **labels,
            "outcome": response.outcome.value,
            "time_s": history.time,
            "ground_g": motion.acceleration(history.time) / block.gravity,
            "theta_ratio": history.theta / block.alpha,
            "velocity_rad_s": history.velocity,
        }
    )
