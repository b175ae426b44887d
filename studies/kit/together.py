"""Jobs that an engine answers at once: which make up a batch, and how a process asks about it."""

import math
from collections.abc import Hashable, Mapping, Sequence
from functools import partial

from analytic.kernels.compiled import compile_all
from analytic.response import Response
from engines import ENGINES
from engines.declaration import BatchEngine
from engines.run.batch import alike, run_together
from engines.scene import Scene
from studies.kit.jobs import Job
from studies.sources.registry import run_engine, scene_of


def batches(jobs: Mapping[int, Job], workers: int) -> list[list[int]]:
    """Return the numbers of the jobs that are answered at once, two or more a batch.

    They share their source and what else is `alike`. Each worker gets a part of every such group,
    as large as another's, so that none waits for long; an engine may want smaller ones.
    """
    groups: dict[tuple[str, Hashable], list[int]] = {}
    for number, job in jobs.items():
        scene = _scene(job)
        common = None if scene is None else alike(job.asked.declared, scene)
        if common is not None:
            groups.setdefault((job.source, common), []).append(number)
    parts: list[list[int]] = []
    for numbers in groups.values():
        engine = jobs[numbers[0]].asked.declared
        most = engine.most_worlds if isinstance(engine, BatchEngine) else 1
        count = workers * math.ceil(len(numbers) / (workers * most))
        parts += [numbers[first::count] for first in range(count)]
    return [part for part in parts if len(part) > 1]


def ask_together(jobs: Sequence[Job]) -> list[Response]:
    """Put the jobs of a batch to their source, in a process of its own."""
    compile_all()
    scenes = [scene for job in jobs if (scene := _scene(job)) is not None]
    return run_together(jobs[0].asked.engine, scenes)


def _scene(job: Job) -> Scene | None:
    """Return the scene that a job puts to an engine that batches; None for any other job."""
    call = job.asked.call
    if not isinstance(call, partial) or call.func is not run_engine:
        return None
    if not isinstance(ENGINES.get(job.asked.engine), BatchEngine):
        return None
    preset = call.keywords["preset"]
    posed = {"duration": job.duration, "times": job.times, **job.options}
    return scene_of(job.block, job.motion, preset, **posed)
