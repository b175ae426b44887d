"""Options that commands share: each a dataclass, which is the type of a command's parameter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Parameter

from analytic.slide import SlidingBlock
from engines.scene import System
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.store import usable_cores
from studies.sources.registry import Accuracy, resolve


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Computing:
    """Where jobs run, and for how long at most.

    Attributes
    ----------
    jobs
        Processes that run engines; by default one per core.
    time_limit
        Wall-clock time [s] after which a case of an engine fails.
    cluster
        Address of a Dask scheduler whose workers run all cases, such as tcp://127.0.0.1:8786.
    """

    jobs: arguments.Count | None = None
    time_limit: arguments.TimeLimit = 600.0
    cluster: str | None = None

    def __post_init__(self) -> None:
        if self.cluster is not None:
            arguments.refuse_given({"jobs": self.jobs}, "only without --cluster")

    @property
    def workers(self) -> int:
        """Processes side by side."""
        return self.jobs or usable_cores()


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Running(Computing):
    """Where a study's jobs run, and which of its rows there are already.

    Attributes
    ----------
    also
        Further folders of the same command's results, such as those of engines that are installed
        elsewhere; their rows are added.
    """

    also: Annotated[tuple[arguments.Place, ...] | None, arguments.several_or_none] = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class EffortOptions:
    """How finely the sources step that do.

    Attributes
    ----------
    p_dt
        Step of solvers and engines in units of 1/p; by default their own.
    accuracy
        Accuracy of engines with landing steps; by default standard.
    """

    p_dt: arguments.Step | None = None
    accuracy: Annotated[Accuracy, arguments.one_of(Accuracy)] | None = None

    @property
    def own(self) -> bool:
        """Whether every source steps as it sees fit."""
        return self.p_dt is None and self.accuracy is None

    def options(self, name: str) -> dict[str, Any]:
        """Return the options that this means for a source."""
        source = resolve(name)
        chosen: dict[str, Any] = {}
        if self.p_dt is not None and source.stepping:
            chosen["step"] = self.p_dt
        if self.accuracy is not None and source.accurate:
            chosen["accuracy"] = self.accuracy
        return chosen

    def refuse_idle(self, sources: Sequence[str]) -> None:
        """Refuse an option that none of the sources takes."""
        _refuse_idle(sources, "stepping", "a solver or an engine", p_dt=self.p_dt)
        _refuse_idle(
            sources, "accurate", "an engine that chooses its steps", accuracy=self.accuracy
        )


def _refuse_idle(sources: Sequence[str], taking: str, words: str, **given: Any) -> None:
    """Refuse a given option if none of the sources is what takes it."""
    if not any(getattr(resolve(source), taking) for source in sources):
        arguments.refuse_given(given, f"only if --sources names {words}")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Yours:
    """What a reader's own simulation has.

    Attributes
    ----------
    friction
        Coefficient of friction between block and base in engines; by default the preset's. Models
        do not slide: if the exact solution needs more friction, its row says so.
    dt
        Step [s] of solvers, and of engines whose preset takes equal steps.
    """

    friction: arguments.NotNegative | None = None
    dt: arguments.Positive | None = None

    def options(self, sources: Sequence[str], system: System) -> dict[str, dict[str, float]]:
        """Return the options that this means for each source: friction, and step, p dt."""
        if not isinstance(system, SlidingBlock):
            _refuse_idle(sources, "engine", "at least one engine", friction=self.friction)
        words = "a solver or an engine that takes equal steps"
        _refuse_idle(sources, "stepping", words, dt=self.dt)
        chosen: dict[str, dict[str, float]] = {name: {} for name in sources}
        for name, source in [(name, resolve(name)) for name in sources]:
            if self.friction is not None and source.engine:
                chosen[name]["friction"] = self.friction
            if self.dt is not None and source.accurate:
                words = f"{name} takes {source.used.stepping.value}"
                raise BadInputError(f"--dt is {self.dt:g}; its steps must be equal, but {words}")
            if self.dt is not None and source.stepping:
                chosen[name]["step"] = self.dt * system.p
        return chosen
