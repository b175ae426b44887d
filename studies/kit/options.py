"""Options that studies share: each a dataclass, which is the type of a command's parameter."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from analytic.response import Response
from studies.kit.arguments import Count, Place, Positive, Step, one_of, several_or_none
from studies.kit.estimates import CASE_BYTES, expected_s, refuse_days, refuse_excess
from studies.kit.executors import Executor, choose
from studies.kit.jobs import Job, ask
from studies.sources.registry import DEFAULT_EFFORT, Accuracy, Effort, Source


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Computing:
    """Where jobs run, and for how long at most.

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

    def executor(self, ask: Callable[[Job, Source], Response] = ask) -> Executor:
        """Return what runs jobs, each put to its source by `ask`.

        Raises
        ------
        BadInputError, studies.kit.dask_client.ClusterError
            As `studies.kit.executors.choose`.
        """
        return choose(self.jobs, self.time_limit, self.cluster, ask)

    def refuse_too_much(
        self,
        asked: str,
        cases: int,
        sources: Sequence[str],
        *,
        yes: bool,
        effort: Effort = DEFAULT_EFFORT,
        case_bytes: float = 0.0,
    ) -> None:
        """Refuse more cases than fit into memory, or, without a yes, into a day.

        Parameters
        ----------
        asked : str
            What the user asked for, as the refusal begins.
        cases : int
        sources : sequence of str
            Who is asked about each case, with a name for every time.
        yes : bool
            Whether it is begun even if it takes longer than a day.
        effort : Effort, optional
        case_bytes : float, optional
            What a case holds besides its rows.

        Raises
        ------
        BadInputError
        """
        refuse_excess(asked, cases * (case_bytes + len(sources) * CASE_BYTES))
        limit = self.time_limit
        seconds = expected_s(cases, sources, jobs=self.jobs, time_limit_s=limit, effort=effort)
        refuse_days(asked, seconds, yes)


DEFAULT_COMPUTING = Computing()
"""On all cores of this machine."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Running(Computing):
    """Where a study's jobs run, and which of its rows there are already.

    Attributes
    ----------
    also
        Folders of the same command's results, whose rows are taken over: of engines that are
        installed elsewhere, or of another machine.
    """

    also: Annotated[tuple[Place, ...] | None, several_or_none] = None


DEFAULT_RUNNING = Running()
"""On all cores of this machine, from the beginning."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class EffortOptions(Effort):
    """How finely the sources step that do.

    Attributes
    ----------
    step
        p dt [-] of the solvers and engines, the step in units of 1/p; by default their own.
    accuracy
        loose, standard or tight, for engines whose steps land on impacts; standard by default.
    """

    step: Step | None = None
    accuracy: Annotated[Accuracy, one_of(Accuracy)] | None = None


OWN_EFFORT = EffortOptions()
"""Every source as finely as it sees fit."""
