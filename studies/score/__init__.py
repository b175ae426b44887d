"""One engine: what it predicts, at what price, where it fails, and what moved since a release."""

from __future__ import annotations

import functools
import math
import platform
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import packages_distributions
from json import dumps, loads
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic.response import Outcome
from analytic.text import finite_number
from engines import ENGINES
from engines.declaration import AT_REST, Engine
from engines.registry import OWN, UnloadableError, named
from engines.settings import perhaps
from studies import precision, scenes, stability, sweep
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.arguments import Out, Place
from studies.kit.foreign import apart
from studies.kit.identity import version_of
from studies.kit.jobs import Job, Question, Row, answer
from studies.kit.options import Running
from studies.kit.say import in_columns, one_line, out_of, part
from studies.kit.store import check, project_version
from studies.kit.study import Study, Tables
from studies.kit.tables import read_table, write_text
from studies.measures.differences import summarize, with_reference
from studies.measures.finer import cheapest_below, joint
from studies.measures.presets import preset_of
from studies.measures.published import LADDER, PUBLISHED, TARGETS
from studies.measures.verdicts import Verdict
from studies.score import probes
from studies.sources.registry import announce, presets_of, resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SWEEP, STEPS, EXTREMES, MOMENTS, SCENES = (
    f"score-{name}" for name in ("sweep", "steps", "extremes", "moments", "scenes")
)
FURTHER = {"score-frame": "frame", "score-slide": "slide"}
"""Table -> its scene."""
SCHEMA = 1
"""Version of the form that `result_of` gives a result."""
NOISE = 1e-6
"""Relative change of a peak up to which two results are the same."""
CASE = ["figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p"]
"""Columns that make the name of one of the paper's cases."""
LEAST = {"agree": "outcomes", "extreme": "extreme"}
MOST = {"median_error": "median", "p90_error": "p90", "max_error": "max", "no_answer": "failed"}
"""Column of a table -> what may be required of it, at least or at most."""
MEASURES = (*LEAST.values(), *MOST.values())


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the jobs of the tables; of an engine without a preset those of all that it has."""
    uses = list[str]()
    for name in sources:
        all_of_it = [f"{name}:{preset}" for preset in presets_of(resolve(name))]
        uses += [name] if ":" in name else all_of_it
    swept = sweep.jobs(uses, quick, sweep.Options(figure=(6, 8) if quick else (6, 7, 8, 9)))
    if quick:  # every 11th case of a figure: that divides no panel's 40
        swept = [job for number, job in enumerate(swept) if number // len(uses) % 11 == 0]
    varied = [use for use in uses if preset_of(use) != AT_REST]
    along = [job for job in precision.jobs(varied, quick) if job.labels["table"] == precision.ALONG]
    flight = Question(system=probes.BLOCK, motion=probes.UNFELT)
    tables = {
        SWEEP: swept,
        STEPS: along,
        EXTREMES: stability.matrix_jobs(uses, quick),
        MOMENTS: [Job(labels={}, case=flight, source=use) for use in uses],
        SCENES: [job for job in scenes.jobs(uses, quick) if is_usual(job.labels)],
    }
    return [
        replace(job, labels={"part": name, **job.labels})
        for name, of_table in tables.items()
        for job in of_table
    ]


def is_usual(labels: Mapping[str, Any]) -> bool:
    """Say whether a scene is a slide, or a usual frame in an engine's own steps."""
    usual = not labels.get("extreme") and labels.get("refined", 1.0) == 1.0
    return usual and labels["scene"] in FURTHER.values()


def measure(job: Job) -> Row:
    """Return what a job's table has of it."""
    of = {SWEEP: answer, STEPS: precision.measure, EXTREMES: stability.measure}
    of |= {MOMENTS: probes.measure_moment, SCENES: scenes.measure}
    return of[job.labels["part"]](job)


