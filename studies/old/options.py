"""Options that studies share: each a dataclass, which is the type of a command's parameter."""

import contextlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from analytic.response import Response
from analytic.slide import SlidingBlock
from engines.declaration import Stepping
from engines.layouts import System
from studies.old.arguments import (
    BadInputError,
    Count,
    NotNegative,
    Place,
    Positive,
    Step,
    TimeLimit,
    one_of,
    refuse_given,
    several_or_none,
)
from studies.old.executors import Executor, Local
from studies.old.jobs import Job, ask
from studies.old.provenance import usable_cores
from studies.sources.registry import DEFAULT_EFFORT, Accuracy, Effort, Source, resolve

DAY_S = 86_400.0
"""What takes longer is begun only with --yes."""

CASE_S = {"model": 1e-3, "solver": 5e-3, "peer": 0.05, "engine": 0.1}
"""About what a case takes a source of each kind, its row in the table included [s]."""

CASE_BYTES = 4e3
"""About what a case and its row hold of memory."""

PROCESS_BYTES = 2e8
"""About what a process with an engine and the compiled kernels holds."""

CONTAINER = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Where Linux says how much memory a container may use."""


def refuse_days(asked: str, seconds: float, yes: bool) -> None:
    """Refuse what takes longer than a day, unless that is wanted.

    Parameters
    ----------
    asked : str
        What the user asked for, as the refusal begins.
    seconds : float
        About how long it takes [s].
    yes : bool
        Whether it is wanted.

    Raises
    ------
    BadInputError
    """
    if seconds > DAY_S and not yes:
        days = f"{seconds / DAY_S:.1f} days"
        raise BadInputError(f"{asked}; that takes about {days}, and more than one needs --yes")


def refuse_excess(asked: str, held: float) -> None:
    """Refuse what needs more memory than there is.

    Parameters
    ----------
    asked : str
        What the user asked for, as the refusal begins.
    held : float
        About what it needs [byte].

    Raises
    ------
    BadInputError
    """
    if held > (there := memory()):
        needs = f"that needs about {held / 1e9:.0f} GB of memory"
        raise BadInputError(f"{asked}; {needs}, and at most {there / 1e9:.0f} GB are there")


def memory() -> float:
    """Return the memory of this machine, or what its container may use of it [byte]."""
    limits = [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")]
    for name in CONTAINER:
        # a container without a limit says "max"
        with contextlib.suppress(OSError, ValueError):
            limits.append(int(Path(name).read_text()))
    return float(min(limits))


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Computing:
    """Where jobs run, and for how long at most.

    Attributes
    ----------
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case, or the search for a margin, is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """

    jobs: Count | None = None
    time_limit: TimeLimit = 60.0
    cluster: str | None = None

    def executor(
        self, ask: Callable[[Job, Source], Response] = ask, *, at_once: bool = False
    ) -> Executor:
        """Return what runs jobs, each put to its source by `ask`; `at_once` as of `Local`.

        Raises
        ------
        BadInputError
            If there are more processes than the memory holds, or their number is given beside a
            cluster, whose workers are as many as were started, or that cannot be used.
        """
        if self.cluster is None:
            refuse_excess(f"--jobs is {self.jobs}", (self.jobs or 1) * PROCESS_BYTES)
            return Local(self.jobs or usable_cores(), self.time_limit, ask, at_once)
        # asyncio takes a tenth of a second to load, and most runs have no cluster
        from studies.old.cluster import Cluster

        refuse_given({"jobs": self.jobs}, "only without --cluster")
        chosen = Cluster(self.cluster, self.time_limit, ask)
        chosen.check()
        return chosen

    def refuse_too_much(
        self,
        asked: str,
        cases: int,
        sources: Sequence[str],
        *,
        yes: bool,
        effort: Effort = DEFAULT_EFFORT,
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

        Raises
        ------
        BadInputError
        """
        refuse_excess(asked, cases * len(sources) * CASE_BYTES)
        seconds = 0.0
        for name in sources:
            kind = resolve(name).kind
            # a time grows as the step falls
            finer = max(1e-3 / float(effort.options(name).get("step", 1e-3)), 1.0)
            workers = (self.jobs or usable_cores()) if kind == "engine" else 1
            seconds += cases * min(CASE_S[kind] * finer, self.time_limit) / workers
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
class PatientRunning(Running):
    """As `Running`, with time for a job that asks an engine many times.

    Attributes
    ----------
    time_limit
        Wall-clock time [s] after which an engine's case, with its search for a threshold, a step or
        a remedy, is given up.
    """

    time_limit: TimeLimit = 180.0


