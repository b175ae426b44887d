"""Options that studies share: each a dataclass, which is the type of a command's parameter."""

from collections.abc import Callable
from dataclasses import dataclass

from cyclopts import Parameter

from analytic.response import Response
from studies.kit.arguments import Count, Positive
from studies.kit.executors import Executor, choose
from studies.kit.jobs import Job, ask
from studies.sources.registry import Accuracy, Effort, Source


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Running:
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

    def executor(self, ask: Callable[[Job, Source], Response] = ask) -> Executor:
        """Return what runs jobs, each put to its source by `ask`.

        Raises
        ------
        BadInputError, studies.kit.dask_client.ClusterError
            As `studies.kit.executors.choose`.
        """
        return choose(self.jobs, self.time_limit, self.cluster, ask)


DEFAULT_RUNNING = Running()
"""On all cores of this machine."""


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

    step: Positive | None = None
    accuracy: Accuracy | None = None


OWN_EFFORT = EffortOptions()
"""Every source as finely as it sees fit."""
