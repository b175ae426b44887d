"""Printed numbers against the models and the engines: who printed what, and does it come out?"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from studies.drawing.kept import tell
from studies.kit.arguments import Out
from studies.kit.jobs import Job
from studies.kit.naming import EngineSources
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import write_table
from studies.literature import STUDY
from studies.literature.peers import PEERS, peers, put, read_off
from studies.literature.prints import PROBLEMS
from studies.literature.problems import Drop, ModeEnd, OrbitLimit, Problem, Restitution
from studies.literature.readings import NAMED, times_of
from studies.measures.words import out_of
from studies.sources.registry import core_sources, resolve

DEFAULT_SOURCES = core_sources()
AFTER_A_RELEASE = 3.0
"""Time, in units of 1/p, in which a released block strikes its base, and is seen to rise again."""


def command(
    *,
    out: Out,
    sources: EngineSources = DEFAULT_SOURCES,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Hold printed numbers against the models that they are about, and the engines beside.

    Parameters
    ----------
    sources
        Engines, beside the printed model and the exact one.
    """
    jobs = [
        literature_job(problem, source)
        for problem in PROBLEMS
        for source in dict.fromkeys((problem.model, "exact", *sources))
        if can_answer(problem, source)
    ]
    engines = {resolve(source).engine for source in sources}
    jobs += [job for test in PEERS for job in test.jobs(engines)]
    asked = tuple(dict.fromkeys(job.source for job in jobs))
    plan = Plan(jobs=jobs, growing={"source": asked}, ask=put, reduce=read_off)
    return carry_out(STUDY, plan, out, running, report)


def can_answer(problem: Problem, source: str) -> bool:
    """Tell whether a source can be asked for a problem's quantity."""
    kind = resolve(source).kind
    if isinstance(problem, ModeEnd):
        return kind == "model"
    if isinstance(problem, OrbitLimit | Drop) and kind != "engine":
        return source == problem.model
    if isinstance(problem, OrbitLimit):
        return False
    return kind != "engine" or problem.ideal


def literature_job(problem: Problem, source: str) -> Job:
    """Return the job that puts a problem to a source."""
    options: dict[str, object] = {"start": problem.start} if problem.start != (0.0, 0.0) else {}
    if problem.friction is not None and resolve(source).kind == "engine":
        options["friction"] = problem.friction
    return Job(
        labels={"problem": problem.name, "model": problem.model},
        block=problem.block,
        motion=problem.pulse,
        source=source,
        duration=_observed(problem),
        times=times_of(problem),
        options=options,
    )


def _observed(problem: Problem) -> float | None:
    """Return until when [s] a source is watched; None where its peak and outcome are enough."""
    if isinstance(problem, Drop | Restitution):
        return AFTER_A_RELEASE / problem.block.p
    return problem.pulse.duration if times_of(problem) is not None else None


def report(folder: Path) -> str:
    """Reduce and draw a folder's literature.csv; write and return the text."""
    rows = STUDY.read(folder, "literature")
    tests = rows["problem"].isin([test.name for test in PEERS])
    table, tested = agreement(rows[~tests]), peers(rows[tests])
    write_table(folder / "agreement.csv", table)
    write_table(folder / "peers.csv", tested)
    shown = {
        "Printed numbers, and the answers": answers(table),
        "Who printed them": table[["work"]].drop_duplicates(),
        "Tests by engines' authors: what passes, exact numbers, and engines here": in_digits(
            tested
        ),
        "What else passes, and where they stand": tested[
            ["test", "says", "work"]
        ].drop_duplicates(),
    }
    return tell(STUDY, folder, shown)


def finding(table: pd.DataFrame) -> str:
    """Say how many printed numbers come out to their digits, by the models that they are about."""
    mine = table[(table["source"] == table["model"]) & (table["of"] == "theory")]
    right = int((mine["agrees"] == "True").sum())
    return f"Of the printed numbers of the literature {out_of(right, len(mine))} come out."


def agreement(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each printed number and source: the print, the answer, its miss."""
    lines: list[dict[str, Any]] = []
    for row in rows.to_dict("records"):
        problem = NAMED[str(row["problem"])]
        for side, printed in enumerate(problem.printed):
            value, (low, high) = float(row[("value", "other_side")[side]]), printed.bounds
            lines.append(
                {
                    **{"problem": problem.name, "side": side},
                    **{name: getattr(problem, name) for name in ("work", "where", "quantity")},
                    "printed": str(printed),
                    "measured": problem.measured[side] if problem.measured else "",
                    "model": problem.model,
                    "of": "test" if isinstance(problem, Restitution) else "theory",
                    **{"source": row["source"], "outcome": row["outcome"], "value": value},
                    **{"low": low, "high": high, "miss": printed.miss(value)},
                    "agrees": str(bool(low <= value <= high)),
                    **{"why": problem.why, "message": row["message"]},
                }
            )
    table = pd.DataFrame(lines)
    exact = table[table["source"] == "exact"].set_index(["problem", "side"])["value"]
    places = pd.MultiIndex.from_frame(table[["problem", "side"]])
    return table.assign(from_exact=table["value"] / exact.reindex(places).to_numpy() - 1.0)


def answers(table: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each printed number: what its model makes of it, and all answers."""
    place = ["problem", "side"]
    mine = table[table["source"] == table["model"]].set_index(place)
    values = table.pivot(index=place, columns="source", values="value")[table["source"].unique()]
    shown = in_digits(values)
    why = mine["why"].where(mine["agrees"] != "True", "")
    words = mine[["quantity", "printed", "measured", "agrees", "miss"]]
    return words.join(shown).assign(why=why).reset_index("problem")


def in_digits(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with its numbers in six digits, as far as it is no words."""
    numbers = table.select_dtypes("number").map("{:.6g}".format).replace("nan", "")
    return table.drop(columns=["says", "work"], errors="ignore").assign(**numbers)
