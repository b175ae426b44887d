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

from analytic import Delayed, Record, RockingFrame, SinePulse, SlidingBlock, Still
from analytic.block import GRAVITY
from analytic.response import Outcome, Reason, Response
from analytic.simulate import simulate
from engines.factors import DEFAULT
from engines.run.run import LAG
from studies.cases.drawn import calm_frames, slides
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import listed, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.presets import engine_of, in_order, is_engine, preset_of, titled
from studies.measures.wrongness import FALL, NO_ANSWER, WORDS, kind_of
from studies.sources.registry import Source, core_sources, resolve

PULSES = ((0.4, 6.2832), (0.45, 8.0), (0.5, 9.0))
"""Amplitude [g] and circular frequency [rad/s] of full sines."""
RIDE = SinePulse(amplitude=1.0, omega=2.0 * math.pi, half_cycles=4)
"""Of a floor, which a block with a friction of 1 rides over 0.32 m."""
SEED, CASES = 54, 60
"""Of the random frames and slides."""
SEEN = {
    "frame": ("parting", "tilt", "drift_m"),
    "slide": ("place_m", "lift_m", "flat_m", "turn_rad"),
    "floor": (LAG,),
}
"""What an engine shows of a scene besides."""
RANDOM = "random-"
"""How the name of a scene begins whose cases are drawn."""
TABLES = ("frame", f"{RANDOM}frame", "slide", f"{RANDOM}slide", "floor")
DRAWN = ("aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p")
RIGHT, MISSED, THROWN_OFF = "right", "missed slip", "thrown off"
"""Verdicts on a slide, beside `WORDS`; see `engines.run.slide.LEAST_LIFT`."""


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the job of every case and source: of frames first."""
    asked = [resolve(name) for name in sources]
    chosen = [*_frames(asked, quick), *_slides(asked, quick), *_floors(asked)]
    return [*chosen, *_drawn(asked, 3 if quick else CASES)]


def _job(scene: str, labels: Row, case: Question, source: Source, **options: Any) -> Job:
    return Job(labels={"scene": scene, **labels}, case=case, source=source.name, options=options)


def _frames(sources: Sequence[Source], quick: bool) -> Iterator[Job]:
    posed = product((0.5, 2.0, 4.0), (2, 3), PULSES) if not quick else [(2.0, 2, PULSES[0])]
    for load, columns, (amplitude_g, omega) in posed:
        case = Question(
            system=RockingFrame(width=0.5, height=1.5, columns=columns, load=load),
            motion=SinePulse.in_g(amplitude_g, omega=omega, half_cycles=2),
        )
        for source in sources:
            # where in a step an impact falls costs per mille
            for phase, options in enumerate(_steps(source, case, 2 if quick else 4)):
                labels = {"columns": columns, "load": load, "amplitude_g": amplitude_g}
                labels |= {"omega": omega, "phase": phase}
                yield _job("frame", labels, case, source, **options)


def _steps(source: Source, case: Question, phases: int) -> Iterator[Row]:
    """Yield steps by which the first impact falls into different parts of equal ones."""
    # n = t/dt steps before an impact at t, a step of dt (1 + k/(N n)) has it k/N of a step earlier
    if not source.engine or source.accurate:
        yield {}
        return
    used = source.used
    step = used.step if math.isfinite(used.step) else used.step_s * case.system.p
    impact = exact_of(case).impacts[0].time * case.system.p
    for phase in range(phases):
        yield {"step": step * (1.0 + phase / phases * step / impact)}


def _slides(sources: Sequence[Source], quick: bool) -> Iterator[Job]:
    """Yield the blocks that slide; steps that land on impacts are not asked."""
    sine = SinePulse.in_g(0.4, omega=2.0 * math.pi, half_cycles=2)
    cube = SlidingBlock(width=1.0, height=1.0, friction=0.5)
    below = Record(dt=2.0, samples=np.full(2, 0.9 * 0.2 * GRAVITY))
    cases = {
        f"sine, friction {friction:g}": Question(system=_flat(friction), motion=sine)
        for friction in ((0.2,) if quick else (0.1, 0.2, 0.3))
    }
    cases["launched at 6 m/s, friction 0.5"] = Question(
        system=cube, motion=Still(), start=(0.0, 6.0)
    )
    cases["held at 0.9 of friction 0.2"] = Question(system=_flat(0.2), motion=below)
    for (case, question), source in product(cases.items(), sources):
        if not source.lands:
            yield _job("slide", {"case": case}, question, source)


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


def _drawn(sources: Sequence[Source], cases: int) -> Iterator[Job]:
    """Yield random frames, and random slides without steps that land, each source at its steps."""
    frames = islice(calm_frames(SEED), cases)
    posed: list[tuple[str, Row, Any, SinePulse]] = [
        ("frame", {"columns": it.columns, "load": it.load}, it.block, it.motion) for it in frames
    ]
    boxes = islice(slides(SEED), cases)
    posed += [("slide", {"friction": box.friction}, box, pulse) for box, pulse in boxes]
    for (scene, labels, system, motion), source in product(posed, sources):
        if scene == "frame" or not source.lands:
            pulse = motion.half_cycles, motion.amplitude / GRAVITY, motion.omega / system.p
            sizes = system.height / system.width, system.width
            drawn = dict(zip(DRAWN, (*sizes, *pulse), strict=True))
            case = Question(system=system, motion=motion)
            yield _job(RANDOM + scene, labels | drawn, case, source)


@cache  # one for all sources
def exact_of(case: Question) -> Response:
    """Return the exact response."""
    return simulate(case.system, case.motion, start=case.start)


def measure(job: Job) -> Row:
    """Return the summary, and how far the response is from the exact one of its scene."""
    response, case = ask(job), job.case
    scene = str(job.labels["scene"]).removeprefix(RANDOM)
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
    for name in TABLES:
        tables[name] = mine = rows.get(name, pd.DataFrame())
        tables[f"{name}-summary"] = summed(mine, name.removeprefix(RANDOM))
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
    """Return the rows of what an engine is built for."""
    return rows[rows["reason"] != Reason.UNAVAILABLE.name]


def _of_frames(rows: pd.DataFrame) -> Row:
    size = rows["error"].abs()
    return {
        "frames": len(rows),
        "wrong": int((~rows["right"]).sum()),
        "parted": int((rows["reason"] == Reason.PARTED.name).sum()),
        **_quantiles("error", size),
        **_quantiles("difference", size * rows["exact"]),
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
    """Say how far off the engines are on random cases with their best presets, and who throws."""
    chosen = {scene: tables[f"{scene}-summary"] for scene in ("frame", "slide")}
    drawn = {scene: tables.get(f"{RANDOM}{scene}-summary", it) for scene, it in chosen.items()}
    frames, boxes = map(_best, drawn.values())
    known = {"the largest rotation of a frame": frames, "a slip of a block": boxes}
    best = {what: lines for what, lines in known.items() if len(lines)}
    if not best:
        return "None of these engines supports these scenes."
    off = [f"{what} by up to {part(lines['max_error'].max())}" for what, lines in best.items()]
    wrong = sum(int(lines["wrong"].sum()) for lines in best.values())
    beside = f", with {wrong} wrong outcomes" if wrong else ""
    every = pd.concat([chosen["slide"], drawn["slide"]])
    thrown = every.reindex(columns=["source", "thrown_off"]).query("thrown_off > 0")["source"]
    lost = f" A sliding block takes off in {listed(map(titled, thrown.unique()))}."
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
        "Rocking frames: errors of the peak, and as differences over θcr": tables["frame-summary"],
        "Random frames": tables[f"{RANDOM}frame-summary"],
        "Sliding blocks": tables["slide-summary"],
        "Random slides": tables[f"{RANDOM}slide-summary"],
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

A frame is a beam on two or three free columns, which rock like a block of another size and
restitution. A slide is two slips under a pulse, a launch, or a hold below the onset; it is right
only if the block stays flat and on the base. The floor moves in each way that an engine offers, and
should carry a block along. Landing steps apply to frames only. 60 random frames and 60 random
slides test settings that were not tuned on them. A row says what an engine cannot do. Takes two
hours.""",
    sources=core_sources("default", "tuned", "landing"),
    quick="One frame and one slide, two offsets of the steps, three random cases of each.",
    needed=lambda rows: [row for row in rows if row["reason"] != Reason.UNAVAILABLE.name],
    split="scene",
    captions={
        "frame-time": "Each engine and preset on frames: the median and the largest error of the "
        "peak, the number of wrong outcomes, and the run time of a case.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
