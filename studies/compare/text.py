"""A comparison as text: the case, what its exact solution needs, and a table of the sources."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analytic.frame import RockingFrame
from analytic.motion import Motion, SinePulse, Still
from analytic.slide import SlidingBlock
from analytic.start import strongest
from engines.scene import System
from studies.cases.paper import PULSES
from studies.kit.jobs import Question, Row
from studies.kit.say import aligned, duration, number

OF_THE_CASE = ("kappa", "sensitivity", "min_normal", "friction_needed")
SHOWN = (
    *("source", "outcome", "slips", "peak_ratio", "error", "estimate", "bound", "impacts"),
    *("impact_error", "floor_lag_m", "lift_m", "parting", "tilt", "drift_m", "steps", "wall_s"),
)
"""Columns of the table, as in JSON, where a source has them."""


def table_text(
    case: Question, records: Sequence[Row], note: str = "", *, degrees: bool = False
) -> str:
    """Return the case, a note on its motion, and its records; angles over alpha, or in degrees."""
    theta, rate = case.start
    turned, system = math.degrees(1.0), case.system
    if degrees:
        words = f"θ = {turned * theta:.6g}°, θ' = {turned * rate:.6g}°/s"
    else:
        words = f"θ = {theta / system.alpha:.6g} α, θ' = {rate / (system.alpha * system.p):.6g} αp"
    facts = [f"{name} {number(records[0][name])}" for name in OF_THE_CASE]
    return "\n".join(
        [
            _standing(system, degrees),
            f"ground  {_ground(case)}; observed for {case.duration:.4g} s",
            *[f"base    {note}"] * bool(note),
            *[f"start   {words}"] * (case.start != (0.0, 0.0)),
            *[f"exact   {', '.join(facts)}"] * (not isinstance(system, SlidingBlock)),
            "",
            _table(records, system, degrees),
            *(
                f"{record['source']}: {record['message']}"
                for record in records
                if record["message"]
            ),
        ]
    )


def _table(records: Sequence[Row], system: System, degrees: bool) -> str:
    """Return a line for each source, of the columns in which one has a number or a word."""
    unit = math.degrees(system.alpha) if degrees else 1.0
    words: dict[str, Callable[[Any], str]] = {"wall_s": duration, "slips": _slips}
    words["peak_ratio"] = lambda ratio: f"{unit * ratio:.6f}"

    def cell(name: str, value: Any) -> str:
        return words.get(name, number)(value) if known(value) else "-"

    def known(value: Any) -> bool:
        return value is not None and value == value

    names = [name for name in SHOWN if any(known(record.get(name)) for record in records)]
    if isinstance(system, SlidingBlock):
        names.remove("peak_ratio")
    rows = [[cell(name, record.get(name)) for name in names] for record in records]
    heads = ["peak [°]" if degrees and name == "peak_ratio" else name for name in names]
    return aligned([heads, *rows], [name not in ("source", "outcome", "slips") for name in names])


def _standing(system: System, degrees: bool) -> str:
    sizes = f"B = {system.width:g} m, H = {system.height:g} m"
    if isinstance(system, SlidingBlock):
        return f"slide   {sizes}, friction {system.friction:g}"
    alpha = f"{math.degrees(system.alpha):.5g}°" if degrees else f"{system.alpha:.5g} rad"
    numbers = f"α = θcr = {alpha}, p = {system.p:.5g} rad/s"
    if isinstance(system, RockingFrame):
        return f"frame   {system.columns} columns of {sizes}, load {system.load:g}: {numbers}"
    return f"block   {sizes}: {numbers}"


def _ground(case: Question) -> str:
    motion, name = case.motion, motion_name(case.motion)
    if isinstance(motion, Still):
        return name
    if isinstance(motion, SinePulse):
        phase = f", phase {motion.phase:g} rad" if motion.phase else ""
        details = f"{motion.omega:g} rad/s{phase}"
    else:
        times = np.array(motion.breakpoints)
        speed = float(np.abs(motion.velocity(times)).max())
        step = motion.duration / (times.size - 1)
        details = f"{speed:.3g} m/s, {times.size} samples every {step:.4g} s"
    peak = strongest(motion) / case.system.gravity
    return f"{name}, {peak:.6g} g, {details}, {motion.duration:.4g} s"


def motion_name(motion: Motion) -> str:
    """Return what a motion of the base is called."""
    if not isinstance(motion, SinePulse):
        return "at rest" if isinstance(motion, Still) else "record"
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(motion.half_cycles, f"{motion.half_cycles} half cycles")


def _slips(slips: Sequence[float]) -> str:
    first = " ".join(f"{slip:+.6f}" for slip in slips[:4])
    return f"{first} … {len(slips) - 4} more" if len(slips) > 4 else first
