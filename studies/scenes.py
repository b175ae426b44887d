"""Scenes beyond one block: a frame, a slide and a moving floor, beside their exact solutions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from functools import cache
from itertools import islice, product
from typing import Any, cast

import numpy as np
import pandas as pd

from analytic import GRAVITY, Delayed, Record, SinePulse, SlidingBlock, simulate
from analytic.response import Outcome, Reason, Response
from engines.factors import DEFAULT
from engines.run.run import LAG
from studies.cases.drawn import calm_frames, slides
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import listed, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.presets import engine_of, in_order, is_engine, preset_of, titled
from studies.measures.wrongness import FALL, NO_ANSWER, WORDS, kind_of
from studies.sources.registry import Source, core_sources, resolve

RIDE = SinePulse(amplitude=1.0, omega=2.0 * math.pi, half_cycles=4)
"""Of a floor, which a block with a friction of 1 rides over 0.32 m."""
SEED, CASES = 54, 60
"""Of the random frames and slides."""
SEEN = {
    "frame": ("parting", "tilt", "drift_m"),
    "slide": ("place_m", "lift_m", "flat_m", "turn_rad"),
    "floor": (LAG,),
}
"""Scene, of a table of its own -> what an engine shows of it besides."""
INSTEAD = r"^as (\w+:[\w-]+)"
"""How a message begins where a preset stands in for one that a scene does not allow."""
RIGHT, MISSED, THROWN_OFF = "right", "missed slip", "thrown off"
"""Verdicts on a slide, beside `WORDS`; see `engines.run.slide.LEAST_LIFT`."""


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the job of every case and source: of random frames first."""
    asked, cases = [resolve(name) for name in sources], 3 if quick else CASES
    return [*_frames(asked, cases), *_slides(asked, cases), *_floors(asked)]


def _job(scene: str, labels: Row, case: Question, source: Source, **options: Any) -> Job:
    return Job(labels={"scene": scene, **labels}, case=case, source=source.name, options=options)


def _frames(sources: Sequence[Source], cases: int) -> Iterator[Job]:
    for number, frame in enumerate(islice(calm_frames(SEED), cases)):
        case = Question(system=frame.block, motion=frame.motion)
        labels = {"case": number, "columns": frame.columns, "load": frame.load, **_drawn(case)}
        for source in sources:
            yield _job("frame", labels, case, source)


def _drawn(case: Question) -> Row:
    system, pulse = case.system, cast(SinePulse, case.motion)
    return {
        "aspect": system.height / system.width,
        "width_m": system.width,
        "half_cycles": pulse.half_cycles,
        "amplitude_g": pulse.amplitude / GRAVITY,
        "omega_over_p": pulse.omega / system.p,
    }


def _slides(sources: Sequence[Source], cases: int) -> Iterator[Job]:
    """Yield blocks that slide, and one that is held; steps that land on impacts are not asked."""
    posed = list[tuple[Row, Question]]()
    for number, (box, pulse) in enumerate(islice(slides(SEED), cases)):
        case = Question(system=box, motion=pulse)
        posed.append(({"case": number, "friction": box.friction, **_drawn(case)}, case))
    below = Record(dt=2.0, samples=np.full(2, 0.9 * 0.2 * GRAVITY))
    held = Question(system=_flat(0.2), motion=below)
    posed.append(({"case": "held at 0.9 of its friction", "friction": 0.2}, held))
    for (labels, case), source in product(posed, sources):
        if not source.lands:
            yield _job("slide", labels, case, source)


def _flat(friction: float) -> SlidingBlock:
    return SlidingBlock(width=1.0, height=0.5, friction=friction)


def _floors(sources: Sequence[Source]) -> Iterator[Job]:
    """Yield a block on a floor that moves, as documented but in every way that an engine has."""
    for source in sources:
        if not (source.engine and source.preset == DEFAULT and source.used.frame == "world"):
            continue
        known = {each.name: each.metadata for each in fields(cast(Any, source.used.settings))}
        for floor, rest_s in product(known["floor"]["allowed"].names, (0.0, 1.0)):
            motion = Delayed(RIDE, rest_s) if rest_s else RIDE
            case = Question(system=_flat(1.0), motion=motion)
            labels = {"floor": floor, "rest_s": rest_s}
            yield _job("floor", labels, case, source, settings={"floor": floor})


@cache  # one for all sources
def exact_of(case: Question) -> Response:
    """Return the exact response."""
    return simulate(case.system, case.motion, start=case.start)


