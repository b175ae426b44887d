"""How a comparison is shown: as JSON, as a table, as time histories over each other."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.motion import Motion, SinePulse, Still
from analytic.simulate import strongest
from engines.layouts import System
from studies.cases.paper import PULSES
from studies.compare.columns import columns_of, duration, first_line, meanings, valid
from studies.kit.journal import Row
from studies.kit.posing import Posed
from studies.measures.carts import place_error
from studies.measures.differences import scientific
from studies.measures.halving import NO_BOUND
from studies.measures.samples import samples

SHARED = ("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message")
BESIDE = ("error", "velocity_ratio", "impact_error")
CONDITIONED = ("kappa", "sensitivity")
ESTIMATED = ("estimate", "bound")
"""Columns of a comparison that its JSON has, the last where asked for; a number that is not finite
is null there."""


def json_lines(rows: list[Row], note: str = "") -> str:
    """Return one JSON object a line, of what `records` tells."""
    return objects_as_lines(records(rows, note))


def objects_as_lines(objects: Sequence[Mapping[str, Any]]) -> str:
    """Return one JSON object a line; a number that is not finite is null."""
    return "\n".join(
        json.dumps({k: _finite_or_null(v) for k, v in item.items()}, allow_nan=False)
        for item in objects
    )


def records(rows: list[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what is told of each row, by name, with a note in each message.

    `valid` and what stands before it say what the exact solution needs, alike in all; slips [m]
    and the observables of a scene follow where there are any.
    """
    objects: list[dict[str, Any]] = []
    for row in rows:
        exact = row["exact"]
        item = {
            name: row[name] for name in (*SHARED, *BESIDE, *CONDITIONED, *ESTIMATED) if name in row
        }
        item["message"] = "; ".join(words for words in (item["message"], note) if words)
        item |= {name: getattr(exact, name) for name in ("min_normal", "friction_needed")}
        response = row["response"]
        if response.slips:
            item["slips"] = list(response.slips)
        if math.isfinite(off := place_error(response, exact)):
            item["place_error_m"] = off
        objects.append({**item, "valid": valid(exact), **response.observables})
    return objects


def _finite_or_null(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def table_text(
    block: System,
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
        **columns_of(block, rows, scale, degrees, _estimates(rows)),
        "steps": [row["steps"] for row in rows],
        "time": [duration(row["wall_s"]) for row in rows],
    }
    notes = [f"{row['source']}: {row['message']}" for row in rows if row["message"]]
    return "\n".join(
        [
            first_line(block, degrees),
            f"ground  {ground(motion, block)}; observed for {window:.4g} s",
            *([f"start   {_start(block, posed, degrees)}"] if posed.start != (0.0, 0.0) else []),
            *([f"base    {note}"] if note else []),
            *meanings(block, posed, rows[0]["exact"], window),
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
    if "estimate" not in rows[0]:
        return {}
    blind = [math.isnan(row["bound"]) and not math.isnan(row["estimate"]) for row in rows]
    return {
        "estimate": [scientific(row["estimate"]) for row in rows],
        "bound 95 %": [
            NO_BOUND if none else scientific(row["bound"])
            for none, row in zip(blind, rows, strict=True)
        ],
    }


def _start(block: System, posed: Posed, degrees: bool) -> str:
    theta, rate = posed.start
    if degrees:
        return f"θ = {math.degrees(theta):.6g}°, θ' = {math.degrees(rate):.6g}°/s"
    return f"θ = {theta / block.alpha:.6g} α, θ' = {rate / (block.alpha * block.p):.6g} αp"


def ground(motion: Motion, block: System) -> str:
    """Return a ground motion in words: its name, its peak and its details."""
    if isinstance(motion, Still):
        return motion_name(motion)
    if isinstance(motion, SinePulse):
        phase = f", phase {motion.phase:g} rad" if motion.phase else ""
        details = f"{motion.omega:g} rad/s{phase}"
    else:
        times = np.array(motion.breakpoints)
        speed = float(np.abs(motion.velocity(times)).max())
        step = motion.duration / (times.size - 1)
        details = f"{speed:.3g} m/s, {times.size} samples every {step:.4g} s"
    peak = f"{strongest(motion) / block.gravity:.6g} g"
    return f"{motion_name(motion)}, {peak}, {details}, {motion.duration:.4g} s"


def motion_name(motion: Motion) -> str:
    """Return what a ground motion is called."""
    if not isinstance(motion, SinePulse):
        return "at rest" if isinstance(motion, Still) else "record"
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(motion.half_cycles, f"{motion.half_cycles} half cycles")


def draw(rows: list[Row], block: Any, motion: Motion, path: Path) -> None:
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
