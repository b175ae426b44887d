"""Overturning maps: which pulses overturn a block, by which mode, and who gets that wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import cache
from typing import Annotated, Literal

import numpy as np
import pandas as pd

from analytic.models import MODELS
from analytic.motion import FloatArray
from studies.cases.window import LEAST_ONSETS, Axis, Window
from studies.old.arguments import (
    BadInputError,
    Count,
    Out,
    Positive,
    Yes,
    as_bad_input,
    refuse_given,
)
from studies.old.jobs import Job
from studies.old.journal import Row
from studies.old.naming import sources_option
from studies.old.options import PATIENT_RUNNING, PatientRunning, refuse_days, refuse_excess
from studies.old.plan import Plan, Tables, by_label, carry_out
from studies.old.provenance import usable_cores
from studies.overturning import STUDY
from studies.overturning.edges import find_edges, intervals
from studies.overturning.engine_edges import (
    ask_for_table,
    chosen_edges,
    edge_jobs,
    grid_jobs,
    reduce,
)
from studies.overturning.report import finding, report
from studies.sources.registry import core_sources, resolve

__all__ = ["command", "finding", "report"]

MAPPED = sources_option("exact must be among them: ")
DEFAULT_SOURCES = (
    *("exact", "housner", "modified", "onset-matched"),
    *core_sources("naive"),
    *core_sources(),
)
STRIP = 250_000
"""Cases that are held at a time."""
CELL_BYTES, COLUMN_BYTES = 200.0, 3000.0
"""About what a cell of a strip holds, and a column's edges."""
CELL_S, COLUMN_S = 2e-5, 0.02
"""About how long a cell takes on one core, and a column's edges [s]."""
APPLIES = {
    "aspect": ("frequency", "size"),
    "omega-over-p": ("slenderness",),
    "pulse-hz": ("size",),
}
"""Over which abscissae an option says something."""
RESOLUTION, QUICK_RESOLUTION = 1000, 200
KAPPA_RESOLUTION = 160
ENGINE_RESOLUTION, QUICK_ENGINE_RESOLUTION = 32, 8
POSITIONS, QUICK_POSITIONS = (0.12, 0.3, 0.5, 0.7, 0.9), (0.5,)
"""Parts of the abscissa at which engines are asked about edges."""


def command(
    *,
    out: Out,
    over: Axis = "frequency",
    pulse: Literal["half-sine", "full-sine"] = "full-sine",
    aspect: Positive | None = None,
    omega_over_p: Positive | None = None,
    pulse_hz: Positive | None = None,
    low: Positive | None = None,
    high: Positive | None = None,
    onsets: Positive | None = None,
    columns: Count | None = None,
    rows: Count | None = None,
    sources: Annotated[tuple[str, ...], MAPPED] = DEFAULT_SOURCES,
    quick: bool = False,
    running: PatientRunning = PATIENT_RUNNING,
    yes: Yes = False,
) -> int:
    """Map which pulses overturn a block.

    Parameters
    ----------
    over
        The abscissa: frequency (ω/p), slenderness (α) or size (p/2π in Hz).
    pulse
        half-sine or full-sine.
    aspect
        H/B of the block, 4 by default; not with --over slenderness.
    omega_over_p
        Frequency ω/p of the pulse, 3 by default; only with --over slenderness.
    pulse_hz
        Frequency of the pulse [Hz], 1 by default; only with --over size.
    low
        Where the abscissa begins; by default ω/p at 0.2, α at 0.05 rad, p/2π at 0.1 Hz.
    high
        Where it ends; by default ω/p at 8, α at 0.6 rad, p/2π at 0.8 Hz.
    onsets
        Largest amplitude over g tan α, 10 by default; a map begins at 1.
    columns
        Number of abscissae; 1000 by default, 200 in a quick study.
    rows
        Number of amplitudes at each; 1000 by default, 200 in a quick study.
    sources
        exact, and linear models or engines.
    quick
        A coarser map and fewer runs of the engines: less than a minute on 2 cores.
    """
    if "exact" not in sources:
        raise BadInputError("--sources must name exact, which the others are held against")
    for name in sources:
        if resolve(name).kind not in ("model", "engine"):
            raise BadInputError(f"--sources: {name!r} cannot be mapped; models and engines can")
    beside = {"aspect": aspect, "omega-over-p": omega_over_p, "pulse-hz": pulse_hz}
    for name, axes in APPLIES.items():
        if over not in axes:
            refuse_given({name: beside[name]}, f"only with --over {' or '.join(axes)}")
    asked = {**beside, "low": low, "high": high, "onsets": onsets}
    given = {name.replace("-", "_"): v for name, v in asked.items() if v is not None}
    resolution = QUICK_RESOLUTION if quick else RESOLUTION
    with as_bad_input():
        window = Window(
            over=over,
            pulse=pulse,
            columns=columns or resolution,
            rows=rows or resolution,
            **given,
        )
    refuse_too_much(window, sources, yes)
    engines = [name for name in sources if name not in MODELS]

    @cache
    def maps() -> dict[str, tuple[pd.DataFrame, pd.DataFrame]]:
        return {model: mapped(window, model) for model in sources if model in MODELS}

    def jobs() -> list[Job]:
        exact, _ = maps()["exact"]
        parts = QUICK_POSITIONS if quick else POSITIONS
        places = [window.low + part * (window.high - window.low) for part in parts]
        count = QUICK_ENGINE_RESOLUTION if quick else ENGINE_RESOLUTION
        chosen = chosen_edges(exact, places)
        return [*grid_jobs(window, engines, count), *edge_jobs(window, engines, chosen)]

    def tabulate(rows: Sequence[Row]) -> Tables:
        boundaries, areas = (pd.concat(part) for part in zip(*maps().values(), strict=True))
        mapped = {"boundaries": boundaries, "conditioning": conditioned(window), "map": areas}
        return {**by_label("table")(rows), **mapped}

    plan = Plan(
        jobs=jobs,
        settings={"window": asdict(window), "quick": quick},
        growing={"source": engines},
        ask=ask_for_table,
        reduce=reduce,
        tabulate=tabulate,
    )
    return carry_out(STUDY, plan, out, running, report)