PATIENT_RUNNING = PatientRunning()
"""The same, from the beginning."""


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

    def refuse_idle(self, sources: Sequence[str]) -> None:
        """Raise BadInputError if an option is given that none of the sources takes."""
        asked = [resolve(name) for name in sources]
        takers = {
            "step": ("a solver or an engine", any(source.stepping for source in asked)),
            "accuracy": ("an engine that chooses its steps", any(it.accurate for it in asked)),
        }
        for name, (words, taken) in takers.items():
            if (value := getattr(self, name)) is not None and not taken:
                raise BadInputError(f"--{name} is {value}; --sources must name {words}")


OWN_EFFORT = EffortOptions()
"""Every source as finely as it sees fit."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Yours:
    """What a reader's own simulation has.

    Attributes
    ----------
    friction
        Coefficient of friction between block and base, in the engines; by default the preset's. The
        models do not slide: where it is less than the exact solution needs, its row says so.
    dt
        Step [s] of the solvers, and of engines whose preset takes equal steps.
    """

    friction: NotNegative | None = None
    dt: Positive | None = None

    def options(self, sources: Sequence[str], block: System) -> dict[str, dict[str, float]]:
        """Return the options that this means for each source.

        Parameters
        ----------
        sources : sequence of str
        block : System
            Of which p [rad/s] is used.

        Returns
        -------
        dict
            Source -> its options: friction, and step, p dt.

        Raises
        ------
        BadInputError
            If an engine whose steps are not equal is given one, or no source takes what is given.
        """
        asked = {name: resolve(name) for name in sources}
        idle = not any(source.engine for source in asked.values())
        if self.friction is not None and idle and not isinstance(block, SlidingBlock):
            raise BadInputError(f"--friction is {self.friction:g}; it must come with an engine")
        if self.dt is not None and not any(source.stepping for source in asked.values()):
            words = "a solver or an engine that takes equal steps"
            raise BadInputError(f"--dt is {self.dt:g}; it must come with {words}")
        chosen: dict[str, dict[str, float]] = {name: {} for name in sources}
        for name, source in asked.items():
            if self.friction is not None and source.engine:
                chosen[name]["friction"] = self.friction
            if self.dt is not None and source.stepping:
                self._refuse_uneven(source)
                chosen[name]["step"] = self.dt * block.p
        return chosen

    def _refuse_uneven(self, source: Source) -> None:
        if not source.accurate:
            return
        engine = source.declared
        equal = [use.name for use in engine.presets if use.stepping is Stepping.FIXED]
        instead = " or ".join(f"{engine.name}:{name}" for name in equal)
        raise BadInputError(
            f"--dt is {self.dt:g}; it must come with equal steps, and {source.name} takes "
            f"{source.used.stepping.value}: ask {instead}"
        )


NOT_YOURS = Yours()
"""Nothing of one's own."""


SHORTEST_S, LONGEST_S = 1e-6, 1.0
"""Steps [s] for which settings are written out."""


def check_written(dt: float | None) -> None:
    """Raise BadInputError if a step [s] is none for which settings are written out."""
    if dt is not None and not SHORTEST_S <= dt <= LONGEST_S:
        raise BadInputError(f"--dt is {dt:g}; it must be from {SHORTEST_S:g} to {LONGEST_S:g} s")


def slides(exact: Response, friction: float | None) -> str:
    """Say that a block slides where the exact solution, which does not, needs more friction.

    Parameters
    ----------
    exact : Response
        Of the exact solution; its `friction_needed` may be nan.
    friction : float or None
        Coefficient between block and base; None where none was given.

    Returns
    -------
    str
        Empty where it does not slide, or that is not known.
    """
    if friction is None or not friction < exact.friction_needed:
        return ""
    return f"slides: needs {exact.friction_needed:.3g}, has {friction:.3g}"