KNOWN = {
    SWEEP: ("peak_ratio",),
    STEPS: ("peak_ratio", "error", "impact_error", "energy_drift"),
    EXTREMES: ("peak_ratio", "error", "energy_growth", "slip_widths"),
    MOMENTS: tuple(probes.UNKNOWN),
}
"""Columns that a table has though none of its numbers may be known."""


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows of each table, without the columns of others."""
    found: dict[str, pd.DataFrame] = {}
    for name, known in KNOWN.items():
        mine = rows[rows["part"] == name].drop(columns=["part", "table"], errors="ignore")
        found[name] = mine[[it for it in mine if it in known or mine[it].notna().any()]]
    tables = scenes.tabulate(rows[rows["part"] == SCENES].reindex(columns=[*{*rows, "scene"}]))
    for name, scene in FURTHER.items():
        if len(held := scenes.built(tables[scene])):
            found[name] = held
    whole = {"figure", "aspect", "runs", "impacts", "steps"}
    return {
        name: table.astype(dict.fromkeys(whole.intersection(table), int))
        for name, table in found.items()
    }


def swept(tables: Tables) -> pd.DataFrame:
    """Return the lines of all figures together, one for each preset."""
    return summarize(with_reference(tables[SWEEP]).assign(figure="all"))


def published() -> pd.DataFrame:
    """Return the published errors and times of methods; FolderError if they were edited."""
    check(PUBLISHED, [LADDER], "the published folder")
    return read_table(PUBLISHED / LADDER)


def finding(tables: Tables) -> str:
    """Say what is wrong with its world, or else what its best preset predicts."""
    moments = tables[MOMENTS]
    if wrong := probes.wrong_moment(moments) or probes.wrong_quantity(moments):
        return wrong
    lines = swept(tables).sort_values("max_error", ascending=False, kind="stable")
    best = lines.sort_values("agree", kind="stable").iloc[-1]
    return (
        f"{best['source']} predicts {out_of(best['agree'], best['cases'])} outcomes, and every "
        f"peak within {part(best['max_error'])}."
    )


def shown(tables: Tables) -> Mapping[str, pd.DataFrame]:
    """Return its errors beside the published ones, its verdicts, what helps it, its moments."""
    extremes, along = tables[EXTREMES], precision.work_precision(tables[STEPS])
    among = {"this engine": joint(along), "published": joint(precision.engines_of(published()))}
    return {
        "The paper's cases; errors of the peak are relative, over those that survive": (
            swept(tables).drop(columns=["figure", "max_difference"])
        ),
        "Along the step, on typical cases and near overturning together": among["this engine"],
        "The cheapest setting below an error there, and the published one": pd.DataFrame(
            {"below": target, "among": whose, **best}
            for target in TARGETS
            for whose, lines in among.items()
            if (best := cheapest_below(lines, target)) is not None
        ),
        "Verdicts on extreme cases": stability.verdicts(extremes),
        "Failures in extreme cases": stability.failures(extremes)[["case", "source", "reason"]],
        "The moment of a step at which its velocities hold, of which 1 is the end; by what part a "
        "block that is let go turns too far, and with half the step": tables[MOMENTS],
        **{
            f"In the scene of a {scene}": scenes.tabulate(tables[name])[f"{scene}-summary"]
            for name, scene in FURTHER.items()
            if name in tables
        },
    }


def figures(tables: Tables) -> Mapping[str, Figure]:
    """Draw the errors of its presets over their run times, and the matrix of extreme cases."""
    from studies.drawing.precision import draw_score
    from studies.drawing.stability import draw_matrix

    along = precision.work_precision(tables[STEPS])
    return {
        "score": draw_score(along, precision.engines_of(published())),
        "extremes": draw_matrix(tables[EXTREMES], "Extreme cases"),
    }


STUDY = Study(
    name="score",
    question="What does one engine predict, and did it get worse?",
    help="""One engine, by ENGINE or ENGINE:PRESET, MODULE:ENGINE or MODULE:build.