def measure(job: Job) -> Row:
    """Return the summary, and how far the response is from the exact one of its scene."""
    response, case = ask(job), job.case
    scene = str(job.labels["scene"])
    exact = exact_of(case)
    row = {**summary(response), "reason": response.reason.name if response.reason else ""}
    seen = {name: _seen(response, name) for name in SEEN[scene]}
    if scene == "frame":
        right = not kind_of(response, exact)
        both = right and exact.outcome is Outcome.ROCKED
        error = response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan
        return {**row, "exact": exact.peak_ratio, "right": right, "error": error, **seen}
    if scene == "slide":
        slips = {"slips": len(response.slips), "exact_slips": len(exact.slips)}
        missed = _slip_error(response, exact)
        error = missed / max(map(abs, exact.slips), default=math.nan)
        found = {"slip_error_m": missed, "verdict": _verdict(response, exact), "slip_error": error}
        return {**row, **slips, **found, **seen}
    travel = float(case.motion.displacement(case.motion.duration))
    return {**row, "carried": 1.0 + _seen(response, "place_m") / travel, **seen}


def _seen(response: Response, name: str) -> float:
    return float(response.observables.get(name, math.nan))


def _verdict(response: Response, exact: Response) -> str:
    """Say whether a block slid as often as it should, and flat."""
    if response.outcome is Outcome.FAILED:
        return WORDS[NO_ANSWER]
    if response.outcome is Outcome.OVERTURNED:
        return WORDS[FALL]
    if len(response.slips) < len(exact.slips):
        return MISSED
    return THROWN_OFF if _seen(response, "lift_m") > _seen(response, "flat_m") else RIGHT


def _slip_error(response: Response, exact: Response) -> float:
    """Return the largest error of a slip [m]; of a block that is held, how far it crept."""
    if response.outcome is Outcome.FAILED or len(response.slips) < len(exact.slips):
        return math.nan
    if not exact.slips:
        return abs(_seen(response, "place_m"))
    least = sorted(map(abs, response.slips))[-len(exact.slips)]
    longest = [slip for slip in response.slips if abs(slip) >= least]
    return max(abs(one - other) for one, other in zip(longest, exact.slips, strict=True))


def tabulate(rows: Tables) -> Tables:
    """Return the rows of each scene, and a line for each source that is built for it."""
    tables = {}
    for name in SEEN:
        tables[name] = mine = rows.get(name, pd.DataFrame())
        tables[f"{name}-summary"] = summed(mine, name)
    return tables


def summed(rows: pd.DataFrame, scene: str) -> pd.DataFrame:
    """Return a line for each source that is built for a scene, from its rows."""
    if rows.empty:
        return rows
    keys = ["source", "floor"] if scene == "floor" else ["source"]
    groups = built(rows).groupby(keys, sort=False)
    lines = [dict(zip(keys, key, strict=True)) | SUMMED[scene](of) for key, of in groups]
    return pd.DataFrame(lines)


