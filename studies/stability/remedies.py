"""What avoids a failure: other settings of the same method, tried until one is right."""

from dataclasses import dataclass, replace
from typing import Any

from analytic.response import Response
from engines.declaration import Stepping
from studies.cases.extreme import Extreme
from studies.old.jobs import Job, ask
from studies.measures.verdicts import ACCEPTED, judge
from studies.sources.registry import Source, resolve

FINER, FINEST = 5e-4, 1e-4
"""p dt of the remedy for steps that land on impacts, and for equal ones."""
NOTHING = "none of those tried"
SHARE = 0.3
"""Part of the time limit that is left to each run of an engine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Remedied(Response):
    """A wrong response to an extreme case, and the first setting tried that is right.

    Attributes
    ----------
    remedy : str
        In words; NOTHING if none is.
    """

    remedy: str = ""


def answer(case: Extreme, job: Job, source: Source, time_limit_s: float) -> Response:
    """Put a case to a source; where its answer is wrong, look for a setting that is right.

    Parameters
    ----------
    case : Extreme
    job : Job
        The case's, to the source.
    source : Source
    time_limit_s : float
        Time limit of the job [s]; an engine has SHARE of it for its answer, a tenth for each of
        `remedies`.

    Returns
    -------
    Response
        A `Remedied` where the verdict on it is none of ACCEPTED.
    """
    limited = _limited(job, source, SHARE * time_limit_s)
    response = ask(limited, source)
    if judge(case, job.source, response).verdict in ACCEPTED:
        return response
    kept = {name: getattr(response, name) for name in Response.__slots__}
    return Remedied(**kept, remedy=_first_right(case, job, 0.1 * time_limit_s))


def _first_right(case: Extreme, job: Job, seconds: float) -> str:
    for sentence, name, options in remedies(case, job.source):
        source = resolve(name)
        response = ask(
            _limited(replace(job, source=name, options=options), source, seconds), source
        )
        if judge(case, name, response).verdict in ACCEPTED:
            return sentence
    return NOTHING


def _limited(job: Job, source: Source, seconds: float) -> Job:
    if source.kind != "engine":
        return job
    return replace(job, options={**job.options, "time_limit_s": seconds})


def remedies(case: Extreme, source: str) -> list[tuple[str, str, dict[str, Any]]]:
    """Return settings to try: a sentence, the source and its options."""
    asked, options = resolve(source), case.options(source)
    if asked.kind == "solver":
        return [
            (
                f"p dt {step:g}, events to {event:g}",
                source,
                {"step": step, "event_tolerance": event},
            )
            for step, event in ((1e-3, 1e-13), (1e-4, 1e-13))
        ]
    if asked.kind == "peer":
        return [("rtol 1e-12", source, {"rtol": 1e-12})]
    return _of_engine(case, source, options) if asked.kind == "engine" else []


def _of_engine(
    case: Extreme, source: str, options: dict[str, Any]
) -> list[tuple[str, str, dict[str, Any]]]:
    engine, preset = resolve(source).declared, resolve(source).used
    tuned = preset is not engine.presets[0]
    tried = []
    if case.contact is not None:
        without = {k: v for k, v in options.items() if k != "settings"}
        tried.append(("the preset's own contact", source, without))
    if case.step_s is None and tuned:
        step = FINEST if preset.stepping is Stepping.FIXED else FINER
        tried.append((f"p dt {step:g}", source, {**options, "step": step}))
    if tuned and engine.remedy:
        words = ", ".join(f"{name} {value:g}" for name, value in engine.remedy.items())
        settings = {**options.get("settings", {}), **engine.remedy}
        tried.insert(0, (words, source, {**options, "settings": settings}))
    better = {k: v for k, v in options.items() if k not in ("step", "settings")}
    if case.step_s is not None:
        tried.append(("the preset's own step", source, better))
    if preset is not engine.best:
        others = (other.name for other in engine.presets[1:])
        tried += [(f"preset {name}", f"{engine.name}:{name}", better) for name in others]
    return [entry for entry in tried if entry[1:] != (source, options)]
