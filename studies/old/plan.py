"""What a study makes, and the one way it is made: jobs in; a folder, a report and a code out."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from analytic.kernels.compiled import compile_all
from analytic.response import Response
from studies.old import elsewhere, provenance
from studies.old.arguments import BadInputError
from studies.old.identity import Makers
from studies.old.jobs import Job, ask, summary
from studies.old.journal import JOURNAL, PROVENANCE, FolderError, Journal, Row, open_journal
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.provenance import seal
from studies.old.refusing import one_line
from studies.old.runner import Reduce, exit_code, run_jobs
from studies.old.study import Study
from studies.old.tables import with_head, write_table
from studies.sources.registry import Source

Tables: TypeAlias = "Mapping[str, pd.DataFrame]"
"""Tables by the names of their files, without .csv."""


def by_label(label: str) -> Callable[[Sequence[Row]], Tables]:
    """Return what makes of rows a table for each value of a label, named so."""

    def divided(rows: Sequence[Row]) -> Tables:
        names = dict.fromkeys(row[label] for row in rows)
        return {n: pd.DataFrame([row for row in rows if row[label] == n]) for n in names}

    return divided


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What a study makes.

    Attributes
    ----------
    jobs : sequence of Job, or callable, optional
        In the order of the rows; none where the tables are made in one go. What takes long to make
        is made by a callable, once the folder is known to be usable.
    settings : mapping, optional
        What all rows depend on beside the code; must be the same whenever a folder is used.
    growing : mapping, optional
        Column -> the values asked for; where these are names that a user chose, each with what it
        means, columns and their values. A folder may gain values, but one that holds others is
        refused, so that its table is what was asked for and nothing is lost.
    ask : callable, optional
        How a job is put to its source.
    reduce : callable, optional
        The columns that follow a job's labels and source, outcome among them.
    tabulate : callable, optional
        The tables, from the rows of all jobs; by default one, called as the study.
    needed : callable, optional
        The rows whose failure is the study's; by default all.
    """

    jobs: Sequence[Job] | Callable[[], Sequence[Job]] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    growing: Mapping[str, Sequence[Any] | Mapping[str, Row]] = field(default_factory=dict)
    ask: Callable[[Job, Source], Response] = ask
    reduce: Reduce = summary
    tabulate: Callable[[Sequence[Row]], Tables] | None = None
    needed: Callable[[Sequence[Row]], Sequence[Row]] = tuple


def carry_out(
    study: Study, plan: Plan, out: Path, running: Running, report: Callable[[Path], str]
) -> int:
    """Run a study into a folder, print what `report` makes of it and return the exit code.

    Parameters
    ----------
    study, plan, out, running
        As for `fill`.
    report : callable
        Given the folder, it reduces and draws what is in it, and returns the text to print.

    Returns
    -------
    int
        0 if all rows that the plan needs are usable, 1 if some failed, which are named on stderr.

    Raises
    ------
    FolderError
        As `fill` does; also if rows that the folder already held break its tables or its report.
    BadInputError
        As `fill` does.
    """
    began = time.perf_counter()
    with blaming_its_rows(out):
        rows = fill(study, plan, out, running)
        print(report(out))
    provenance.finish(out / PROVENANCE, provenance.record_of(out), began)
    seal(out)
    return exit_code(plan.needed(rows))


