"""Many jobs: in parallel, resumable, with progress; a failure is a row and stops nothing."""

import sys
from collections.abc import Callable, Sequence
from contextlib import closing

from tqdm import tqdm

from analytic.response import Outcome, Response
from studies.kit.executors import Executor
from studies.kit.jobs import Job
from studies.kit.journal import Journal, Row

_LABELS = ("figure", "panel", "case", "aspect", "width_m", "omega_over_p")
"""Columns that name a failed case."""


Reduce = Callable[[Job, Response], Row]
"""Makes of a job's response the columns that follow its labels and source, outcome among them."""


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
    for job, key in zip(jobs, keys, strict=True):
        if journal and key in done and not job.has_made(done[key]):
            raise journal.stranger(key)
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