The paper's cases with each of its presets, its errors along the step beside the published engines,
its verdicts on extreme cases, slides and frames, and whether its velocities hold at the `Moment`
that its world declares. With --require or --against, the exit code is 1 where a requirement falls
short, and 0 whatever else failed; it is 1 where the world declares another `Moment` than the one at
which its velocities hold, or where an error that does not shrink with the step tells of a wrong
inertia, size or gravity.""",
    jobs=jobs,
    measure=measure,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    needed=lambda rows: [row for row in rows if row["part"] == SWEEP],
    captions={
        "score": "The engine's presets along their steps, largest error against run time; grey "
        "behind them the published engines.",
        "extremes": "Extreme cases, a column for each preset: the symbol says how its answer is.",
    },
    running=Running(time_limit=stability.LIMIT_S),
)


def command(
    engine: Annotated[str, Parameter(name="ENGINE")],
    /,
    *,
    out: Out = Path("score"),
    quick: bool = False,
    require: Annotated[tuple[str, ...] | None, arguments.several_or_none] = None,
    json: Place | None = None,
    against: Place | None = None,
    running: Running = STUDY.running,
) -> int:
    """Score one engine.

    Parameters
    ----------
    engine
        Its name, perhaps with one of its presets after a colon; or MODULE:ENGINE where its
        declaration stands, or MODULE:build of what builds its world, in this folder or among the
        installed packages.
    quick
        Every 11th case of two figures, every other step, fewer extremes: a minute or two.
    require
        outcomes=N: at least so many right; median=E, p90=E, max=E: largest relative error of the
        peak; failed=N: at most so many without an answer; extreme=N: at least so many extreme cases
        right. Of the best preset, or as in fixed:p90=1e-3.
    json
        File for the result.
    against
        Such a file of an earlier release, or of another environment: what moved since is said.
    """
    name = known(engine)
    declared = scored(name)
    # what cannot be compared with it is refused now, and not after the last run
    requirements = [required(text, declared) for text in require or ()]
    if require is not None:
        asked = [f"{preset}:{what}" for preset, what, _ in requirements]
        arguments.refuse_repeats("--require", asked)
    earlier = against and read(against, declared)
    published()
    if json:
        arguments.check_writable("--json", json)
    if declared.name not in OWN:
        with suppress(UnloadableError):  # its cases will say so
            if problem := apart(probes.problem_of, f"{declared.name}:{declared.best.name}"):
                raise BadInputError(f"ENGINE is {engine!r}: {problem}")
    code = STUDY.carry_out(out, jobs([name], quick), running, engine=name, quick=quick)
    tables = STUDY.read(out)
    result = result_of(tables, declared)
    if json:
        write_text(json, dumps(result, indent=1, ensure_ascii=False) + "\n")
    if earlier:
        print("\n" + since(earlier, result))
    held = [holds(requirement, result) for requirement in requirements]
    print(*(line for _, line in held), sep="\n", end="\n" * bool(held))
    if earlier or held:
        code = int(not all(good for good, _ in held))
    moments = tables[MOMENTS]
    return code or int(bool(probes.wrong_moment(moments) or probes.wrong_quantity(moments)))


def known(engine: str) -> str:
    """Return an engine by its name, with its preset where that is named; make a place's known."""
    if engine.partition(":")[0] in ENGINES:
        with arguments.as_bad_input("ENGINE: "):
            scored(engine)
        return engine
    if ":" not in engine:
        words = f"{', '.join(ENGINES)}, ENGINE:PRESET, MODULE:ENGINE or MODULE:build"
        near = perhaps(engine, list(ENGINES))
        raise BadInputError(f"ENGINE is {engine!r}{near}; it must be one of {words}")
    sys.path.append(str(Path.cwd()))  # not first: what this process imports is found before it
    try:
        return announce(engine, functools.partial(apart, named))
    except ValueError as error:
        raise BadInputError(f"ENGINE: {error}") from error


def scored(source: str) -> Engine:
    """Return an engine, with one of its presets alone where that is named."""
    name, colon, preset = source.partition(":")
    engine = ENGINES[name]
    return replace(engine, presets=(engine.preset(preset),)) if colon else engine


def required(text: str, engine: Engine) -> tuple[str, str, float]:
    """Read [PRESET:]MEASURE=NUMBER: the preset, by default the best, the measure, and its bound."""
    name, _, number = text.partition("=")
    preset, colon, measured = name.rpartition(":")
    presets = [use.name for use in engine.presets]
    bound = math.nan
    with suppress(ValueError):
        bound = finite_number(number)
    if not (measured in MEASURES and preset in (presets if colon else [""]) and bound >= 0.0):
        raise BadInputError(
            f"--require is {text!r}; it must be one of {', '.join(MEASURES)}, then = and a number, "
            f"0 or more; {' or '.join(presets)} and a colon may stand before it"
        )
    return preset or engine.best.name, measured, bound


def holds(requirement: tuple[str, str, float], result: Mapping[str, Any]) -> tuple[bool, str]:
    """Return whether a result holds a requirement, and a line of what was required and found."""
    preset, measured, bound = requirement
    found = result["presets"][preset][measured]
    value, least = math.nan if found is None else found, measured in LEAST.values()
    good = value >= bound if least else value <= bound
    side = f"at {'least' if least else 'most'} {bound:g}, and is {value:.6g}"
    verdict = "holds" if good else "falls short"
    return good, f"{verdict}: {preset}:{measured} must be {side}"


