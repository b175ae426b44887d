"""Overturning maps: which pulses overturn a block, by which mode, and who predicts that wrongly."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic import MODELS, simulate
from analytic.maps import Modes
from analytic.motion import FloatArray
from analytic.response import Outcome, Response
from studies.cases.refusal import BadInputError
from studies.cases.window import LEAST_ONSETS, Axis, Window
from studies.kit.arguments import Count, Positive, as_bad_input, refuse_given
from studies.kit.jobs import Job, Question, Row, answer, ask
from studies.kit.options import Running, refuse_excess
from studies.kit.say import capital, out_of
from studies.kit.study import Study, Tables
from studies.measures.presets import in_order, in_words, preset_of
from studies.measures.wrongness import NO_ANSWER, REST
from studies.overturning import planes
from studies.overturning.edges import IntArray, find_edges
from studies.overturning.planes import FALSE, MISSED
from studies.sources.registry import core_sources, resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRIP, STRIP_BYTES, COLUMN_BYTES = 250_000, 200.0, 3000.0
"""Cases that are held at a time; about what each holds, and the edges of a column [byte]."""
APPLIES = {"aspect": ("frequency", "size"), "omega_over_p": ("slenderness",), "pulse_hz": ("size",)}
"""Over which abscissae an option says something."""
ROOM, SPREAD, SHARP = 0.04, 0.03, 1e-6
"""Relative width on both sides that an edge needs to be asked about; that within which an engine's
own threshold is looked for; and that to which it is bisected."""
WINDOW = tuple(item.name for item in fields(Window))
ANSWER = ("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message")
EDGE = ("table", "edge", "overturns")
COLUMNS = {
    "engines": ("table", "x", "onsets", *ANSWER),
    "edges": (*EDGE, "offset", "x", "onsets", *ANSWER),
    "thresholds": (*EDGE, "x", "onsets", "source", "outcome", "shift", "runs", "message"),
}
"""Columns of the tables of engines."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Options:
    """Which plane of pulses is mapped.

    Attributes
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
    planes
        Instead of one map twelve planes, pulse by pulse: half and full sines, H/B of 2, 3 and 4,
        and two widths, which are alike by similarity; every other pulse after a second of rest.
    """

    over: Axis = "frequency"
    pulse: Literal["half-sine", "full-sine"] = "full-sine"
    aspect: Positive | None = None
    omega_over_p: Positive | None = None
    pulse_hz: Positive | None = None
    low: Positive | None = None
    high: Positive | None = None
    onsets: Positive | None = None
    columns: Count | None = None
    rows: Count | None = None
    planes: bool = False

    def window(self, quick: bool) -> Window:
        """Return the plane that is asked for; BadInputError if an option is beyond its limits."""
        for name, axes in APPLIES.items():
            if self.over not in axes:
                refuse_given({name: getattr(self, name)}, f"only with --over {' or '.join(axes)}")
        given = {name: getattr(self, name) for name in WINDOW}
        cells = dict.fromkeys(("columns", "rows"), 200 if quick else 1000)
        with as_bad_input():
            return Window(**cells | {name: it for name, it in given.items() if it is not None})


