"""A block that strikes its base with a corner: which coefficient of restitution an engine gives."""
# The corner goes on without sliding, upwards with e times the speed 2 b omega of its approach. The
# moment of momentum about it is kept: (4/3) R^2 (omega - omega') = 2 b^2 (1 + e) omega, so that
# omega'/omega = 1 - (3/2) (1 + e) sin(alpha)^2; the other corner lifts if sin(alpha)^2 < 2/3.

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import cast

import pandas as pd

from analytic import RigidBlock, SinePulse
from engines import ENGINES, installed_engines
from engines.run.run import build
from engines.world import ContactPhase, Pose, Step
from studies.cases.refusal import BadInputError
from studies.cases.ways import WAYS, WITHOUT
from studies.kit.arguments import Engines
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import listed, one_line, out_of
from studies.kit.study import Figures, Study, Tables, stages
from studies.sources.registry import scene_of

VARIED = {
    "p_dt": (1e-3, 1e-4, 4e-3),
    "rate_over_alpha_p": (0.5, 0.1, 2.0),
    "height_m": (1.0, 0.1, 10.0),
    "aspect": (2.0, 4.0),
}
"""Step, angular rate at the impact, H and H/B: the usual value of each, and others."""
USUAL = {name: usual for name, (usual, *_) in VARIED.items()}
AHEAD = 20
"""Steps to that of the impact."""
SLIDES = 0.1
"""A corner that leaves faster along the base than this part of its approach has slid."""
SHOWN = 0.6
"""The coefficient for which settings are quoted."""
STILL = SinePulse(amplitude=0.0, omega=1.0, half_cycles=1)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which engines."""

    engines: Engines = tuple(name for name in installed_engines() if name in WAYS)


def jobs(_: Sequence[str], __: bool, options: Options) -> list[Job]:
    """Return a job for each engine, way to ask it, and strike, one thing varied at a time."""
    for name in options.engines:
        if name not in WAYS:
            why = f", which has no coefficient: {WITHOUT[name]}" if name in WITHOUT else ""
            able = f"it must be one that was tried: {', '.join(WAYS)}"
            raise BadInputError(f"--engines is {name!r}{why}; {able}")
    others = [(name, {name: value}) for name, all_ in VARIED.items() for value in all_[1:]]
    wanted, parts_of_a_step = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0), (0.1, 0.5, 0.9)
    strikes = list(product([("", {}), *others], wanted, parts_of_a_step))
    return [
        job_of(engine, way, e, phase, name, **other)
        for engine in options.engines
        for way in WAYS[engine]
        for (name, other), e, phase in strikes
    ]


def job_of(
    engine: str, way: str, wanted: float, phase: float = 0.5, varied: str = "", **other: float
) -> Job:
    """Return the job of a strike, which begins some steps before the impact."""
    step, rate, height, aspect = (USUAL | other).values()
    block = RigidBlock(width=height / aspect, height=height)
    tilt = (AHEAD + phase) * rate * block.alpha * step
    omega, rise = rate * block.p * block.alpha, math.cos(block.alpha - tilt) - math.cos(block.alpha)
    start = (-tilt, math.sqrt(omega**2 - 2.0 * block.p**2 * rise))
    settings = dict(WAYS[engine][way].settings(wanted, step / block.p))
    labels = {"engine": engine, "way": way, "varied": varied, "wanted": wanted, "phase": phase}
    return Job(
        labels={**labels, **USUAL, **other},
        case=Question(system=block, motion=STILL, start=start),
        source=f"{engine}:tuned",
        options={"step": step, "settings": settings},
    )


def measure(job: Job) -> Row:
    """Return what the block keeps of its rate and of its corner's speed; nan where a run broke."""
    nothing = (math.nan, math.nan, math.nan)
    found, outcome, message = nothing, "failed", job.lost.message if job.lost else ""
    try:
        if not job.lost:
            struck, message = strike(job)
            found, outcome = nothing if message else struck, "struck"
    except Exception as error:
        message = one_line(error)
    sine_2 = math.sin(job.case.system.alpha) ** 2
    return {
        "kept_ratio": 1.0 - 1.5 * (1.0 + job.labels["wanted"]) * sine_2,
        **dict(zip(("rate_ratio", "corner_ratio", "slide_ratio"), found, strict=True)),
        **{"outcome": outcome, "message": message},
    }