def built(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of what an engine is built for, once, under the preset that was used."""
    used = rows["message"].astype(str).str.extract(INSTEAD)[0].fillna(rows["source"])
    rows = rows[rows["reason"] != Reason.UNAVAILABLE.name].assign(source=used)
    case = [name for name in ("case", "floor", "rest_s", "source") if name in rows]
    return rows.drop_duplicates(case, ignore_index=True)


def _of_frames(rows: pd.DataFrame) -> Row:
    # of more columns than two several motions are exact: see EQUATIONS.md, "The rocking frame"
    rows = rows.assign(size=rows["error"].abs(), parted=rows["reason"] == Reason.PARTED.name)
    two, more = (rows[(rows["columns"] == 2) == it] for it in (True, False))
    return {
        "frames": len(two),
        "wrong": len(two) - int(two["right"].sum()),
        **_quantiles("error", two["size"]),
        **_quantiles("difference", two["size"] * two["exact"]),
        "more": len(more),
        "more_wrong": len(more) - int(more["right"].sum()),
        "more_parted": int(more["parted"].sum()),
        "more_median_error": more["size"].median(),
        "ms_a_frame": 1e3 * rows["wall_s"].mean(),
    }


def _quantiles(name: str, size: pd.Series[float]) -> Row:
    levels = {"median": 0.5, "p90": 0.9, "max": 1.0}
    return {f"{word}_{name}": size.quantile(level) for word, level in levels.items()}


def _of_slides(rows: pd.DataFrame) -> Row:
    held = rows["exact_slips"] == 0
    crept = {"creep_m": rows.loc[held, "slip_error_m"].max()} if held.any() else {}
    return {
        "slides": len(rows),
        "wrong": int((rows["verdict"] != RIGHT).sum()),
        "thrown_off": int((rows["verdict"] == THROWN_OFF).sum()),
        **_quantiles("error", rows["slip_error"]),
        "largest_slip_error_m": rows.loc[~held, "slip_error_m"].max(),
        **crept,
        "lift_m": rows["lift_m"].max(),
        "ms_a_slide": 1e3 * rows["wall_s"].mean(),
    }


def _of_floors(rows: pd.DataFrame) -> Row:
    rested = rows["rest_s"] > 0.0
    return {
        "carried": rows.loc[~rested, "carried"].max(),
        "carried_after_rest": rows.loc[rested, "carried"].max(),
        LAG: rows[LAG].max(),
    }


SUMMED = {"frame": _of_frames, "slide": _of_slides, "floor": _of_floors}
"""Scene -> what makes a line of its rows."""


def finding(tables: Tables) -> str:
    """Say how far off the engines are with their best presets, and who throws a block off."""
    known = {"the rotation of a frame on two columns": "frame", "a slip of a block": "slide"}
    lines = {what: _best(tables[f"{scene}-summary"]) for what, scene in known.items()}
    best = {what: of for what, of in lines.items() if len(of)}
    if not best:
        return "None of these engines supports these scenes."
    off = [f"{what} by up to {part(of['max_error'].max())}" for what, of in best.items()]
    wrong = sum(int(of["wrong"].sum()) for of in best.values())
    beside = f", with {wrong} wrong outcomes" if wrong else ""
    every = tables["slide-summary"].reindex(columns=["source", "thrown_off"])
    thrown = every.query("thrown_off > 0")["source"]
    lost = f" A sliding block takes off in {listed(map(titled, thrown))}."
    said = f"With their best presets engines miss {listed(off)}{beside}."
    return said + lost * (len(thrown) > 0)


def _best(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the last, which is the best, of each engine's presets."""
    lines = _engines_in(lines)
    if lines.empty:
        return lines
    presets = lines["source"].map(preset_of)
    places = presets.map(in_order(presets).index)
    return lines.loc[places.groupby(lines["source"].map(engine_of), sort=False).idxmax()]


def shown(tables: Tables) -> Tables:
    """Return the line of each source and scene."""
    return {
        "Frames on two columns: errors of the peak, and as differences over θcr; more: frames on "
        "three or four, of which several motions are exact": tables["frame-summary"],
        "Sliding blocks": tables["slide-summary"],
        "How much of a floor's way it carries a block": tables["floor-summary"],
    }


def figures(tables: Tables) -> Figures:
    """Draw the errors and run times of frames."""
    from studies.drawing.rows import draw_overview

    lines = _engines_in(tables["frame-summary"]).rename(
        columns={"frames": "cases", "median_error": "median", "max_error": "max"}
    )
    if lines.empty:
        return {}
    named = {"engine": lines["source"].map(engine_of), "preset": lines["source"].map(preset_of)}
    return {"frame-time": draw_overview(lines.assign(**named, ms=lines["ms_a_frame"]))}


def _engines_in(lines: pd.DataFrame) -> pd.DataFrame:
    return lines[np.array([is_engine(name) for name in lines.get("source", ())], bool)]


STUDY = Study(
    name="scenes",
    question="Do engines predict frames, sliding blocks and moving floors?",
    help="""A frame, a sliding block and a moving floor, compared with their exact solutions.

A frame is a beam on two to four free columns, which rock like a block of another size and
restitution. A sliding block slips under a pulse, or is held below the onset; it is right only if
the block stays flat and on the base. 60 frames and 60 slides are random; settings of PyBullet,
Box2D and Newton were mended on the frames. The floor moves in each way that an engine offers, and
should carry a block along. Landing steps apply to frames only. Takes two hours.""",
    sources=core_sources("default", "tuned", "landing"),
    quick="Three frames and three slides.",
    needed=lambda rows: [row for row in rows if row["reason"] != Reason.UNAVAILABLE.name],
    split="scene",
    captions={
        "frame-time": "Each engine and preset on frames of two columns: the median and the largest "
        "error of the peak, the number of wrong outcomes, and the run time of a case.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