def jobs(sources: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return a job for each model, which maps the plane, and those of engines on it."""
    sources = tuple(dict.fromkeys(("exact", *sources)))
    for name in sources:
        if resolve(name).kind not in ("model", "engine"):
            raise BadInputError(f"--sources names {name!r}; it must name models and engines")
    if options.planes:
        plain = Options(planes=True)
        given = {name: it for name, it in asdict(options).items() if it != getattr(plain, name)}
        refuse_given(given, "only without --planes")
        return planes.jobs(sources, quick)
    window = options.window(quick)
    models = [name for name in sources if name in MODELS]
    engines = [name for name in sources if name not in MODELS]
    asked = f"--columns is {window.columns} and --rows is {window.rows}"
    columns = len(models) * window.columns
    refuse_excess(asked, max(window.rows, STRIP) * STRIP_BYTES + columns * COLUMN_BYTES)

    def job(source: str, x: float, onsets: float, **labels: Any) -> Job:
        system, motion = window.case(x, onsets)
        case = Question(system=system, motion=motion)
        return Job(labels=labels | {"x": x, "onsets": onsets}, case=case, source=source)

    whole = job("exact", 0.5 * (window.low + window.high), window.onsets)
    labels = {"table": "map", **asdict(window)}
    found = [replace(whole, labels=labels, source=model) for model in models]
    cells = 8 if quick else 32
    grid = product(window.centres(cells).tolist(), window.amplitudes(cells).tolist(), engines)
    found += [job(source, x, onsets, table="engines") for x, onsets, source in grid]
    parts = (0.5,) if quick else (0.12, 0.3, 0.5, 0.7, 0.9)
    places = [window.low + part * (window.high - window.low) for part in parts]
    edges = roomy_edges(window, places) if engines else ()
    for (x, onsets, above), source in product(edges, engines):
        beside = {"edge": onsets, "overturns": "above" if above >= 0 else "below"}
        for offset in (-1e-2, -1e-3, -1e-4, 1e-4, 1e-3, 1e-2):
            where = {"table": "edges", **beside, "offset": offset}
            found.append(job(source, x, onsets * (1.0 + offset), **where))
        found.append(job(source, x, onsets, table="thresholds", **beside))
    return found


def edges_of(window: Window, model: str, x: FloatArray) -> pd.DataFrame:
    """Return the edges of a model's columns at some abscissae, a strip of columns at a time."""
    amplitudes = np.r_[LEAST_ONSETS, window.amplitudes(window.rows), window.onsets]
    width = max(STRIP // window.rows, 1)
    found = []
    for strip in (x[start : start + width] for start in range(0, len(x), width)):

        def solve(column: IntArray, onsets: FloatArray, at: FloatArray = strip) -> Modes:
            return window.modes(at[column], onsets, model)

        edges = find_edges(solve, len(strip), amplitudes)
        edges.insert(0, "x", strip[edges.pop("column")])
        found.append(edges)
    return pd.concat(found, ignore_index=True)


def roomy_edges(window: Window, places: Sequence[float]) -> list[tuple[float, float, int]]:
    """Return x, amplitude and mode above of exact edges that have ROOM, in columns near places."""
    columns = window.centres(window.columns)
    near = np.unique([columns[np.argmin(abs(columns - place))] for place in places])
    edges = edges_of(window, "exact", near)
    logs = np.log(edges["low"]).groupby(edges["x"])
    room = ~(logs.diff() <= ROOM) & ~(logs.diff(-1) >= -ROOM)  # at an end there is no next one
    return list(edges.loc[room, ["x", "low", "above"]].itertuples(index=False, name=None))


def measure(job: Job) -> Row:
    """Return a model's edges, an engine's own threshold, or an engine's answer."""
    table = job.labels.get("table")
    if table == "map":
        window = Window(**{name: job.labels[name] for name in WINDOW})
        edges = edges_of(window, job.source, window.centres(window.columns))
        return {"outcome": "mapped", "edges": edges.to_dict("list"), "message": ""}
    return threshold(job) if table == "thresholds" else answer(job)


def threshold(job: Job) -> Row:
    """Bisect the amplitude, near that of the job, at which its source's outcome changes."""
    pulse: Any = job.case.motion
    answers: list[Response] = []

    def overturns(shift: float) -> bool:
        moved = replace(pulse, amplitude=pulse.amplitude * (1.0 + shift))
        answers.append(ask(replace(job, case=replace(job.case, motion=moved))))
        if answers[-1].outcome is Outcome.FAILED:
            raise ArithmeticError
        return answers[-1].outcome is Outcome.OVERTURNED

    low, high, shift = -SPREAD, SPREAD, math.nan
    try:
        first = overturns(low)
        if overturns(high) is not first:
            while high - low > SHARP:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if overturns(middle) is first else (low, middle)
            shift = 0.5 * (low + high)
        said, runs = answers[1], len(answers)
    except ArithmeticError:
        said, runs, shift = answers[-1], 0, math.nan
    outcome, message = said.outcome.value, said.message
    return {"outcome": outcome, "shift": shift, "runs": runs, "message": message}


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tables of a map, or of planes."""
    if "table" not in rows:
        return planes.tables(rows)
    maps = rows[rows["table"] == "map"]
    plane = maps[list(WINDOW)].head(1).astype({"columns": int, "rows": int})
    window = window_of(plane)
    edges = {name: pd.DataFrame(of) for name, of in zip(maps["source"], maps["edges"], strict=True)}
    areas = {model: intervals(found, model, window) for model, found in edges.items()}
    x, onsets = window.points(160)
    kappa = window.condition_numbers(x, onsets)
    tables = {
        "window": plane,
        "boundaries": _joined(edges, window),
        "map": _joined(areas, window),
        "conditioning": pd.DataFrame(
            {"x": x, "onsets": onsets, "kappa": kappa.amplitude, "kappa_eta": kappa.restitution}
        ),
        "validity": forces(window),
    }
    for name, columns in COLUMNS.items():
        if (mine := rows["table"] == name).any():
            whole = {each: int for each in ("impacts", "steps", "runs") if each in columns}
            tables[name] = rows.loc[mine, list(columns)].fillna({"runs": 0}).astype(whole)
    if "engines" in tables:
        cells = tables["engines"]
        mode = window.modes(cells["x"].to_numpy(), cells["onsets"].to_numpy()).mode
        # no pulse of the map is too weak to lift the block
        exact = np.where(mode >= 0, Outcome.OVERTURNED.value, Outcome.ROCKED.value)
        tables["engines"] = cells.assign(verdict=planes.verdicts(cells["outcome"], exact))
    compared = differences(tables["map"], tables.get("engines"), window)
    return tables | ({"differences": compared} if len(compared) else {})


def window_of(table: pd.DataFrame) -> Window:
    """Return the plane of a map from its window.csv."""
    return Window(**{str(name): value for name, value in table.to_dict("records")[0].items()})


def _joined(tables: Mapping[str, pd.DataFrame], window: Window) -> pd.DataFrame:
    """Return the tables of models as one, with what their abscissae are."""
    whole = pd.concat(tables, names=["model"]).reset_index(level="model").reset_index(drop=True)
    x = whole["x"].to_numpy()
    whole.insert(2, "alpha", window.alpha(x))
    whole.insert(3, "omega_over_p", window.ratio(x))
    return whole


def intervals(edges: pd.DataFrame, model: str, window: Window) -> pd.DataFrame:
    """Return the intervals of one mode in each column, which meet in the middle of edges."""
    x = window.centres(window.columns)
    lowest = window.modes(x, np.full(len(x), LEAST_ONSETS), model).mode
    first = pd.DataFrame({"x": x, "low": LEAST_ONSETS, "mode": lowest})
    middle = 0.5 * (edges["low"] + edges["high"])
    later = pd.DataFrame({"x": edges["x"], "low": middle, "mode": edges["above"]})
    spans = pd.concat([first, later]).sort_values(["x", "low"], ignore_index=True)
    spans.insert(2, "high", spans.groupby("x")["low"].shift(-1).fillna(window.onsets))
    return spans.astype({"mode": int})


def forces(window: Window) -> pd.DataFrame:
    """Return the least normal force over the weight, and the friction, that exact motions need."""
    x, onsets = window.points(48)
    found = [simulate(*window.case(*at)) for at in zip(x.tolist(), onsets.tolist(), strict=True)]
    needs = [(it.outcome.value, it.min_normal, it.friction_needed) for it in found]
    names = ["outcome", "min_normal", "friction_needed"]
    return pd.DataFrame({"x": x, "onsets": onsets}).join(pd.DataFrame(needs, columns=names))


def differences(areas: pd.DataFrame, engines: pd.DataFrame | None, window: Window) -> pd.DataFrame:
    """Return the parts of the map in which each source is wrong.

    For models parts of the area, exact in the amplitude; for engines of the cells, whose runs end
    when the outcome is decided, so that their number of impacts is not compared.
    """
    exact = areas.loc[areas["model"] == "exact", ["x", "low", "mode"]]
    others = areas[areas["model"] != "exact"].groupby("model", sort=False)
    rows = [{"source": model, **_of_model(exact, area, window)} for model, area in others]
    if engines is not None:
        for source, verdict in engines.groupby("source", sort=False)["verdict"]:
            parts = {kind: float((verdict == kind).mean()) for kind in (FALSE, MISSED)}
            counts = {kind: int((verdict == kind).sum()) for kind in (REST, NO_ANSWER)}
            rows.append({"source": source, **parts, "cells": len(verdict), **counts})
    ends = [f"{kind}_{end}" for kind in (FALSE, MISSED) for end in ("from", "to")]
    columns = ["source", FALSE, MISSED, "other_mode", "cells", REST, NO_ANSWER, *ends]
    return pd.DataFrame(rows, columns=columns)


def _of_model(exact: pd.DataFrame, area: pd.DataFrame, window: Window) -> dict[str, float]:
    both = exact.merge(area[["x", "low", "mode"]], on=["x", "low"], how="outer")
    column = both.groupby("x")
    right, found = (column[f"mode_{side}"].ffill() for side in "xy")
    length = column["low"].shift(-1).fillna(window.onsets) - both["low"]
    where = {
        FALSE: (right < 0) & (found >= 0),
        MISSED: (right >= 0) & (found < 0),
        "other_mode": (right >= 0) & (found >= 0) & (right != found),
    }
    whole = window.onsets - LEAST_ONSETS
    lengths = pd.DataFrame({kind: length.where(at, 0.0) for kind, at in where.items()})
    shares = lengths.groupby(both["x"]).sum()
    parts = dict(zip(where, np.ascontiguousarray(shares).mean(axis=0) / whole, strict=True))
    for kind, (end, share) in product((FALSE, MISSED), (("from", 0.05), ("to", 0.95))):
        total = shares[kind].cumsum().to_numpy()
        place = int(np.searchsorted(total, share * total[-1]))
        parts[f"{kind}_{end}"] = float(shares.index[place]) if total[-1] > 0.0 else math.nan
    return {**parts, REST: 0, NO_ANSWER: 0}


def finding(tables: Tables) -> str:
    """Say how much of the map the worst linearization gets wrong, and how many cells engines do."""
    if "parts" in tables:
        return planes.finding(tables["parts"])
    lines, said = tables.get("differences", pd.DataFrame({"cells": []})), []
    models, engines = lines[lines["cells"].isna()], lines[lines["cells"].notna()]
    if len(models):
        wrong = (models[FALSE] + models[MISSED]).set_axis(models["source"])
        said.append(f"{wrong.idxmax()} predicts {100.0 * wrong.max():.2g} % of the map wrongly")
    if len(engines):
        presets = engines["source"].map(preset_of)
        best = in_order(presets)[-1]
        engines = engines[presets == best]
        falls = (engines["cells"] * (engines[FALSE] + engines[MISSED])).round()
        right = engines["cells"] - falls - engines[[REST, NO_ANSWER]].sum(axis=1)
        least = "at least " if right.nunique() > 1 else ""
        cells = out_of(right.min(), engines["cells"].max())
        said.append(f"{in_words(best)}, engines predict {least}{cells} outcomes")
    return f"{capital('; '.join(said) or 'exact maps the plane alone')}."


def shown(tables: Tables) -> Mapping[str, pd.DataFrame]:
    """Return the short tables beside the finding."""
    if "parts" in tables:
        by = {"width of the block": "parts", "rest before them": "rests"}
        return {f"Pulses by the {name}": tables[table] for name, table in by.items()}
    window, areas, lines = window_of(tables["window"]), tables["map"], tables.get("differences")
    whole = areas["x"].nunique() * (window.onsets - LEAST_ONSETS)
    mode, part = areas["mode"].clip(-1, 4), (areas["high"] - areas["low"]) / whole
    parts = part.groupby([areas["model"], mode]).sum().unstack(fill_value=0)
    modes = ("survives", "no_impact", "after_1", "after_2", "after_3", "after_more")
    parts = parts.rename(columns=dict(enumerate(modes, -1))).reset_index()
    found = {f"Parts of the map by impacts before a block overturns, {window.title}": parts}
    if lines is not None:
        ours, cells = lines["cells"].isna(), lines.astype({"cells": "Int64"})
        found |= {
            "Parts of the map that a model gets wrong, and where nine tenths of each lie": (
                lines[ours].dropna(axis=1, how="all")
            ),
            "Parts of the cells of a coarse grid that an engine gets wrong": (
                cells[~ours].dropna(axis=1, how="all")
            ),
        }
    if "edges" in tables:
        cases, thresholds = tables["edges"], tables["thresholds"]
        above = (cases["offset"] > 0.0) == (cases["overturns"] == "above")
        right = (cases["outcome"] == "overturned") == above
        distance = cases["offset"].abs().map("{:g}".format)
        beside = right.groupby([cases["source"], distance], sort=False).mean().unstack()
        shift = thresholds["shift"].abs().groupby(thresholds["source"], sort=False)
        shifts = shift.agg(asked="size", found="count", median="median", largest="max")
        found |= {
            "Parts of an engine's outcomes that are right, by the relative distance from an edge": (
                beside.reset_index()
            ),
            "Thresholds of an engine over the exact ones, less 1, where they are within 3 %": (
                shifts.reset_index()
            ),
        }
    return {**found, "What exact motions that survive need": needs(tables["validity"])}


def needs(forces: pd.DataFrame) -> pd.DataFrame:
    """Return how many survivors lift off, from which amplitude on, and the others' friction."""
    survives = forces["outcome"] == Outcome.ROCKED.value
    lifts = survives & (forces["min_normal"] < 0.0)
    friction = forces.loc[survives & ~lifts, "friction_needed"]
    counts = {"cells": len(forces), "survive": survives.sum(), "lift_off": lifts.sum()}
    ends = {"least_friction": friction.min(), "median_friction": friction.median()}
    return pd.DataFrame([{**counts, "from_onsets": forces.loc[lifts, "onsets"].min(), **ends}])


def figures(tables: Tables) -> Mapping[str, Figure]:
    """Draw the map, what is wrong on it, and where it is sensitive; or the planes."""
    from studies.drawing import overturning as drawing

    if "parts" in tables:
        widths = zip(("small", "large"), planes.WIDTHS_M, strict=True)
        known = tables["defaults"] if len(tables["parts"]) else pd.DataFrame()
        return {name: drawing.draw_plane(known, at) for name, at in widths if len(known)}
    window, areas = window_of(tables["window"]), tables["map"]
    kappa = drawing.draw_conditioning(tables["conditioning"], tables["validity"], window)
    drawn = {"map": drawing.draw_map(areas, window), "conditioning": kappa}
    if "differences" in tables:
        drawn["differences"] = drawing.draw_differences(areas, tables.get("engines"), window)
    return drawn


STUDY = Study(
    name="overturning",
    question="Which pulses overturn a block, and who predicts that wrongly?",
    help="""Overturning maps: which pulses overturn a block, after how many impacts.

Amplitude over frequency, slenderness or size, for each model; the engines on a coarse grid and
beside the edges; where each differs from the exact solution. With --planes the engines alone, pulse
by pulse, of two similar blocks. A run that was interrupted goes on when the same command is given
again.""",
    sources=(
        *("exact", "housner", "modified", "onset-matched"),
        *core_sources("naive"),
        *core_sources(),
    ),
    options=Options,
    quick="A coarser map and fewer runs of the engines.",
    jobs=jobs,
    measure=measure,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    # on the planes a failure of an engine is an answer
    needed=lambda rows: [it for it in rows if "table" in it or it["source"] == "exact"],
    rows="defaults",
    running=Running(time_limit=180.0),
    captions={
        "map": "Amplitude over frequency: which pulses overturn a block at once, which after an "
        "impact, and the least amplitude that overturns it by each linearization.",
        "differences": "The same map for each linearization and engine: where it overturns and the "
        "exact block survives, and the reverse.",
        "conditioning": "The same map with κ as colour, by which a small error of the pulse grows "
        "into one of the peak; lines: the friction that the exact motion needs, and where it would "
        "lift off.",
        "small": "Frequency and amplitude of full-sine pulses, a map for each engine as its "
        "documentation shows it, for the smaller block: where the outcome is wrong, and where the "
        "peak errs by more than a tenth.",
        "large": "The same maps for the larger block, which by similarity should look the same.",
    },
)
command = STUDY.command()
