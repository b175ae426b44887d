"""One engine: what it predicts, at what price, where it fails, and what moved since a release."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import pandas as pd
from cyclopts import Parameter

from analytic.motion import Still
from engines import ENGINES
from engines.declaration import AT_REST
from engines.settings import perhaps
from studies import precision, scenes, stability, sweep
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.jobs import Job, Question, Row, answer, unanswered
from studies.kit.run import makers_of, place_of, run
from studies.kit.say import duration, in_columns, one_line, out_of, part, say
from studies.kit.store import FolderError, Store, check, engines_of, provenance_of
from studies.kit.study import Figures, Study, Tables, stages
from studies.kit.tables import table_in
from studies.measures import costs, differences, published, world
from studies.measures.presets import engine_of, preset_of
from studies.sources.registry import announce, presets_of, resolve

MODEL, SWEEP, STEPS, EXTREMES = "score-model", "score-sweep", "score-steps", "score-extremes"
WRONG = "wrong"
FURTHER = {"score-frame": "frame", "score-slide": "slide"}
"""Table -> its scene."""
LEAST_ERROR, ORDER = 1e-3, 0.4
"""An error below the first is small; one of a step shrinks at least as that to this power."""
NOISE = 1e-6
"""Relative change of a peak up to which two results are the same."""
CASE = ["figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p"]
"""Columns that make the name of one of the paper's cases."""


def uses_of(name: str) -> list[str]:
    """Return a source that names a preset, or all presets of an engine as sources."""
    return [name] if ":" in name else [f"{name}:{preset}" for preset in presets_of(resolve(name))]


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the jobs of the tables; of an engine without a preset those of all that it has."""
    uses = [use for name in sources for use in uses_of(name)]
    swept = sweep.jobs(uses, quick, sweep.Options(figure=(6, 8) if quick else (6, 7, 8, 9)))
    if quick:  # every 11th case of a figure: that divides no panel's 40
        swept = [job for number, job in enumerate(swept) if number // len(uses) % 11 == 0]
    varied = [use for use in uses if preset_of(use) != AT_REST]
    along = [job for job in precision.jobs(varied, quick) if job.labels["table"] == precision.ALONG]
    looked_at = dict.fromkeys([*uses, *(world.checked(engine_of(name)) for name in sources)])
    one = Question(system=world.BLOCK, motion=Still())
    tables = {
        MODEL: [Job(labels={}, case=one, source=use) for use in looked_at],
        SWEEP: swept,
        STEPS: along,
        EXTREMES: stability.jobs(uses, quick),
    }
    further = scenes.jobs(uses, quick)
    for name, scene in FURTHER.items():
        tables[name] = [job for job in further if job.labels["scene"] == scene]
    return [
        replace(job, labels={"part": name, **job.labels})
        for name, of_table in tables.items()
        for job in of_table
    ]


def measure(job: Job) -> Row:
    """Return what a job's table has of it."""
    of = {MODEL: look, SWEEP: answer, STEPS: precision.measure, EXTREMES: stability.measure}
    return of.get(job.labels["part"], scenes.measure)(job)


def look(job: Job) -> Row:
    """Return what a world shows of one block, and whether no case of it can be right."""
    lines, problem = list[world.Line](), "" if job.lost is None else job.lost.message
    try:
        lines = [] if problem else world.check(job.asked)
    except Exception as error:
        problem = one_line(error)
    wrong = [line for line in lines if line.wrong]
    row = unanswered(problem or "; ".join(line.wrong for line in wrong))
    row["outcome"] = row["outcome"] if row["message"] else "right"
    row["refused"] = bool(problem) or any(line.refused for line in wrong)
    return {**row, "lines": [[*line[:4], WRONG if line.wrong else "right"] for line in lines]}


