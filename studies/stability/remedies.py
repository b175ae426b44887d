"""What avoids a failure: other settings of the same method, tried until one is right."""

from dataclasses import dataclass, replace
from typing import Any

from analytic.response import Response
from studies.cases.extreme import Extreme
from studies.kit.jobs import Job, ask
from studies.measures.verdicts import ACCEPTED, judge
from studies.sources.registry import Source, resolve

FINER = {"landing": 5e-4, "fixed": 1e-4, "naive": 1e-4}
"""p dt of the remedy for each preset of an engine."""
NOTHING = "none of those tried"
BETTER_SETTING = {"pybullet": ("iterations", 10000), "mujoco": ("impratio", 100.0)}
"""The setting of each engine's contact solver that is worth a try."""
SHARE = 0.3
"""Part of the time limit that is left to each run of an engine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Remedied(Response):
    """A response to an extreme case, and the setting that would have made it right, if any."""

    remedy: str = ""


def answer(case: Extreme, job: Job, source: Source, time_limit_s: float) -> Response:
    """Put a case to a source; where its answer is wrong, look for a setting that is right."""
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
    return _of_engine(case, source, asked.preset, options) if asked.kind == "engine" else []


def _of_engine(
    case: Extreme, source: str, preset: str, options: dict[str, Any]
) -> list[tuple[str, str, dict[str, Any]]]:
    engine = source.partition(":")[0]
    tried = []
    if case.contact is not None:
        without = {k: v for k, v in options.items() if k != "settings"}
        tried.append(("the preset's own contact", source, without))
    if case.step_s is None and preset != "naive":
        step = FINER[preset]
        tried.append((f"p dt {step:g}", source, {**options, "step": step}))
    name, value = BETTER_SETTING[engine]
    if preset != "naive":
        settings = {**options.get("settings", {}), name: value}
        tried.insert(0, (f"{name} {value:g}", source, {**options, "settings": settings}))
    better = {k: v for k, v in options.items() if k not in ("step", "settings")}
    if case.step_s is not None:
        tried.append(("the preset's own step", source, better))
    if preset != "landing":
        tried += [(f"preset {name}", f"{engine}:{name}", better) for name in ("fixed", "landing")]
    return [entry for entry in tried if entry[1:] != (source, options)]
