"""Contact models: what one setting at a time costs and buys, from the best and the defaults."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import islice
from typing import Annotated, Any, cast

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic import conditioning
from analytic.frame import Rocker, RockingFrame
from analytic.response import Outcome
from engines import ENGINES, core_engines, factors
from engines.declaration import AT_REST, PASTED, Stepping
from engines.scene import Scene, free_rocking_window
from studies.cases.drawn import Drawn, RandomCase, draw
from studies.cases.paper import Case, chosen_cases
from studies.cases.refusal import BadInputError
from studies.kit.arguments import Engines, one_of
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import out_of, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.differences import WELL_CONDITIONED, with_reference
from studies.measures.history import SAMPLES, growth
from studies.measures.wrongness import FALL, NO_ANSWER, REST, wrong_in
from studies.sources.registry import resolve

KEY = ["engine", "preset", "factor", "level"]
"""Columns that tell one variant from another."""
FOUND = ["failed", "wrong", "max_error"]
"""What shows a variant's quality: outcomes of all cases, peaks of typical ones."""
STILL = f"{factors.OWN_STEP}, on a base at rest"
"""The defaults at their own step once more, in the other frame."""
AT_ONCE = f"{factors.OWN_STEP}, shaken at once"
"""The same without the rest before the motion."""
SCENES = "block: cases of the paper. frame: random frames, a beam on 2 to 5 columns."


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which engines, and what stands on the base."""

    engines: Engines = core_engines()  # noqa: RUF009
    scene: Annotated[Drawn, one_of(Drawn), Parameter(help=SCENES)] = "block"


def jobs(_: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return the jobs of every variant, at one step of all and then at the library's own."""
    framed = options.scene == "frame"
    if framed and not any(ENGINES[engine].stacks for engine in options.engines):
        words = f"none of --engines is built for it: {', '.join(options.engines)}"
        raise BadInputError(f"--scene is {options.scene!r}; {words}")
    cases: Sequence[tuple[str, Case | RandomCase]]
    cases = (
        frame_cases(quick)
        if framed
        else [
            (kind, case)
            for kind, some in chosen_cases(True).items()
            for case in some
            if not quick or (kind == "typical" and case.aspect in (2, 4))
        ]
    )
    tried = [variant for engine in options.engines for variant in variants(engine)]
    return [
        job_of(variant, kind, case, quick, own_step)
        for own_step in (False, True)
        for variant in tried
        if not own_step
        or (variant.preset == factors.DEFAULT and variant.factor != factors.OWN_STEPS)
        for kind, case in cases
        if not framed or is_built_for(variant, case)
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """One way to set an engine: a preset, which factor differs from it, and how."""

    engine: str
    preset: str
    factor: str = ""  # none of a preset as it is, whose title is the level
    level: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    scene: Mapping[str, Any] = field(default_factory=dict)
    trap: str = ""  # why it goes wrong without a word, where it does

    @property
    def source(self) -> str:
        """The engine's preset."""
        return f"{self.engine}:{self.preset}"


def variants(engine: str) -> Iterator[Variant]:
    """Yield every way to set an engine, each preset as it is before what differs from it."""
    declared = ENGINES[engine]
    plain = {
        use.name: Variant(engine=engine, preset=use.name, level=use.title)
        for use in declared.presets
    }
    for name in [name for name in plain if name not in (*factors.BOTH, AT_REST)]:
        yield plain[name]
        if name == PASTED:
            yield from _less(plain[name])
        for help_, settings in declared.preset(name).helped_by.items():
            if settings is not None:
                level = help_.name.lower()
                yield replace(plain[name], factor=factors.LEFT_OUT, level=level, settings=settings)
    for name in [name for name in factors.BOTH if name in plain]:
        yield plain[name]
        if name == factors.DEFAULT:
            own = replace(plain[name], factor=factors.OWN_STEPS, level=factors.OWN_STEP)
            yield own
            yield replace(own, level=AT_ONCE, scene={"rest_s": 0.0})
            if declared.preset(name).frame == "world":
                yield replace(own, level=STILL, scene={"frame": "base"})
        for factor in declared.factors:
            if set(factors.BOTH) <= plain.keys():
                yield from _exchanged(plain[name], factor)
            yield from _levels(plain[name], factor)


def _less(pasted: Variant) -> Iterator[Variant]:
    """Yield what is pasted without one of its settings; friction is not one of them."""
    declared = ENGINES[pasted.engine]
    mine, default = (asdict(declared.preset(name).settings) for name in (PASTED, factors.DEFAULT))
    apart = [name for name in mine if mine[name] != default[name] and name != "friction"]
    of = {name: factors.Factor(name, (name,)) for name in apart}
    of |= {name: factor for factor in declared.factors for name in factor.settings}
    kin = (tuple(each for each in apart if each in of[name].settings) for name in apart)
    for names in dict.fromkeys(kin):
        setting, trap = {name: default[name] for name in names}, of[names[0]].traps
        left = replace(pasted, factor=factors.LEFT_OUT, level=" and ".join(names).replace("_", " "))
        yield replace(left, settings=setting, trap=trap.get(factors.BEST, ""))


def _levels(plain: Variant, factor: factors.Factor) -> Iterator[Variant]:
    """Yield a preset with each level of a factor that it is tried with."""
    for item in factor.levels:
        if plain.preset in item.presets:
            varied = {each: getattr(item, each) for each in ("settings", "scene", "trap")}
            yield replace(plain, factor=factor.name, level=item.name, **varied)


def _exchanged(plain: Variant, factor: factors.Factor) -> Iterator[Variant]:
    """Yield one of the two presets with the other's values of a factor, where these differ."""
    untuned = plain.preset == factors.DEFAULT
    chosen = [
        ENGINES[plain.engine].preset(name).settings for name in (factors.DEFAULT, factors.BEST)
    ]
    default, best = ({name: getattr(of, name) for name in factor.settings} for of in chosen)
    own, wanted = (default, best) if untuned else (best, default)
    if wanted != own and (untuned or factor.by_default):
        trap = factor.traps.get(plain.preset, "")
        level = factors.AS_BEST if untuned else factors.BY_DEFAULT
        yield replace(plain, factor=factor.name, level=level, settings=wanted, trap=trap)


def frame_cases(quick: bool) -> list[tuple[str, RandomCase]]:
    """Return the first random frames that rock and survive, with a κ below WELL_CONDITIONED."""
    calm = (
        case
        for case in draw(1, "frame")
        if np.abs(conditioning(case.block, case.motion)).max() < WELL_CONDITIONED
    )
    return [("typical", case) for case in islice(calm, 2 if quick else 4)]


def is_built_for(variant: Variant, case: Case | RandomCase) -> bool:
    """Return whether a variant's preset can hold a case: some are for one block alone."""
    asked = resolve(variant.source)
    scene = Scene(system=case.block, motion=case.motion, preset=asked.preset)
    return not asked.declared.use(scene).lacking


def job_of(
    variant: Variant, kind: str, case: Case | RandomCase, quick: bool, own_step: bool
) -> Job:
    """Return the job of a variant and a case, at the library's own step or at that of all."""
    options = {"settings": dict(variant.settings), **variant.scene}
    stepping = ENGINES[variant.engine].preset(variant.preset).stepping
    if stepping is Stepping.FIXED and variant.factor != factors.OWN_STEPS and not own_step:
        options["step"] = 2e-3 if quick else 1e-3
    labels = {name: getattr(variant, name) for name in (*KEY, "trap")}
    labels |= {"own_step": own_step, "set": kind, **asdict(case)}
    window = free_rocking_window(case.block, case.motion)
    times = np.linspace(0.0, window, SAMPLES)
    asked = Question(system=case.block, motion=case.motion, duration=window, times=times)
    return Job(labels=labels, case=asked, source=variant.source, options=options)


def measure(job: Job) -> Row:
    """Return the summary, the velocity ratio and its e, slip, penetration and energy."""
    response, motion = ask(job), job.case.motion
    system = cast(Rocker, job.case.system)
    least = 0.1 * system.p * system.alpha  # slower impacts show no velocity ratio
    strong = [each.ratio for each in response.impacts if abs(each.velocity_before) > least]
    known = strong and response.outcome is not Outcome.FAILED
    ratio = float(np.median(strong[:3])) if known else math.nan
    framed = isinstance(system, RockingFrame)
    return {
        **summary(response),
        "velocity_ratio": ratio,
        "ratio_over_eta": ratio / system.restitution,
        "newton_e": math.nan if framed else newton_e(ratio, system.alpha),
        "slip_widths": response.slip_m / system.width,
        "sink_widths": response.sink_m / system.width,
        "energy_growth": growth(system, motion, response),
    }


def newton_e(ratio: float, alpha: float) -> float:
    """Return the e of the corner that lands: the ratio is 1 - 3/2 (1 + e) sin^2(alpha)."""
    return (1.0 - ratio) / (1.5 * math.sin(alpha) ** 2) - 1.0


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows, a line for each variant, and for each at the library's own step."""
    own = rows["own_step"].astype(bool)
    lines = {"variants": variant_table(rows[~own]), "own-steps": variant_table(rows[own])}
    return {"contact": rows, **lines}


def variant_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each variant: its errors, its impact, its cost."""
    compared = with_reference(rows)
    kinds = wrong_in(compared)
    compared = compared.assign(
        typical=compared["error"].abs().where(compared["set"] == "typical"),
        step_s=compared["wall_s"] / compared["steps"].clip(lower=1),
        failed=kinds == NO_ANSWER,
        wrong=kinds.isin((FALL, REST)),
    )
    groups = compared.groupby(KEY, sort=False)
    table = groups.agg(
        trap=("trap", "first"),
        cases=("outcome", "size"),
        failed=("failed", "sum"),
        wrong=("wrong", "sum"),
        median_error=("typical", "median"),
        max_error=("typical", "max"),
        ratio_over_eta=("ratio_over_eta", "median"),
        newton_e=("newton_e", "median"),
        slip_widths=("slip_widths", "max"),
        sink_widths=("sink_widths", "max"),
        energy_growth=("energy_growth", "max"),
        step_s=("step_s", "median"),
        message=("message", "max"),
    ).reset_index()
    first = table.groupby(["engine", "preset"])["wrong"].transform("first")
    return table.assign(worse=(table["failed"] > 0) | (table["wrong"] > first))


def left_at_default(lines: pd.DataFrame) -> pd.DataFrame:
    """Return each tuned setting alone at its default, first for each engine what costs most."""
    best = lines[lines["preset"] == factors.BEST]
    tuned = best[best["factor"] == ""].set_index("engine")["max_error"]
    left = best[best["level"] == factors.BY_DEFAULT]
    place, as_tuned = left.groupby("engine", sort=False).ngroup(), left["engine"].map(tuned)
    order, rising = ["place", "worse", "failed", "max_error"], [True, False, False, False]
    left = left.assign(place=place, as_tuned=as_tuned).sort_values(order, ascending=rising)
    return left[["engine", "factor", *FOUND, "as_tuned", "worse"]].reset_index(drop=True)


def finding(tables: Tables) -> str:
    """Say which engine errs most with one tuned setting at its default, and how many break."""
    left = left_at_default(tables["variants"])
    raised = left[left["max_error"] > 1.1 * left["as_tuned"]]
    if raised.empty:
        return "No error grows when a single tuned setting is left at the library's default."
    worst, engines = raised.nlargest(1, "max_error").iloc[0], left["engine"].nunique()
    worse = left.loc[left["worse"], "engine"].nunique()
    others = f"; in {out_of(worse, engines)} engines one such setting adds wrong outcomes"
    return (
        f"With only its {worst['factor']} left at the library's default, "
        f"{ENGINES[worst['engine']].title} misses peaks by up to {part(worst['max_error'])}"
        f"{others if engines > 1 else ''}."
    )


def shown(tables: Tables) -> Tables:
    """Return what each tuned setting costs at its default, the presets, and the traps."""
    lines = tables["variants"]
    plain = lines["factor"] == ""
    own = lines[lines["factor"] == factors.OWN_STEPS]
    pasted = lines[lines["preset"] == PASTED]
    pasted = pasted.assign(left_out=pasted["level"].mask(pasted["factor"] == "", "nothing"))
    measured = ["median_error", "ratio_over_eta", "newton_e"]
    measured += ["slip_widths", "sink_widths", "step_s"]
    traps = lines[(lines["trap"] != "") & ~plain]
    return {
        "Each tuned setting at its default, where all others are tuned": left_at_default(lines),
        "Presets as they are": lines.loc[plain, ["engine", "preset", "cases", *FOUND, *measured]],
        "What is pasted, without one setting": pasted[["engine", "left_out", *FOUND]],
        "Defaults at their own step": own[["engine", "level", *FOUND]],
        "Traps": traps[[*KEY, *FOUND, "trap"]],
    }


def figures(tables: Tables) -> Figures:
    """Draw what the settings that matter most are worth, where an engine has a tuned contact."""
    from studies.drawing.rows import draw_contact

    left = left_at_default(tables["variants"])
    return {"contact": draw_contact(left)} if len(left) else {}


STUDY = Study(
    name="contact",
    question="How much does each contact setting change errors and run time?",
    help="""One contact setting of an engine at a time: solver, geometry, friction, damping, ...

Each setting is changed from its tuned and from its default value, at one p dt; changes of defaults
are also run at the library's own step. The cases are the paper's, or frames of several bodies. A
failed variant is a result: the exit code is 1 only if a whole preset fails. Writes contact.csv,
variants.csv, own-steps.csv, findings.txt and contact.png.""",
    options=Options,
    quick="Fewer cases and twice the step: less than a minute on 2 cores.",
    needed=lambda rows: [row for row in rows if not row["factor"] and not row["own_step"]],
    texts=("factor", "level", "trap"),
    captions={
        "contact": "Largest error of typical peaks with the tuned contact of each engine, and with "
        "one setting left at the library's default: the three settings that matter most.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
