"""Many jobs: in parallel, resumable, with progress; a failure is a row and stops nothing."""

import sys
from collections.abc import Callable, Sequence
from contextlib import closing

from tqdm import tqdm

from analytic.response import Outcome, Response
from studies.old.executors import Executor
from studies.old.identity import Makers, sorted_rows, why
from studies.old.jobs import Job
from studies.old.journal import Journal, Row
from studies.old.refusing import say

_LABELS = (
    *("name", "record", "scale"),
    *("figure", "panel", "case", "aspect", "width_m", "omega_over_p"),
)
"""Columns that name a failed case."""


Reduce = Callable[[Job, Response], Row]
"""Makes of a job's response the columns that follow its labels and source, outcome among them."""


def run_jobs(
    jobs: Sequence[Job],
    *,
    executor: Executor,
    reduce: Reduce,
    journal: Journal | None = None,
    makers: Makers | None = None,
) -> list[Row]:
    """Run the jobs that are not in the journal yet, and return the rows of all in their order.

    A row in the journal that would be made otherwise now is computed again; how many are, and why,
    is said on stderr. Progress is shown there if it is a terminal.

    Parameters
    ----------
    jobs : sequence of Job
    executor : Executor
        Where they run.
    reduce : callable
        Makes of a job and its response the columns that follow its labels and source.
    journal : Journal, optional
        Gets each row as soon as there is one; without it, or without `makers`, all jobs are run.
    makers : Makers, optional
        What makes the rows now.

    Returns
    -------
    list of dict
        One for each job; equal jobs share a row.

    Raises
    ------
    FolderError
        If the journal has a row of something else under a job's key, or its folder is removed.
    OSError, BadInputError
        If the executor cannot start a process, or its cluster cannot be used.
    """
    keys = [job.key for job in jobs]
    done: dict[str, Row] = {}
    if journal and makers:
        done, stale = sorted_rows(jobs, journal.kept, makers, journal.folder)
        if stale:
            say(f"{len(done)} of {len(jobs)} rows are kept; computed again: {why(stale)}")
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
            if journal and makers:
                journal.append(keys[number], row, makers.of(jobs[number]))
            bar.update()
    return [done[key] for key in keys]


def exit_code(rows: Sequence[Row], shown: int = 10) -> int:
    """Return 0 if every row is usable; else name those that failed on stderr and return 1.

    Parameters
    ----------
    rows : sequence of dict
        With outcome, source and message.
    shown : int
        How many are named one by one; of the others their number.
    """
    failed = [row for row in rows if row["outcome"] == Outcome.FAILED.value]
    for row in failed[:shown]:
        case = ", ".join(f"{name} {row[name]}" for name in row if name in _LABELS)
        print(f"failed: {row['source']}{case and ', '}{case}: {row['message']}", file=sys.stderr)
    if len(failed) > shown:
        print(f"failed: {len(failed) - shown} more", file=sys.stderr)
    return 1 if failed else 0
