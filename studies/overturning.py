"""Overturning maps: which pulses overturn a block, by which mode, and who predicts that wrongly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from itertools import product
from typing import Annotated

import numpy as np
import pandas as pd
from cyclopts import Parameter
from numpy.typing import NDArray

from analytic import MODELS, RigidBlock, simulate
from analytic.motion import Delayed
from studies.cases.paper import PULSES
from studies.cases.refusal import BadInputError
from studies.cases.window import LEAST_ONSETS, Window, pulse_of
from studies.kit.arguments import Positive, as_bad_input
from studies.kit.jobs import Job, Question, Row, answer
from studies.kit.say import part
from studies.kit.scene_options import Pulse
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.presets import titled
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, wrong_in
from studies.sources.registry import resolve

WINDOW = [item.name for item in fields(Window)]
FORCES = ["omega_over_p", "onsets", "outcome", "min_normal", "friction_needed"]
POINTS = 48
"""Columns and rows of the grid on which contact forces are computed, at most."""
ASPECTS, WIDTHS_M = (2.0, 3.0, 4.0), (0.5, 2.0)
RATIOS = tuple((0.5 * np.arange(1, 17)).tolist())
ONSETS = tuple((1.0 + 0.6 * (np.arange(15) + 0.5)).tolist())
"""Of the planes: H/B, B [m], ω/p, and amplitudes over g tan α."""
MAP_ONLY = ["low", "high", "columns", "rows", "areas", "forces"]
"""Columns of a map's rows that those of planes do not have."""
CASE = ["pulse", "aspect", "width_m", "onsets", "omega_over_p", "rest_s"]
CLOSE = 0.1
"""A peak within this part of the exact one is close."""
RIGHT, FALSE, MISSED, OFF, INVALID = "right", "false", "missed", "peak off", "invalid"
"""Verdicts, beside kinds of wrong outcomes; invalid where the block should slide or lift off."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which plane of pulses the models map."""

    pulse: Annotated[Pulse, Parameter(help="half-sine or full-sine.")] = "full-sine"
    aspect: Annotated[Positive, Parameter(help="H/B of the block.")] = 4.0

    def window(self, quick: bool) -> Window:
        """Return the plane that is asked for; BadInputError if no block of the shape is mapped."""
        with as_bad_input():
            cells = 200 if quick else 1000
            return Window(pulse=self.pulse, aspect=self.aspect, columns=cells, rows=cells)


