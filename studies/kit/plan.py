"""What a study runs, and the one way it is run: jobs in; a folder, a report and a code out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from analytic.response import Response
from studies.kit.arguments import Count, Positive
from studies.kit.executors import choose
from studies.kit.jobs import Job, ask, summary
from studies.kit.journal import Row
from studies.kit.runner import Reduce, exit_code, fill_folder
from studies.kit.study import Study
from studies.sources.registry import Source


@dataclass(frozen=True, slots=True, kw_only=True)
class _Running:
    """Where a study's jobs run, and for how long at most.

    Attributes
    ----------
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """

    jobs: Count | None = None
    time_limit: Positive = 60.0
    cluster: str | None = None


Running = Annotated[_Running, Parameter(name="*")]
"""The options that all studies with jobs share, as the type of a command's parameter."""

DEFAULT_RUNNING = _Running()
"""On all cores of this machine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What a study runs.

    Attributes
    ----------
    jobs : sequence of Job, or callable
        In the order of the table; or what makes them, where that takes long.
    settings : mapping
        What all rows depend on beside the code; must be the same whenever a folder is used.
    growing : mapping
        Column -> the values asked for, of which a folder may gain more.
    ask : callable
        How a job is put to its source.
    reduce : callable
        The columns that follow a job's labels and source, outcome among them.
    tables : str, optional
        A label whose values name the tables, where a study has several.
    """

    jobs: Sequence[Job] | Callable[[], Sequence[Job]]
    settings: Mapping[str, Any] = field(default_factory=dict)
    growing: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    ask: Callable[[Job, Source], Response] = ask
    reduce: Reduce = summary
    tables: str | None = None


def fill(study: Study, plan: Plan, out: Path, running: _Running) -> list[Row]:
    """Run what a folder does not hold yet; return the rows of all jobs.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    return fill_folder(
        out,
        study.name,
        plan.jobs,
        module=study.module,
        executor=choose(running.jobs, running.time_limit, running.cluster, plan.ask),
        reduce=plan.reduce,
        settings=plan.settings,
        growing=plan.growing,
        products=study.products,
        tables=plan.tables,
    )


def carry_out(
    study: Study, plan: Plan, out: Path, running: _Running, report: Callable[[Path], str]
) -> int:
    """Run a study into a folder, print what `report` makes of it and return the exit code."""
    rows = fill(study, plan, out, running)
    print(report(out))
    return exit_code(rows)