def fill(study: Study, plan: Plan, out: Path, running: Running = DEFAULT_RUNNING) -> list[Row]:
    """Run what a folder does not hold yet, write its tables and provenance; return all rows.

    Parameters
    ----------
    study : Study
    plan : Plan
    out : Path
        The results folder; made if there is none.
    running : Running
        Where the jobs run, for how long, and which other folders' rows are taken over.

    Returns
    -------
    list of dict
        In the order of the jobs: labels, source, then what the plan's `reduce` returns.

    Raises
    ------
    FolderError
        If a folder cannot be used: results of another study or of other settings are refused.
    BadInputError
        If the cluster or the number of processes cannot be used; or, of a run that a refusal or a
        full disk ends early, to say how many rows are kept.
    """
    compile_all()  # what a folder holds may be a run time
    executor = running.executor(plan.ask)
    began = time.perf_counter()
    subject = provenance.subject(study.name, **plan.settings)
    others = [elsewhere.read(folder, subject) for folder in running.also or ()]
    with open_journal(out, subject, study.products) as journal:
        _refuse_others(out, [entry.row for entry in journal.kept.values()], plan.growing)
        path = out / PROVENANCE
        asked = {
            column: str(values) if isinstance(values, range) else values
            for column, values in plan.growing.items()
        }
        record = provenance.begin(path, subject, asked)
        jobs = plan.jobs() if callable(plan.jobs) else plan.jobs
        makers = Makers(plan.ask, plan.reduce)
        taken = [elsewhere.take(other, jobs, journal, makers) for other in others]
        answered: list[Job] = []
        with _going_on(journal, out, len(jobs)):

            def reduce(job: Job, response: Response) -> Row:
                answered.append(job)
                return plan.reduce(job, response)

            rows = run_jobs(jobs, executor=executor, reduce=reduce, journal=journal, makers=makers)
            journal.check()
            tabulate = plan.tabulate or partial(_whole, study.name)
            published = [chapter.folder for chapter in study.chapters]
            for name, table in tabulate(rows).items():
                write_table(out / f"{name}.csv", with_head(table, published, name))
            computed = {"rows": len(rows), "computed": len(answered)}
            found: dict[str, Any] = computed if jobs else {}
            found |= {"also": taken} if taken else {}
            record["made"] = makers.of_tables(jobs, tabulate)
            provenance.finish(path, record, began, **found)
            seal(out)
    return rows


def _whole(name: str, rows: Sequence[Row]) -> Tables:
    return {name: pd.DataFrame(rows)}


def _refuse_others(
    folder: Path, rows: Sequence[Row], growing: Mapping[str, Sequence[Any] | Mapping[str, Row]]
) -> None:
    """Refuse a folder with rows of what is not asked for, or of another thing of the same name."""
    left_out = [
        f"{column} {', '.join(map(str, names))}"
        for column, named in growing.items()
        if (names := sorted({row[column] for row in rows} - set(named)))
    ]
    if left_out:
        problem = f"it also holds results of {' and '.join(left_out)}, which must be named too"
        raise FolderError(folder, problem)
    others = dict.fromkeys(
        f"{column} {row[column]}: {name} {row.get(name)} there, {value} here"
        for column, meant in growing.items()
        if isinstance(meant, Mapping)
        for row in rows
        for name, value in meant[row[column]].items()
        if row.get(name) != value
    )
    if others:
        problem = f"it must be new, or hold results of the same ({'; '.join(others)})"
        raise FolderError(folder, problem)


@contextmanager
def blaming_its_rows(folder: Path) -> Iterator[None]:
    """Refuse in one line a folder that already held rows of which no table can be made."""
    resumed = (folder / JOURNAL).is_file()
    try:
        yield
    except (BadInputError, FolderError, OSError):
        raise
    except Exception as error:
        if not resumed:
            raise
        # rows that no study wrote may break its tables in any way
        problem = f"of the rows in its {JOURNAL} no tables can be made ({one_line(error)})"
        raise FolderError(folder, problem) from error


@contextmanager
def _going_on(journal: Journal, folder: Path, count: int) -> Iterator[None]:
    """Say of a run that ends early what is kept, and how to go on."""
    try:
        yield
    except (KeyboardInterrupt, BadInputError, OSError) as stop:
        journal.check()
        if not count:
            raise
        kept = f"{len(journal.kept)} of {count} rows are kept in {str(folder)!r}"
        text = f"{kept}; the same command goes on from there"
        if isinstance(stop, OSError) and stop.filename:
            stop.strerror = f"{stop.strerror}; {text}"
            raise
        text = f"{stop}; {text}" if str(stop) else text
        if isinstance(stop, KeyboardInterrupt):
            stop.args = (text,)
            raise
        raise BadInputError(text) from stop
