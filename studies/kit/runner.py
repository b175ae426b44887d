"""Many jobs: in parallel, resumable, with progress; a failure is a row and stops nothing."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pandas as pd
from tqdm import tqdm

from analytic.response import Outcome, Response
from studies.kit import provenance
from studies.kit.arguments import BadInputError
from studies.kit.executors import Executor
from studies.kit.jobs import Job, summary
from studies.kit.journal import PROVENANCE, FolderError, Journal, Row, open_journal

_LABELS = ("figure", "panel", "case", "aspect", "width_m", "omega_over_p")
"""Columns that name a failed case."""


Reduce = Callable[[Job, Response], Row]
"""Makes of a job's response the columns that follow its labels and source, outcome among them."""


def fill_folder(
    folder: Path,
    study: str,
    jobs: Sequence[Job] | Callable[[], Sequence[Job]],
    *,
    module: str,
    executor: Executor,
    reduce: Reduce = summary,
    settings: Mapping[str, Any],
    growing: Mapping[str, Sequence[Any]],
    products: Sequence[str],
    tables: str | None = None,
) -> list[Row]:
    """Run the jobs that a results folder does not hold yet; write its table and provenance.

    Parameters
    ----------
    folder : Path
        Results of another version or of other settings are refused.
    study : str
        Its name; the table is `<study>.csv`.
    jobs : sequence of Job, or callable
        In the order of the table; or what makes them, where that takes long: it is called when the
        folder is known to be usable.
    module : str
        The study's own, whose code and imports decide the rows.
    executor : Executor
    reduce : callable, optional
        As in `run_jobs`.
    settings : mapping
        What all rows depend on; must be the same whenever the folder is used.
    growing : mapping
        Column -> the values asked for. A folder may gain values, but one that holds others is
        refused, so that its table is what was asked for and nothing is lost.
    products : sequence of str
        The files that the study writes.
    tables : str, optional
        A label whose values name the tables, where a study has several.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    began = time.perf_counter()
    identity = provenance.identity(study, module, **settings)
    with open_journal(folder, identity, products) as journal:
        _refuse_a_part(folder, journal.rows.values(), growing)
        asked = jobs() if callable(jobs) else jobs
        path = folder / PROVENANCE
        record = provenance.begin(path, identity, {k: _short(v) for k, v in growing.items()})
        try:
            rows = run_jobs(asked, executor=executor, reduce=reduce, journal=journal)
            journal.check()
            for name in dict.fromkeys(row[tables] for row in rows) if tables else [study]:
                part = [row for row in rows if row[tables] == name] if tables else rows
                text = pd.DataFrame(part).to_csv(index=False, na_rep="nan")
                provenance.write_text(folder / f"{name}.csv", text)
            provenance.finish(path, record, began, rows=len(rows))
        except (KeyboardInterrupt, BadInputError, OSError) as stop:
            journal.check()
            kept = f"{len(journal.rows)} of {len(asked)} rows are kept in {str(folder)!r}"
            words = f"{stop}; " if str(stop) else ""
            text = f"{words}{kept}; the same command goes on from there"
            if isinstance(stop, KeyboardInterrupt):
                stop.args = (text,)
                raise
            raise BadInputError(text) from stop
    return rows


@contextmanager
def own_folder(
    folder: Path, study: str, products: Sequence[str], *, module: str, **settings: Any
) -> Iterator[None]:
    """Hold a results folder for a study that is done in one go, and write its provenance.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    began = time.perf_counter()
    identity = provenance.identity(study, module, **settings)
    with open_journal(folder, identity, products) as journal:
        path = folder / PROVENANCE
        record = provenance.begin(path, identity, {})
        yield
        journal.check()
        provenance.finish(path, record, began)


def _short(values: Sequence[Any]) -> Any:
    return str(values) if isinstance(values, range) else list(values)


def _refuse_a_part(folder: Path, rows: Any, growing: Mapping[str, Sequence[Any]]) -> None:
    left_out = [
        f"{column} {', '.join(map(str, names))}"
        for column, named in growing.items()
        if (names := sorted({row[column] for row in rows} - set(named)))
    ]
    if left_out:
        problem = f"it also holds results of {' and '.join(left_out)}, which must be named too"
        raise FolderError(folder, problem)


def run_jobs(
    jobs: Sequence[Job],
    *,
    executor: Executor,
    reduce: Reduce,
    journal: Journal | None = None,
) -> list[Row]:
    """Run the jobs that are not in the journal yet, and return the rows of all in their order.

    Progress is shown on stderr if that is a terminal.
    """
    keys = [job.key for job in jobs]
    done = dict(journal.rows) if journal else {}
    pending = [number for number, key in enumerate(keys) if key not in done]
    finished = len(jobs) - len(pending)
    with (
        tqdm(total=len(jobs), initial=finished, disable=None, unit="case") as bar,
        closing(executor([jobs[number] for number in pending])) as answers,
    ):
        for position, response in answers:
            number = pending[position]
            row = {
                **jobs[number].labels,
                "source": jobs[number].source,
                **reduce(jobs[number], response),
            }
            done[keys[number]] = row
            if journal:
                journal.append(keys[number], row)
            bar.update()
    return [done[key] for key in keys]


def exit_code(rows: Sequence[Row], shown: int = 10) -> int:
    """Return 0 if every row is usable; else name those that failed on stderr and return 1."""
    failed = [row for row in rows if row["outcome"] == Outcome.FAILED.value]
    for row in failed[:shown]:
        case = ", ".join(f"{name} {row[name]}" for name in row if name in _LABELS)
        print(f"failed: {row['source']}{case and ', '}{case}: {row['message']}", file=sys.stderr)
    if len(failed) > shown:
        print(f"failed: {len(failed) - shown} more", file=sys.stderr)
    return 1 if failed else 0
