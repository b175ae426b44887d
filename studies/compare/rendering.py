"""How a comparison is shown: as JSON, as a table, as time histories over each other."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import Motion, SinePulse, Still
from analytic.record import Record
from analytic.response import Outcome, Response
from analytic.simulate import strongest
from studies.cases.paper import PULSES
from studies.kit.journal import Row
from studies.kit.posing import Posed
from studies.measures.differences import scientific
from studies.measures.halving import NO_BOUND
from studies.measures.samples import samples

DRIFT = 1e-6
"""Part of its largest velocity up to which a base that comes to rest may miss it, by rounding."""


SHARED = ("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message")
BESIDE = ("error", "velocity_ratio", "impact_error")
CONDITIONED = ("kappa", "sensitivity")
ESTIMATED = ("estimate", "bound")
"""Columns of a comparison that its JSON has, the last where asked for; a number that is not finite
is null there."""


def json_lines(rows: list[Row], note: str = "") -> str:
    """Return one JSON object a line; a number that is not finite is null."""
    return "\n".join(
        json.dumps({k: _finite_or_null(v) for k, v in item.items()}, allow_nan=False)
        for item in records(rows, note)
    )


def records(rows: list[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what is told of each row, by name, with a note in each message.

    The last three, `valid` among them, say what the exact solution needs, and are alike in all.
    """
    objects: list[dict[str, Any]] = []
    for row in rows:
        exact = row["exact"]
        item = {
            name: row[name] for name in (*SHARED, *BESIDE, *CONDITIONED, *ESTIMATED) if name in row
        }
        item["message"] = "; ".join(words for words in (item["message"], note) if words)
        item |= {name: getattr(exact, name) for name in ("min_normal", "friction_needed")}
        objects.append({**item, "valid": valid(exact)})
    return objects


def _finite_or_null(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def table_text(
    block: RigidBlock,
    posed: Posed,
    window: float,
    rows: list[Row],
    note: str = "",
    edge: str = "",
    *,
    degrees: bool = False,
) -> str:
    """Return the table with its head, a note on the motion in it, and what is said below it.

    Those are the messages of its rows, and what an answer near the edge hangs on.
    """
    motion, scale = posed.motion, math.degrees(block.alpha) if degrees else 1.0
    columns: dict[str, list[Any]] = {
        "source": [row["source"] for row in rows],
        "outcome": [row["outcome"] for row in rows],
        "θmax [°]" if degrees else "θmax/θcr": [_peak(row, scale) for row in rows],
        "vs exact": [_difference(row) for row in rows],
        **_estimates(rows),
        "impacts": [row["impacts"] for row in rows],
        "late·p": [_part(row["impact_error"]) for row in rows],
        "ratio": [_fixed(row["velocity_ratio"]) for row in rows],
        "slip/B": [_part(row["response"].slip_m / block.width) for row in rows],
        "steps": [row["steps"] for row in rows],
        "time": [_duration(row["wall_s"]) for row in rows],
    }
    notes = [f"{row['source']}: {row['message']}" for row in rows if row["message"]]
    alpha = f"{math.degrees(block.alpha):.5g}°" if degrees else f"{block.alpha:.5g} rad"
    return "\n".join(
        [
            f"block   B = {block.width:g} m, H = {block.height:g} m: "
            f"α = θcr = {alpha}, p = {block.p:.5g} rad/s",
            f"ground  {ground(motion, block)}; observed for {window:.4g} s",
            *([f"start   {_start(block, posed, degrees)}"] if posed.start != (0.0, 0.0) else []),
            *([f"base    {note}"] if note else []),
            "late    largest error of the first five impact times, times p",
            f"ratio   velocity after over before an impact, the median; Housner's η = "
            f"{block.restitution:.6g}",
            f"valid   {validity(rows[0]['exact'])}",
            "time    of this one run; of many cases each takes less, as its functions are compiled",
            "",
            right_aligned(columns),
            *notes,
            *([edge] if edge else []),
        ]
    )


def right_aligned(columns: Mapping[str, Sequence[Any]]) -> str:
    """Return a table of columns by their names."""
    texts = [[name, *map(str, cells)] for name, cells in columns.items()]
    widths = [max(map(len, column)) for column in texts]
    lines = (zip(row, widths, strict=True) for row in zip(*texts, strict=True))
    return "\n".join(" ".join(text.rjust(width) for text, width in line) for line in lines)


def _estimates(rows: list[Row]) -> dict[str, list[str]]:
    """Return the columns of estimates, where they were asked for."""
    if "estimate" not in rows[0]:
        return {}
    return {
        "estimate": [_part(row["estimate"]) for row in rows],
        "bound 95 %": [_bound(row["estimate"], row["bound"]) for row in rows],
    }


def _bound(estimate: float, bound: float) -> str:
    return NO_BOUND if math.isnan(bound) and not math.isnan(estimate) else _part(bound)


def _start(block: RigidBlock, posed: Posed, degrees: bool) -> str:
    theta, rate = posed.start
    if degrees:
        return f"θ = {math.degrees(theta):.6g}°, θ' = {math.degrees(rate):.6g}°/s"
    return f"θ = {theta / block.alpha:.6g} α, θ' = {rate / (block.alpha * block.p):.6g} αp"


def valid(exact: Response) -> bool | None:
    """Say whether the pivot stays on the base in the exact solution; None if there is none."""
    if exact.outcome is Outcome.FAILED:
        return None
    return exact.min_normal >= 0.0


def validity(exact: Response) -> str:
    """Say what the exact solution needs to be one: no slip, no lift-off of the pivot."""
    holds = valid(exact)
    if holds is None:
        return "unknown: there is no exact solution to tell"
    if not holds:
        return "not here: the pivot would lift off, and an engine is right to differ"
    least = f"the normal force stays above {exact.min_normal:.3g} of the weight"
    return f"with friction of {exact.friction_needed:.3g} or more; {least}"


def pulse_name(half_cycles: int) -> str:
    """Return what a pulse of so many half cycles is called."""
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(half_cycles, f"{half_cycles} half cycles")


def ground(motion: Motion, block: RigidBlock) -> str:
    """Return a ground motion in words: its name, its peak and its details."""
    if isinstance(motion, Still):
        return motion_name(motion)
    peak = f"{strongest(motion) / block.gravity:.6g} g"
    return f"{motion_name(motion)}, {peak}, {motion_details(motion)}"


def motion_name(motion: Motion) -> str:
    """Return what a ground motion is called."""
    if isinstance(motion, Still):
        return "at rest"
    return pulse_name(motion.half_cycles) if isinstance(motion, SinePulse) else "record"


def motion_details(motion: Motion) -> str:
    """Say what a reader needs to know of a ground motion besides its name and its peak."""
    if isinstance(motion, SinePulse):
        phase = f", phase {motion.phase:g} rad" if motion.phase else ""
        return f"{motion.omega:g} rad/s{phase}, {motion.duration:.4g} s"
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


def _peak(row: Row, scale: float) -> str:
    return f"{scale * row['peak_ratio']:.6f}" if math.isfinite(row["peak_ratio"]) else "-"


def _difference(row: Row) -> str:
    value = row["error"]
    return ("" if value < 0 else "+") + scientific(value) if math.isfinite(value) else "-"


def _fixed(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.6f}"


def _part(value: float) -> str:
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
        save(draw_histories(pd.concat(parts), "The same block, the same motion of the base"), path)