def result_of(tables: Tables, engine: Engine) -> dict[str, Any]:
    """Return the result of tables, as JSON knows it: schema, engine and versions by package.

    presets: for each its `MEASURES`, an error being None where no peak survives, and how many cases
    and extremes these are of. peaks: for each preset and case that of a block which rocked, over
    its critical rotation, or the outcome of another; a case is called by its `CASE` with slashes
    between, or extreme/NAME. moments: for each preset the declared and the measured one, in steps.
    """
    cases, extremes, moments = (tables[name] for name in (SWEEP, EXTREMES, MOMENTS))
    names = ["/".join(map(str, case)) for case in cases[CASE].itertuples(index=False)]
    rows = pd.concat(
        [cases.assign(case=names), extremes.assign(case="extreme/" + extremes["case"])]
    )
    rocked = (rows["outcome"] == Outcome.ROCKED.value) & np.isfinite(rows["peak_ratio"])
    rows["peak"] = rows["peak_ratio"].astype(object).where(rocked, rows["outcome"])
    valid = extremes[extremes["verdict"] != Verdict.INVALID.value]
    good = (valid["verdict"] == Verdict.GOOD.value).groupby(valid["source"])
    lines = swept(tables).set_index("source").join(good.agg(extreme="sum", extremes="count"))
    lines = lines.rename(columns=LEAST | MOST)
    packages = engine.packages or packages_distributions().get(engine.library, ())
    versions = {"rocking": project_version(), "python": platform.python_version()}
    return {
        "schema": SCHEMA,
        "engine": engine.name,
        "versions": versions | {name: version_of(name) for name in packages},
        "presets": by_preset(lines[["cases", "extremes", *MEASURES]]),
        "peaks": {
            preset_of(str(source)): dict(zip(group["case"], group["peak"], strict=True))
            for source, group in rows.groupby("source", sort=False)
        },
        "moments": by_preset(moments.set_index("source")[["declared", "measured"]]),
    }


def by_preset(table: pd.DataFrame) -> dict[Any, dict[Any, Any]]:
    """Return the lines of a table of sources by their presets, None where a number is missing."""
    numbers = table.rename(index=preset_of).astype(object)
    return numbers.where(numbers.notna(), None).to_dict("index")


def read(path: Path, engine: Engine) -> dict[str, Any]:
    """Read an engine's result back as --json wrote it; BadInputError if it is none."""
    try:
        if not path.is_file():  # a pipe would be waited for
            raise OSError("it is no file")
        found = loads(path.read_text(encoding="utf-8"))
        if found["schema"] != SCHEMA or found["engine"] != engine.name:
            raise ValueError(f"its schema is {found['schema']}, its engine {found['engine']}")
        parts = (*found["peaks"].values(), found["versions"])
        values = [value for part in parts for value in part.values()]
        if not all(isinstance(value, float | str) for value in values):
            raise ValueError("it holds something else")
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise BadInputError(
            f"--against is {str(path)!r}; it must be what --json wrote of {engine.name} by schema "
            f"{SCHEMA} ({one_line(error)})"
        ) from error
    return dict(found)


def since(then: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Say what moved between two results, of the answers that are in both.

    Below the sentence a table of other outcomes, and one of the peaks that moved by more than
    NOISE, the most first, where there are any.
    """
    answers = [pd.DataFrame(result["peaks"]).unstack().dropna() for result in (then, now)]
    both = pd.concat(answers, axis=1, join="inner", keys=["then", "now"])
    table = both.rename_axis(["preset", "case"]).reset_index()
    before, after = (pd.to_numeric(table[name], errors="coerce") for name in ("then", "now"))
    table["change"] = after / before - 1.0
    other = table[table["change"].isna() & (table["then"] != table["now"])]
    moved = table[table["change"].abs() > NOISE].sort_values("change", key=abs, ascending=False)
    versions = ", ".join(f"{name} {version}" for name, version in then["versions"].items())
    said = (
        f"Since {versions}, {len(other)} of {len(table)} answers have another outcome, and "
        f"{len(moved)} peaks moved by more than {NOISE:g} of themselves."
    )
    parts = [other.drop(columns="change"), moved]
    return "\n\n".join([said, *(in_columns(part) for part in parts if len(part))])
