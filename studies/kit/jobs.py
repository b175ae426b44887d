"""One question to one source: its identity, its answer, and the columns that every row has."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np

from analytic.motion import FloatArray, Motion
from analytic.response import Response
from engines.scene import System
from studies.cases.refusal import BadInputError
from studies.kit.say import brief, one_line
from studies.sources.registry import Source, resolve

Row = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What stands on the base, how that moves, and how long it is watched."""

    system: System
    motion: Motion
    start: tuple[float, float] = (0.0, 0.0)  # rotation [rad] and its rate [rad/s] at time zero
    duration: float | None = None  # [s]; None: as `respond` does
    times: FloatArray | None = None  # of the history [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One question to one source, which must exist and take the options."""

    labels: Mapping[str, Any]  # the first columns of the row
    case: Question
    source: str  # its name, as the user wrote it
    options: Mapping[str, Any] = field(default_factory=dict)  # further settings of the source
    lost: Response | None = field(default=None, repr=False)  # the answer if its process ended
    apart: bool = False  # whether it runs in a process of its own though its source is a model

    def __post_init__(self) -> None:
        case = self.case
        try:
            self.asked.check(
                case.system, case.motion, duration=case.duration, times=case.times, **self.settings
            )
        except (TypeError, ValueError) as error:
            raise BadInputError(f"source {self.source!r} cannot be asked so: {error}") from error

    @property
    def asked(self) -> Source:
        """The source that the name means."""
        return resolve(self.source)

    @property
    def settings(self) -> dict[str, Any]:
        """The options, with a start that is not at rest."""
        start = {} if self.case.start == (0.0, 0.0) else {"start": self.case.start}
        return {**self.options, **start}

    @property
    def key(self) -> str:
        """The identity of the job: everything that its row depends on but code and versions."""
        parts = [self.labels, self.case, self.source, self.asked.preset, self.options]
        text = json.dumps(parts, default=plain, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def needs_process(self) -> bool:
        """Whether its source may crash, or not come to an end."""
        return self.apart or self.asked.kind == "engine"


def plain(value: Any) -> Any:
    """Return a part of an identity as JSON knows it; TypeError if it cannot be told apart."""
    if is_dataclass(value) and not isinstance(value, type):
        inner = {part.name: getattr(value, part.name) for part in fields(value)}
        return [type(value).__name__, inner]
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r} cannot be part of an identity")


def ask(job: Job) -> Response:
    """Put a job to its source; an exception becomes a failed response that names its kind."""
    if job.lost is not None:
        return job.lost
    case = job.case
    try:
        return job.asked.call(
            case.system, case.motion, duration=case.duration, times=case.times, **job.settings
        )
    except Exception as error:
        return Response.failure(one_line(error))


def summary(response: Response) -> Row:
    """Return the columns that every row has: the message in one line, the run time in s."""
    return {
        "outcome": response.outcome.value,
        "peak_ratio": float(response.peak_ratio),
        "impacts": len(response.impacts),
        "steps": int(response.steps),
        "wall_s": round(float(response.wall_s), 9),
        "message": brief(response.message),
    }


def answer(job: Job) -> Row:
    """Put a job to its source, and return the columns that every row has."""
    return summary(ask(job))


def unanswered(message: str) -> Row:
    """Return the row of a job that has no response to measure."""
    return summary(Response.failure(message))