def model(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the model check, of all that was looked at."""
    found = rows[["source", "lines"]].explode("lines").dropna()
    columns = [*world.Line._fields[:4], "verdict"]
    lines = pd.DataFrame(found["lines"].tolist(), columns=columns)
    return lines.assign(source=found["source"].to_numpy())


def tabulate(rows: Tables) -> Tables:
    """Return the rows of each table: of a scene those of what an engine is built for."""
    tables = {}
    for name, table in rows.items():
        held = scenes.built(table) if name in FURTHER else table
        if len(held):
            tables[name] = held.drop(columns=["part", "table"], errors="ignore")
    return tables | {MODEL: model(rows[MODEL])}


def swept(tables: Tables) -> pd.DataFrame:
    """Return the lines of all figures together, one for each preset."""
    return differences.summarize(differences.with_reference(tables[SWEEP]).assign(figure="all"))


def along_step(tables: Tables) -> dict[str, pd.Series[float]]:
    """Return the median errors of each preset in typical cases over the step, the longest first."""
    rows = tables[STEPS]
    rows = rows[rows["set"] == precision.TYPICAL].sort_values("value", ascending=False)
    errors = rows.groupby(["source", "value"], sort=False)["error"].median()
    return {str(source): errors[source] for source in rows["source"].unique()}


def no_matter_of_the_step(errors: pd.Series[float]) -> bool:
    """Return whether an error is large and a shorter step leaves more of it than a step may."""
    if len(errors) < 2 or errors.iloc[-1] < LEAST_ERROR:
        return False
    return bool(errors.iloc[-1] / errors.iloc[-2] > (errors.index[-1] / errors.index[-2]) ** ORDER)


def finding(tables: Tables) -> str:
    """Say what of its model is wrong, what its best preset predicts, which error is no step's."""
    lines = swept(tables).sort_values("max_error", ascending=False, kind="stable")
    best = lines.sort_values("agree", kind="stable").iloc[-1]
    said = [
        f"{best['source']} predicts {out_of(best['agree'], best['cases'])} outcomes, and every "
        f"peak within {part(best['max_error'])}."
    ]
    off = tables[MODEL][tables[MODEL]["verdict"] == WRONG].drop_duplicates("quantity")
    if len(off):
        words = off["quantity"] + off["found"].map(" is {:.4g}".format)
        words += off["expected"].map(" and must be {:.4g}".format)
        said.insert(0, f"Model check: {'; '.join(words)}.")
    said += [
        f"The error of {source} does not shrink with the step "
        f"({', '.join(map(part, errors[-2:]))}): a quantity is wrong, not the step."
        for source, errors in along_step(tables).items()
        if no_matter_of_the_step(errors)
    ]
    return "\n\n".join(said)


def summary(tables: Tables) -> pd.DataFrame:
    """Return ten lines about each preset."""
    along, found = along_step(tables), {}
    for line in swept(tables).to_dict("records"):
        source = str(line["source"])
        right = partial(right_of, tables, source)
        found[source] = {
            "outcomes right": out_of(line["agree"], line["cases"]),
            "runs without a result": str(line["no_answer"]),
            "median error of the peak": part(line["median_error"]),
            "nine tenths of the errors are below": part(line["p90_error"]),
            "largest error": part(line["max_error"]),
            "run time of a case": duration(line["wall_s"] / line["cases"]),
            "median errors, long to short steps": ", ".join(map(part, along.get(source, []))),
            "extreme cases right": right(EXTREMES, "verdict", stability.Verdict.GOOD.value),
            "slides right": right("score-slide", "verdict", "right"),
            "frames right": right("score-frame", "right", True),
        }
    return pd.DataFrame(found).rename_axis("what").reset_index()


def right_of(tables: Tables, source: str, name: str, column: str, good: object) -> str:
    """Return how many of a preset's rows of a table are right, of those that count."""
    if name not in tables:
        return "-"
    mine = tables[name]
    mine = mine[(mine["source"] == source) & (mine[column] != stability.Verdict.INVALID.value)]
    return out_of((mine[column] == good).sum(), len(mine)) if len(mine) else "-"


def shown(tables: Tables) -> Tables:
    """Return ten lines about it; then its model, its errors, its verdicts and failures."""
    extremes, along = tables[EXTREMES], precision.work_precision(tables[STEPS])
    return {
        "Summary": summary(tables),
        "The model check": tables[MODEL],
        "The paper's cases; errors of the peak are relative, over those that survive": (
            swept(tables).drop(columns=["figure", "max_difference"])
        ),
        "Along the step, on typical cases and near overturning together": costs.joint(along),
        "Verdicts on extreme cases": stability.verdicts(extremes),
        "Failures in extreme cases": stability.failures(extremes)[stability.FAILURE],
        **{
            f"In the scene of a {scene}": scenes.summed(tables[name], scene)
            for name, scene in FURTHER.items()
            if name in tables
        },
    }


def figures(tables: Tables) -> Figures:
    """Draw the errors of its presets over their run times, and their scores in extreme cases."""
    from studies.drawing.precision import draw_precision
    from studies.drawing.rows import draw_scores

    along = precision.work_precision(tables[STEPS])
    asked = (stability.scores(tables[EXTREMES], each) for each in ("engine", "case"))
    drawn = {"extremes": draw_scores("Extreme cases", *asked)}
    if (along["wall_s"] > 0.0).any():
        others = table_in(published.PUBLISHED / "precision", "work-precision")
        drawn["score"] = draw_precision(along, others)
    return drawn


STUDY = Study(
    name="score",
    question="What does one engine predict, and did it get worse?",
    help="The paper's cases, errors along the step, extreme cases, slides and frames.",
    needed=lambda rows: [row for row in rows if row["part"] in (MODEL, SWEEP)],
    split="part",
    **stages(jobs, measure, tabulate, finding, shown, figures),
)


def command(
    engine: Annotated[str, Parameter(name="ENGINE")],
    /,
    *,
    out: arguments.Out = Path("score"),
    quick: bool = False,
    against: arguments.Place | None = None,
    running: arguments.Running = arguments.Running(),  # noqa: B008
) -> int:
    """Score one engine: the paper's cases, errors along the step, extreme cases, slides and frames.

    It begins with a model check of ten quantities of one block. A world that fails, has a wrong
    sign, or declares another `Moment` than the one at which its velocities hold, is refused; any
    other wrong quantity makes the exit code 1. Writes tables, findings.txt and score.html. With
    --against the exit code is always 0.

    Parameters
    ----------
    engine
        NAME or NAME:PRESET of a known engine; or MODULE:ENGINE of a declaration, or MODULE:build of
        a function or class that builds a world, in this folder or an installed package.
    quick
        Every 11th case of two figures, every other step, fewer extreme cases: a minute or two.
    against
        Folder of the same engine's results with an earlier release or in another environment; what
        has changed since is printed.
    """
    name = known(engine)
    # what cannot be compared with it is refused now, and not after the last run
    earlier = None if against is None else read(against, engine_of(name))
    asked = jobs([name], quick)
    if out.is_dir():  # one of another engine is refused at once
        with Store(out, STUDY.name) as store:
            store.kept({job.key: job for job in asked}, makers_of(asked, measure))
    check_model(engine, [job for job in asked if job.labels["part"] == MODEL], running)
    code = STUDY.carry_out(out, asked, running, engine=name, quick=quick)
    STUDY.hand_on(out, "score.html.jinja")
    if earlier is None:
        return code
    versions, then = earlier
    print(f"\nSince {versions}, {since(then, STUDY.read(out))}")
    return 0


def check_model(engine: str, asked: Sequence[Job], running: arguments.Running) -> None:
    """Print the model check to stderr; refuse an engine of which no case can be right."""
    rows = run(asked, measure, place_of(running, at_once=True))
    for row in rows:
        if row["refused"]:
            raise BadInputError(f"ENGINE is {engine!r}: {row['message']} ({row['source']})")
    lines = model(pd.DataFrame(rows))
    whole = lines[lines["source"] == world.checked(engine_of(asked[0].source))]
    say(f"model check:\n{in_columns(whole)}")


def known(engine: str) -> str:
    """Return an engine by its name, with its preset where that is named; make a place's known."""
    name, colon, preset = engine.partition(":")
    if name in ENGINES:
        with arguments.as_bad_input("ENGINE: "):
            ENGINES[name].preset(preset if colon else None)
        return engine
    if not colon:
        words = f"{', '.join(ENGINES)}, ENGINE:PRESET, MODULE:ENGINE or MODULE:build"
        near = perhaps(engine, list(ENGINES))
        raise BadInputError(f"ENGINE is {engine!r}{near}; it must be one of {words}")
    sys.path.append(str(Path.cwd()))  # not first: what this process imports is found before it
    try:
        return announce(engine)
    except ValueError as error:
        raise BadInputError(f"ENGINE: {error}") from error


def read(folder: Path, engine: str) -> tuple[str, Tables]:
    """Read an engine's earlier results, and with which versions they were made."""
    check(folder, [f"{SWEEP}.csv", f"{EXTREMES}.csv"], "--against")
    tables, record = STUDY.read(folder), provenance_of(folder)
    held = [engine_of(name) for name in tables.get(SWEEP, pd.DataFrame({"source": []}))["source"]]
    if set(held) != {engine} or EXTREMES not in tables:
        raise FolderError(folder, f"it must hold what scoring {engine} wrote", "--against")
    known = {"rocking": record["version"], **engines_of(record)}
    packages = ("rocking", *ENGINES[engine].packages)
    return ", ".join(f"{name} {known[name]}" for name in packages if name in known), tables


def answers(tables: Tables) -> pd.DataFrame:
    """Return the outcome and the peak of each source and case."""
    cases = tables[SWEEP]
    cases = cases.assign(case=cases[CASE].astype(str).agg("/".join, axis=1))
    both = pd.concat([cases, tables[EXTREMES]])
    return both[["source", "case", "outcome", "peak_ratio"]]


def since(then: Tables, now: Tables) -> str:
    """Say what moved between two results, of the answers in both; below, which did."""
    ends = ("_then", "_now")
    table = answers(then).merge(answers(now), on=["source", "case"], suffixes=ends)
    table["change"] = table["peak_ratio_now"] / table["peak_ratio_then"] - 1.0
    same = table["outcome_then"] == table["outcome_now"]
    moved = table[same & (table["change"].abs() > NOISE)]
    moved = moved.sort_values("change", key=abs, ascending=False)
    said = (
        f"{(~same).sum()} of {len(table)} answers have another outcome, and {len(moved)} peaks "
        f"moved by more than {NOISE:g} of themselves."
    )
    parts = [
        table.loc[~same, ["source", "case", "outcome_then", "outcome_now"]],
        moved[["source", "case", "peak_ratio_then", "peak_ratio_now", "change"]],
    ]
    return "\n\n".join([said, *(in_columns(part) for part in parts if len(part))])