def jobs(sources: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return a job for each model, which maps the plane, and those of engines on the planes."""
    for name in sources:
        if resolve(name).kind not in ("model", "engine"):
            raise BadInputError(f"--sources names {name!r}; it must name models and engines")
    models = [name for name in sources if name in MODELS]
    engines = [name for name in sources if name not in MODELS]
    found = map_jobs(models, options.window(quick)) if models else []
    return found + (plane_jobs(("exact", *engines), quick) if engines else [])


def map_jobs(models: Sequence[str], window: Window) -> list[Job]:
    """Return a job for the exact model and each other one, which maps a plane."""
    motion = pulse_of(window.block, window.pulse, window.onsets, window.high)
    case, named = Question(system=window.block, motion=motion), dict.fromkeys(("exact", *models))
    return [Job(labels=asdict(window), case=case, source=name) for name in named]


def plane_jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each pulse and block of the planes, and each source."""
    every = 3 if quick else 1
    pulses, aspects = (("full-sine",), (3.0,)) if quick else (tuple(PULSES), ASPECTS)
    found = []
    for pulse, aspect, width_m, onsets, ratio in product(
        pulses, aspects, WIDTHS_M, ONSETS[::every], RATIOS[::every]
    ):
        block = RigidBlock(width=width_m, height=aspect * width_m)
        motion = pulse_of(block, pulse, onsets, ratio)
        # before every other pulse of a plane all is at rest, and an engine may fall asleep
        rest_s = float((ONSETS.index(onsets) + RATIOS.index(ratio)) % 2)
        labels = {
            **{"pulse": pulse, "aspect": aspect, "width_m": width_m},
            "amplitude_g": onsets * math.tan(block.alpha),
            **{"onsets": onsets, "omega_over_p": ratio, "rest_s": rest_s},
        }
        case = Question(system=block, motion=Delayed(motion, rest_s) if rest_s else motion)
        found += [Job(labels=labels, case=case, source=source) for source in sources]
    return found


def measure(job: Job) -> Row:
    """Return an answer on a plane; or a model's map, with the exact motions' contact forces."""
    if "rows" not in job.labels:
        return answer(job)
    window = Window(**{name: job.labels[name] for name in WINDOW})
    areas = intervals(window.modes(job.source), window)
    held = forces(window) if job.source == "exact" else pd.DataFrame(columns=FORCES)
    lists = {"areas": areas.to_dict("list"), "forces": held.to_dict("list")}
    return {"outcome": "mapped", "message": "", **lists}


def intervals(modes: NDArray[np.int32], window: Window) -> pd.DataFrame:
    """Return the intervals of one mode in each column, from below."""
    begins = np.diff(modes, axis=1, prepend=modes[:, :1] + 1) != 0
    column, row = np.nonzero(begins)
    low = LEAST_ONSETS + row * window.cell
    found = pd.DataFrame({"omega_over_p": window.ratios(window.columns)[column], "low": low})
    high = found.groupby("omega_over_p")["low"].shift(-1).fillna(window.onsets)
    return found.assign(high=high, mode=modes[column, row])


def modes_of(areas: pd.DataFrame, window: Window) -> NDArray[np.int32]:
    """Return the mode in each cell of a model's intervals, (columns, rows)."""
    cells = ((areas["high"] - areas["low"]) / window.cell).round().astype(int)
    modes: NDArray[np.int32] = np.repeat(areas["mode"].to_numpy(), cells)
    return modes.reshape(window.columns, window.rows)


def forces(window: Window) -> pd.DataFrame:
    """Return the least normal force over the weight, and the friction, that exact motions need."""
    found = []
    for ratio, onsets in product(
        window.ratios(min(window.columns, POINTS)).tolist(),
        window.amplitudes(min(window.rows, POINTS)).tolist(),
    ):
        it = simulate(window.block, pulse_of(window.block, window.pulse, onsets, ratio))
        found.append((ratio, onsets, it.outcome.value, it.min_normal, it.friction_needed))
    return pd.DataFrame(found, columns=FORCES)


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tables of a map, and of planes."""
    mapped = rows["outcome"] == "mapped"
    tables = dict(map_tables(rows[mapped])) if mapped.any() else {}
    if not mapped.all():
        tables |= plane_tables(rows[~mapped].drop(columns=MAP_ONLY, errors="ignore"))
    return tables


def map_tables(rows: pd.DataFrame) -> Tables:
    """Return the plane, the areas of each model, where models are wrong, and contact forces."""
    plane = rows[WINDOW].head(1).astype({"columns": int, "rows": int})
    window = window_of(plane)
    areas = {name: pd.DataFrame(of) for name, of in zip(rows["source"], rows["areas"], strict=True)}
    exact = modes_of(areas["exact"], window)
    lines = []
    for model in [*areas][1:]:
        found = modes_of(areas[model], window)
        parts = {
            FALSE: (exact < 0) & (found >= 0),
            MISSED: (exact >= 0) & (found < 0),
            "other_mode": (exact >= 0) & (found >= 0) & (exact != found),
        }
        lines.append({"source": model, **{name: float(at.mean()) for name, at in parts.items()}})
    whole = pd.concat(areas, names=["model"]).reset_index(level="model").reset_index(drop=True)
    tables = {"window": plane, "map": whole, "validity": pd.DataFrame(rows["forces"].iloc[0])}
    return tables | ({"differences": pd.DataFrame(lines)} if lines else {})


def window_of(table: pd.DataFrame) -> Window:
    """Return the plane of a map from its window.csv."""
    return Window(**{str(name): value for name, value in table.to_dict("records")[0].items()})


def with_verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Add to the rows of planes the error of a peak and the verdict."""
    exact = rows[rows["source"] == "exact"].set_index(CASE)[["outcome", "peak_ratio"]]
    # of the block without the rest before; inf if it would lift off
    exact["needed"] = [
        simulate(block, pulse_of(block, pulse, onsets, ratio)).friction_needed
        for pulse, aspect, width, onsets, ratio, _ in exact.index
        for block in [RigidBlock(width=width, height=aspect * width)]
    ]
    right = exact.reindex(pd.MultiIndex.from_frame(rows[CASE])).reset_index(drop=True)
    found = rows.reset_index(drop=True)
    exact_as = {"outcome": "exact_outcome", "peak_ratio": "exact_peak"}
    beside = found[[*exact_as]].join(right[[*exact_as]].rename(columns=exact_as))
    kinds, falls = wrong_in(beside), right["outcome"] == "overturned"
    side = np.where(falls, MISSED, FALSE)
    verdict = np.select([kinds == "", kinds == FALL], [RIGHT, side], kinds)
    with np.errstate(invalid="ignore"):
        error = found["peak_ratio"] / right["peak_ratio"] - 1.0
    error = error.where((verdict == RIGHT) & ~falls)
    asked = {name: resolve(name) for name in found["source"].unique()}
    friction = {name: it.used.settings.friction for name, it in asked.items() if it.engine}
    slides = right["needed"] > found["source"].map(friction)
    verdict = np.where(slides, INVALID, np.where(error.abs() > CLOSE, OFF, verdict))
    return found.assign(error=error, verdict=verdict)


def plane_tables(rows: pd.DataFrame) -> Tables:
    """Return the rows, and a line for each engine and width."""
    known = with_verdicts(rows)
    written = known.drop(columns="error").astype({"impacts": int, "steps": int})
    known = known[(known["source"] != "exact") & (known["verdict"] != INVALID)]
    counted = {
        **{"close": [RIGHT], "far": [OFF]},
        **{"false_overturnings": [FALSE], "missed_overturnings": [MISSED]},
        **{FALL: [FALSE, MISSED], REST: [REST], NO_ANSWER: [NO_ANSWER]},
    }
    marks = {name: known["verdict"].isin(verdicts) for name, verdicts in counted.items()}
    known = known.assign(size=known["error"].abs(), **marks)
    sums = {name: (name, "sum") for name in ("wall_s", *counted)}
    parts = known.groupby(["source", "width_m"], sort=False).agg(
        cases=("close", "size"),
        **{name: sums[name] for name in [*counted][:4]},
        median_error=("size", "median"),
        p90_error=("size", lambda size: size.quantile(0.9)),
        **{name: sums[name] for name in ("wall_s", *KINDS)},
    )
    return {"defaults": written, "parts": parts.reset_index()}


def finding(tables: Tables) -> str:
    """Say how much of the map a linearization gets wrong, and between what engines predict."""
    said = []
    if "differences" in tables:
        lines = tables["differences"].set_index("source")
        wrong = lines[FALSE] + lines[MISSED]
        worst = titled(str(wrong.idxmax()))
        said.append(f"{worst} is wrong on {100.0 * wrong.max():.2g} % of the map.")
    if "parts" in tables:
        sums = tables["parts"].groupby("source", sort=False)[["close", "cases"]].sum()
        shares = (sums["close"] / sums["cases"]).sort_values()
        first, last = shares.index[[0, -1]]
        ends = {it: f"{part(shares[it])} of the pulses with {titled(it)}" for it in (first, last)}
        said.append(f"Peaks are within {part(CLOSE)} for {' and '.join(ends.values())}.")
    return " ".join(said) or "The exact solution maps the plane."


def shown(tables: Tables) -> Tables:
    """Return the short tables beside the finding."""
    found = {}
    if "map" in tables:
        window, areas = window_of(tables["window"]), tables["map"]
        sizes = (areas["high"] - areas["low"]) / (window.onsets - LEAST_ONSETS) / window.columns
        parts = sizes.groupby([areas["model"], areas["mode"].clip(-1, 4)]).sum()
        modes = ("survives", "no_impact", "after_1", "after_2", "after_3", "after_more")
        wide = parts.unstack(fill_value=0).rename(columns=dict(enumerate(modes, -1)))
        title = f"Parts of the map by impacts before a block overturns, {window.title}"
        found = {title: wide.reset_index()}
        if "differences" in tables:
            found["Parts of the map that a model gets wrong"] = tables["differences"]
    if "parts" in tables:
        found["Pulses by the width of the block"] = tables["parts"]
    return found


def figures(tables: Tables) -> Figures:
    """Draw the map, and what is wrong on it; and the planes."""
    from studies.drawing import overturning as drawing

    drawn = {}
    if "map" in tables:
        window, areas = window_of(tables["window"]), tables["map"]
        modes = {
            str(name): modes_of(mine, window) for name, mine in areas.groupby("model", sort=False)
        }
        drawn["map"] = drawing.draw_map(modes, tables["validity"], window)
    if "parts" in tables:
        rests = {"at-once": 0.0, "after-rest": 1.0}
        drawn |= {name: drawing.draw_plane(tables["defaults"], at) for name, at in rests.items()}
    return drawn


STUDY = Study(
    name="overturning",
    question="Which pulses overturn a block, and where do sources err?",
    help="""Overturning maps: which pulses overturn a block, after how many impacts.

Maps of amplitude against frequency, and where each model differs from the exact solution; where
the exact motion needs much friction, or would lift off. Engines, as in --sources engines:default,
compute single pulses on two similar blocks.""",
    sources=("exact", "housner", "modified", "onset-matched"),
    options=Options,
    quick="A coarser map, and fewer pulses for engines.",
    # on planes a failure of an engine is an answer
    needed=lambda rows: [row for row in rows if row["source"] in MODELS],
    rows="defaults",
    captions={
        "map": "Pulses that overturn a block at once or after an impact, the friction that the "
        "exact motion needs, and where it would lift off; and for each linearization the pulses "
        "for which it wrongly overturns the block, or wrongly lets it survive.",
        "at-once": "Pulses without rest before them, for each engine with default settings: where "
        "the outcome is wrong, and where the peak errs by more than a tenth. Every other pulse was "
        "computed, and stands for its neighbour.",
        "after-rest": "The same maps for pulses after a second of rest, in which an engine may put "
        "the block to sleep.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
