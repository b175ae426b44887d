"""One question to one source: its identity, its answer, the row that is made of it."""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np

from analytic.motion import FloatArray, Motion, SinePulse
from analytic.response import Response
from studies.cases.refusal import BadInputError
from studies.old.journal import Row
from studies.old.refusing import brief, one_line
from studies.sources.registry import Source, resolve

LONG_S = 1.0
"""Expected time [s] beyond which a job gets a process of its own, where it can be given up."""

STEP_S = {"peer": 1e-6}
"""Kind of a source -> about how long it takes over a step [s]; COMPILED_STEP_S if not here."""

COMPILED_STEP_S = 1e-7
"""About how long a compiled source takes over a step [s]."""

NOBODY = Source("model", Response.failure)
"""Who is asked before a name is resolved."""

SLOWEST_RETURN = 40.0
"""Time, in units of 1/p, in which a free block turns or is lost, if it does so at all: so near to
the separatrix that it takes longer, it would be within e^-40 of it, which no double is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One question to one source.

    Attributes
    ----------
    labels : mapping
        The first columns of the row.
    block, motion
        What stands on the base (`engines.layouts.System`), and how that moves.
    source : str
        A source's name, as the user wrote it.
    duration, times
        As in `studies.respond`.
    options : mapping
        Further settings of the source.
    asked : Source
        What the name means, found when the job is made.

    Raises
    ------
    BadInputError
        If an option is none of the source's, or a value is not allowed.
    studies.sources.registry.UnknownSourceError
        If there is no such source.
    """

    labels: Mapping[str, Any]
    block: Any
    motion: Motion
    source: str
    duration: float | None = None
    times: FloatArray | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    asked: Source = field(default=NOBODY, repr=False, compare=False)

    def __post_init__(self) -> None:
        # what was resolved travels with a job that is made of another, where no registry is
        if self.asked.name != self.source:
            object.__setattr__(self, "asked", resolve(self.source))
        times, duration = self.times, self.duration
        try:
            self.asked.check(
                self.block, self.motion, duration=duration, times=times, **self.options
            )
        except (TypeError, ValueError) as error:
            raise BadInputError(f"source {self.source!r} cannot be asked so: {error}") from error

    @property
    def key(self) -> str:
        """The identity of the job: everything that its result depends on."""
        asked = {name: value for name, value in plain(self).items() if name != "asked"}
        parts = [asked, type(self.motion).__name__, self.asked.preset]
        text = json.dumps(parts, default=plain, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    def has_made(self, row: Row) -> bool:
        """Whether a row is one of this job: its labels and its source come first in it."""
        mine = {**self.labels, "source": self.source}
        return json.dumps(mine) == json.dumps({name: row.get(name) for name in mine})

    @property
    def needs_process(self) -> bool:
        """Whether its source may crash over it, or take so long that it must be stoppable."""
        observed = self.motion.duration if self.duration is None else self.duration
        most = observed * self.block.p + SLOWEST_RETURN
        step_s = STEP_S.get(self.asked.kind, COMPILED_STEP_S)
        long = most * step_s > LONG_S * float(self.options.get("step", 1e-3))
        return self.asked.kind == "engine" or long


def plain(value: Any) -> Any:
    """Return a part of what is hashed as JSON knows it; TypeError if it cannot be told apart."""
    if is_dataclass(value) and not isinstance(value, type):
        # one level: what is inside comes here again
        return {part.name: getattr(value, part.name) for part in fields(value)}
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r} cannot be part of an identity")


def short(job: Job) -> Job:
    """Return a question that takes no time and runs through the same compiled kernels."""
    block = job.block
    pulse = SinePulse(amplitude=2.0 * block.gravity * math.tan(block.alpha), omega=4.0 * block.p)
    return replace(
        job,
        motion=pulse,
        duration=None if job.duration is None else pulse.duration,
        times=None if job.times is None else np.linspace(0.0, pulse.duration, 3),
        options={name: value for name, value in job.options.items() if name != "step"},
    )


def ask(job: Job, source: Source) -> Response:
    """Run one job in this process; whatever it raises becomes a failed response.

    Parameters
    ----------
    job : Job
    source : Source
        What the name of its source means: `Job.asked`, but for studies that ask another one.

    Returns
    -------
    Response
        The message of a failure names the kind of the exception.
    """
    try:
        return source.call(
            job.block, job.motion, duration=job.duration, times=job.times, **job.options
        )
    except Exception as error:
        return Response.failure(one_line(error))


def summary(_: Job, response: Response) -> Row:
    """Return the columns that every study shares.

    Parameters
    ----------
    _ : Job
        Not used; every `reduce` is given one.
    response : Response

    Returns
    -------
    dict
        outcome, peak_ratio, impacts (their number), steps, wall_s [s] and message (in one line) of
        the response.
    """
    return {
        "outcome": response.outcome.value,
        "peak_ratio": float(response.peak_ratio),
        "impacts": len(response.impacts),
        "steps": int(response.steps),
        "wall_s": round(float(response.wall_s), 9),
        "message": brief(response.message),
    }
