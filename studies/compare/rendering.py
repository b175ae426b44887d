"""How a comparison is shown: as a table, as time histories over each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.frame import RockingFrame
from analytic.frame_forces import frame_demands
from analytic.motion import Motion, SinePulse, Still
from analytic.response import Outcome, Response
from analytic.simulate import strongest
from analytic.slide import SlidingBlock
from engines.layouts import BEAM_DEPTH, SPACING, System
from engines.run.drive import LAG
from studies.cases.paper import PULSES
from studies.old.journal import Row
from studies.old.posing import Posed
from studies.measures.differences import scientific
from studies.measures.halving import NO_BOUND
from studies.measures.samples import samples
from studies.measures.words import duration

Columns = dict[str, list[Any]]

OF_A_FRAME = {"parting": "parting/θcr", "tilt": "beam/θcr", "drift_m": "drift [m]"}
"""Observable of a frame -> its column."""

SEEN_M = 1e-6
"""Of a floor's lag, what is shown [m]."""

UNKNOWN = "unknown: there is no exact solution to tell"


def first_line(system: System, degrees: bool) -> str:
    """Return the sizes of what stands on the base."""
    sizes = f"B = {system.width:g} m, H = {system.height:g} m"
    if isinstance(system, SlidingBlock):
        return f"slide   {sizes}, friction {system.friction:g}"
    alpha = f"{math.degrees(system.alpha):.5g}°" if degrees else f"{system.alpha:.5g} rad"
    numbers = f"α = θcr = {alpha}, p = {system.p:.5g} rad/s"
    if isinstance(system, RockingFrame):
        return f"frame   {system.columns} columns of {sizes}, load {system.load:g}: {numbers}"
    return f"block   {sizes}: {numbers}"


def columns_of(
    system: System, rows: list[Row], scale: float, degrees: bool, estimates: Mapping[str, list[str]]
) -> Columns:
    """Return the columns of a scene; rotations are in θcr times `scale`."""
    answers = [row["response"] for row in rows]
    errors = [row["error"] for row in rows]
    if isinstance(system, SlidingBlock):
        return {
            "slips [m]": [_slips(answer) for answer in answers],
            "vs exact": list(map(scientific, errors)),
            "stops [s]": [
                number(answer.slip_times[-1][1] if answer.slip_times else math.nan, ".6f")
                for answer in answers
            ],
            "lift [m]": _observed(answers, "lift_m"),
        }
    seen = OF_A_FRAME if isinstance(system, RockingFrame) else {}
    perhaps = {
        "slip/B": [scientific(answer.slip_m / system.width) for answer in answers],
        "lag [m]": _observed(answers, LAG, SEEN_M),
    }
    return {
        "θmax [°]" if degrees else "θmax/θcr": [
            number(scale * row["peak_ratio"], ".6f") for row in rows
        ],
        "vs exact": [("+" if value >= 0.0 else "") + scientific(value) for value in errors],
        "κ": [number(row["kappa"], ".2g") for row in rows],
        "sens": [number(row["sensitivity"], ".2g") for row in rows],
        **estimates,
        "impacts": [row["impacts"] for row in rows],
        "late·p": [scientific(row["impact_error"]) for row in rows],
        "ratio": [number(row["velocity_ratio"], ".6f") for row in rows],
        **{name: cells for name, cells in perhaps.items() if set(cells) != {"-"}},
        **{column: _observed(answers, name) for name, column in seen.items()},
    }


def meanings(system: System, posed: Posed, exact: Response) -> list[str]:
    """Return what the columns mean, and what the exact solution needs, a line each."""
    if isinstance(system, SlidingBlock):
        return ["vs      largest difference of a slip, over the largest slip"]
    if isinstance(system, RockingFrame):
        whose, valid_if = "the exact", frame_validity(system, posed, exact)
    else:
        whose, valid_if = "Housner's", validity(exact)
    parting = "parting largest difference of two columns' rotations; beam: its largest rotation"
    return [
        "κ       per cent of the exact peak for one of the amplitude; sens: the sensitivity",
        "late    largest error of the first five impact times, times p",
        f"ratio   velocity after over before an impact, the median; {whose} "
        f"η = {system.restitution:.6g}",
        *[parting] * isinstance(system, RockingFrame),
        f"valid   {valid_if}",
    ]


def frame_validity(frame: RockingFrame, posed: Posed, exact: Response) -> str:
    """Say what the exact solution of a frame needs of its contacts, or what fails in it."""
    if exact.outcome is Outcome.FAILED:
        return UNKNOWN
    spacing, depth = SPACING * frame.height, BEAM_DEPTH * frame.height
    needs = frame_demands(frame, posed.motion, posed.start, spacing=spacing, depth=depth)
    if needs.spacing >= spacing:
        return f"not here: the beam would tip: L = {spacing:g} m, needs {needs.spacing:.3g}"
    if needs.pressing <= 0.0:
        return "not here: a contact would open, and an engine is right to differ"
    return (
        f"with friction of {needs.base:.3g} at the feet and {needs.top:.3g} under the beam, or "
        f"more; every contact presses with {needs.pressing:.3g} of its weight at least"
    )


def _slips(response: Response) -> str:
    shown = [f"{slip:+.6f}" for slip in response.slips[:4]]
    more = len(response.slips) - len(shown)
    return " ".join(shown) + (f" … {more} more" if more else "") or "-"


def _observed(answers: list[Response], name: str, least: float = -math.inf) -> list[str]:
    """Return what engines observed, a dash where one did not, or no more than `least`."""
    values = [answer.observables.get(name, math.nan) for answer in answers]
    return [scientific(value if value > least else math.nan) for value in values]


def number(value: float, form: str) -> str:
    """Return a number in a format, a dash where it is not finite."""
    return format(value, form) if math.isfinite(value) else "-"


def valid(exact: Response) -> bool | None:
    """Say whether the pivot stays on the base in the exact solution; None if there is none."""
    return None if math.isnan(exact.min_normal) else exact.min_normal >= 0.0


def validity(exact: Response) -> str:
    """Say what the exact solution needs to be one: no slip, no lift-off of the pivot."""
    if math.isnan(exact.min_normal):
        return UNKNOWN
    if not valid(exact):
        return "not here: the pivot would lift off, and an engine is right to differ"
    least = f"the normal force stays above {exact.min_normal:.3g} of the weight"
    return f"with friction of {exact.friction_needed:.3g} or more; {least}"


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

    Parameters
    ----------
    block : System
    posed : Posed
        The motion and the start.
    window : float
        Time [s] for which it was observed.
    rows : list of dict
        From `studies.compare.study.compare`; their messages stand below the table.
    note : str, optional
        On the motion of the base.
    edge : str, optional
        What an answer near the edge hangs on: the last line.
    degrees : bool, optional
        Show rotations in degrees, instead of in units of alpha.
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
            *meanings(block, posed, rows[0]["exact"]),
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
    """Draw the histories of the rows over each other; nothing where no row has one.

    Parameters
    ----------
    rows : list of dict
        With source and response, as from `studies.compare.study.compare` with times.
    block : System
        One that rocks.
    motion : Motion
    path : Path
        The file to write, .png, .pdf or .svg.
    """
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