def strike(job: Job) -> tuple[tuple[float, float, float], str]:
    """Let a block strike its base; return its rate and the corner's speeds, after over before."""
    # where the corner comes off, the block flies; else its rate is taken back to the impact
    case, labels = job.case, job.labels
    scene = scene_of(case.system, case.motion, job.asked.preset, **job.settings)
    world = build(job.asked.declared.use(scene))
    block = cast("RigidBlock", case.system)
    half_width, half_height = 0.5 * block.width, 0.5 * block.height
    dt, omega = labels["p_dt"] / block.p, labels["rate_over_alpha_p"] * block.p * block.alpha
    approach = 2.0 * half_width * omega

    def corner(pose: Pose) -> tuple[float, float]:
        """Return where the striking corner is along and above the base [m]."""
        sine, cosine = math.sin(pose.theta), math.cos(pose.theta)
        along = pose.x + half_width * cosine - half_height * sine
        return along, pose.z - half_width * sine - half_height * cosine

    try:
        pose, kick, slide = Pose(*world.state()[0]), world.moment.value * dt, 0.0
        for number in range(AHEAD + 41):  # within 40 steps of the impact it must come off again
            (x, z), end = corner(pose), (number + 1) * dt
            pull = -block.gravity * kick / dt
            world.step(Step(dt, end, kick, 0.0, pull, 0.0, 0.0, 0.0, ContactPhase.SWING, 0.0))
            pose, kick = Pose(*world.state()[0]), dt
            new_x, new_z = corner(pose)
            rise, slide = (new_z - z) / dt / approach, (new_x - x) / dt / approach
            if z > 0.0 and rise > 0.01:
                return (pose.rate / omega, rise, slide), world.fault()
        fall = math.cos(block.alpha - abs(pose.theta)) - math.cos(block.alpha)
        at_level = math.sqrt(pose.rate**2 + 2.0 * block.p**2 * fall)
        return (math.copysign(at_level, pose.rate) / omega, 0.0, slide), world.fault()
    finally:
        world.close()


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the strikes, and for each way how far off the corner's speed is."""
    struck = rows.drop(columns=["source", "outcome", "message"])
    return {"restitution": struck, "corners": deviations(struck)}


def deviations(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and way: how far a corner is off its coefficient at most."""
    kept = rows["corner_ratio"] < 10.0  # else the corner was thrown, or the library went wrong
    off = (rows["corner_ratio"] - rows["wanted"]).abs().where(kept, math.inf)
    rows = rows.assign(off=off, slide=rows["slide_ratio"].abs())
    table = []
    for (engine, way), group in rows.groupby(["engine", "way"], sort=False):
        usual = group.loc[group["varied"] == "", ["off", "slide"]].max()
        table.append(
            {
                **{"engine": engine, "way": way, "off": usual["off"]},
                "off_over_all": group["off"].max(),
                "broken": int((group["off"] == math.inf).sum()),
                "slide": usual["slide"],
                "literal": WAYS[str(engine)][str(way)].literal(SHOWN),
            }
        )
    return pd.DataFrame(table)


def finding(tables: Tables) -> str:
    """Say how many engines miss a coefficient that is set plainly, and how well all keep it."""
    corners = tables["corners"]
    plain, best = corners.drop_duplicates("engine"), best_of(corners)
    slides = best["slide"] > SLIDES
    within = f"within {best.loc[~slides, 'off_over_all'].max():.2g}"
    sliding = [ENGINES[name].title for name in best.loc[slides, "engine"]]
    if len(plain) == 1:
        title = ENGINES[plain["engine"].iloc[0]].title
        if sliding:
            return f"In {title} the striking corner slides with all settings that were tried."
        return f"{title} keeps a coefficient of restitution {within} with its best settings."
    missed = out_of((plain["off"] > 0.5).sum(), len(plain))
    return (
        f"With the plainest settings {missed} engines miss a coefficient of restitution; with the "
        f"best ones {out_of((~slides).sum(), len(best))} keep it {within}"
        f"{f', and in {listed(sliding)} the corner slides' if sliding else ''}."
    )


def best_of(corners: pd.DataFrame) -> pd.DataFrame:
    """Return the line of each engine's best way."""
    ranked = corners.assign(slid=corners["slide"] > SLIDES).sort_values(
        ["slid", "off_over_all", "off"], kind="stable"
    )
    return ranked.drop_duplicates("engine").drop(columns="slid").sort_index()


def shown(tables: Tables) -> Tables:
    """Return the deviations of each way, and what it sets."""
    corners = tables["corners"]
    return {
        "Largest difference of the corner's speed, after over before, from the coefficient; its "
        "speed along the base; strikes that broke": corners.drop(columns="literal"),
        f"What is set for {SHOWN:g}; DT is the step [s]": corners[["engine", "way", "literal"]],
        "Without a coefficient": pd.DataFrame(list(WITHOUT.items()), columns=["engine", "instead"]),
    }


def figures(tables: Tables) -> Figures:
    """Draw the strikes of each engine's plainest and best way."""
    from studies.drawing.figures import draw_strikes

    corners = tables["corners"]
    plain, best = corners.drop_duplicates("engine"), best_of(corners)
    return {"strikes": draw_strikes(tables["restitution"], plain, best)}


STUDY = Study(
    name="restitution",
    question="Which settings give the coefficient of restitution that is set?",
    help="""The coefficient of restitution of one impact: a corner's speed after over before.

Coefficients from 0 to 1 are set; the place of the impact within a step varies, and so do step,
rate, height and slenderness. A column gives the share of its angular rate that the block keeps.
Takes half a minute. Writes restitution.csv, corners.csv, findings.txt and a picture.""",
    options=Options,
    texts=("way", "varied", "literal"),
    captions={
        "strikes": "Restitution of the striking corner against the coefficient that is set, with "
        "each engine's plainest and best settings. Bands: the range over all variations.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