def refuse_too_much(window: Window, sources: Sequence[str], yes: bool) -> None:
    """Raise BadInputError if a map needs more memory than there is, or days without a yes."""
    models = sum(name in MODELS for name in sources)
    asked = f"--columns is {window.columns} and --rows is {window.rows}"
    columns = models * window.columns
    refuse_excess(asked, max(window.rows, STRIP) * CELL_BYTES + columns * COLUMN_BYTES)
    refuse_days(asked, columns * (COLUMN_S + window.rows * CELL_S / usable_cores()), yes)


def conditioned(window: Window) -> pd.DataFrame:
    """Return the condition numbers of the exact peaks on a grid; nan where the block overturns."""
    x, onsets = np.meshgrid(
        window.centres(min(window.columns, KAPPA_RESOLUTION)),
        window.amplitudes(min(window.rows, KAPPA_RESOLUTION)),
        indexing="ij",
    )
    found = window.condition_numbers(x, onsets)
    columns = {"x": x, "onsets": onsets, "kappa": found.amplitude, "kappa_eta": found.restitution}
    return pd.DataFrame({name: column.ravel() for name, column in columns.items()})


def mapped(window: Window, model: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the edges of a model and the intervals between them, a strip of columns at a time."""
    x, inner = window.centres(window.columns), window.amplitudes(window.rows)
    amplitudes = np.concatenate([[LEAST_ONSETS], inner, [window.onsets]])
    width = max(STRIP // window.rows, 1)
    edges, spans = [], []
    for start in range(0, window.columns, width):
        strip = x[start : start + width]
        found, between = _strip(window, model, strip, amplitudes)
        edges.append(found)
        spans.append(between)
    return pd.concat(edges), pd.concat(spans)


def _strip(
    window: Window, model: str, x: FloatArray, amplitudes: FloatArray
) -> tuple[pd.DataFrame, pd.DataFrame]:
    found = find_edges(lambda i, onsets: window.modes(x[i], onsets, model), len(x), amplitudes)
    first = window.modes(x, np.full(len(x), amplitudes[0]), model).mode
    spans = intervals(found, first, LEAST_ONSETS, window.onsets)
    return _named(found, model, x, window), _named(spans, model, x, window)


def _named(table: pd.DataFrame, model: str, x: FloatArray, window: Window) -> pd.DataFrame:
    at = x[table["column"].to_numpy()]
    columns = {"model": model, "x": at, "alpha": window.alpha(at), "omega_over_p": window.ratio(at)}
    return pd.concat([pd.DataFrame(columns), table.drop(columns="column")], axis=1)
