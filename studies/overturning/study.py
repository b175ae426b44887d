"""Overturning maps: which pulses overturn a block, by which mode, and who gets that wrong."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd

from analytic.models import MODELS
from analytic.motion import FloatArray
from studies.cases.window import LEAST_ONSETS, Axis, Window
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Count, Positive, check_sources
from studies.kit.executors import Executor, choose
from studies.kit.journal import Row
from studies.kit.naming import sources_option
from studies.kit.runner import exit_code, fill_folder
from studies.overturning import STUDY
from studies.overturning.edges import find_edges, intervals
from studies.overturning.engine_edges import chosen_edges, edge_jobs, grid_jobs, put, reduce
from studies.overturning.report import headline, paragraph, pictures, report
from studies.sources.groups import core_sources

__all__ = ["command", "headline", "paragraph", "pictures", "report"]

MAPPED = sources_option("exact must be among them: ")
DEFAULT_SOURCES = ("exact", "housner", "modified", "onset-matched", *core_sources())
STRIP = 250_000
"""Cases that are held at a time."""
RESOLUTION, QUICK_RESOLUTION = 1000, 200
KAPPA_RESOLUTION = 160
ENGINE_RESOLUTION, QUICK_ENGINE_RESOLUTION = 32, 8
POSITIONS, QUICK_POSITIONS = (0.12, 0.3, 0.5, 0.7, 0.9), (0.5,)
"""Parts of the abscissa at which engines are asked about edges."""


def command(
    *,
    out: Path,
    over: Axis = "frequency",
    pulse: Literal["half-sine", "full-sine"] = "full-sine",
    aspect: Positive = 4.0,
    omega_over_p: Positive = 3.0,
    pulse_hz: Positive = 1.0,
    low: Positive | None = None,
    high: Positive | None = None,
    onsets: Positive = 10.0,
    columns: Count | None = None,
    rows: Count | None = None,
    sources: Annotated[tuple[str, ...], MAPPED] = DEFAULT_SOURCES,
    quick: bool = False,
    jobs: Count | None = None,
    time_limit: Positive = 120.0,
    cluster: str | None = None,
) -> int:
    """Map which pulses overturn a block.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    over
        The abscissa: frequency (ω/p), slenderness (α) or size (p/2π in Hz).
    pulse
        half-sine or full-sine.
    aspect
        H/B of the block; not with --over slenderness.
    omega_over_p
        Frequency ω/p of the pulse, with --over slenderness.
    pulse_hz
        Frequency of the pulse [Hz], with --over size.
    low, high
        Range of the abscissa.
    onsets
        Largest amplitude over g tan α; a map begins at 1.
    columns, rows
        Number of frequencies and of amplitudes; 1000 each, 200 in a quick study.
    sources
        exact, and linear models or engines.
    quick
        A coarser map and fewer runs of the engines: less than a minute on 2 cores.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case, or its search for a threshold, is given
        up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """
    check_sources(sources)
    check_mapped(sources)
    resolution = QUICK_RESOLUTION if quick else RESOLUTION
    try:
        window = Window(
            over=over,
            low=float("nan") if low is None else low,
            high=float("nan") if high is None else high,
            onsets=onsets,
            columns=columns or resolution,
            rows=rows or resolution,
            pulse=pulse,
            aspect=aspect,
            omega_over_p=omega_over_p,
            pulse_hz=pulse_hz,
        )
    except ValueError as error:
        raise BadInputError(f"--{error}") from error
    executor = choose(jobs, time_limit, cluster, put)
    found = overturning(window, sources, out, quick=quick, executor=executor)
    print(report(out, window))
    return exit_code(found)


def check_mapped(sources: Sequence[str]) -> None:
    """Raise BadInputError unless the exact model is among the sources, and all can be mapped."""
    from studies.sources.registry import resolve

    if "exact" not in sources:
        raise BadInputError("--sources must name exact, which the others are held against")
    for name in sources:
        if resolve(name).kind not in ("model", "engine"):
            raise BadInputError(f"--sources: {name!r} cannot be mapped; models and engines can")


def overturning(
    window: Window, sources: Sequence[str], folder: Path, *, quick: bool, executor: Executor
) -> list[Row]:
    """Map the models, run what the folder does not hold yet of the engines, write the tables.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    maps = {model: mapped(window, model) for model in sources if model in MODELS}
    engines = [name for name in sources if name not in MODELS]
    boundaries = pd.concat([edges for edges, _ in maps.values()])
    exact = boundaries[boundaries["model"] == "exact"]
    parts = QUICK_POSITIONS if quick else POSITIONS
    chosen, _ = chosen_edges(
        exact, [window.low + part * (window.high - window.low) for part in parts]
    )
    count = QUICK_ENGINE_RESOLUTION if quick else ENGINE_RESOLUTION
    rows = fill_folder(
        folder,
        "overturning",
        [*grid_jobs(window, engines, count), *edge_jobs(window, engines, chosen)],
        module=__name__,
        executor=executor,
        reduce=reduce,
        settings={"window": asdict(window), "quick": quick},
        growing={"source": engines},
        products=STUDY.products,
        tables="table",
    )
    provenance.write_text(folder / "boundaries.csv", boundaries.to_csv(index=False))
    provenance.write_text(folder / "conditioning.csv", conditioned(window).to_csv(index=False))
    areas = pd.concat([spans for _, spans in maps.values()])
    provenance.write_text(folder / "map.csv", areas.to_csv(index=False))
    return rows


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
    """Return a table with the model, the abscissa and what it stands for instead of a number."""
    at = x[table["column"].to_numpy()]
    columns = {"model": model, "x": at, "alpha": window.alpha(at), "omega_over_p": window.ratio(at)}
    return pd.concat([pd.DataFrame(columns), table.drop(columns="column")], axis=1)
