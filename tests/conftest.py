"""Fixtures of more than one file of tests."""

from collections import Counter
from contextlib import nullcontext

import pytest

from engines import registry
from studies.kit import foreign
from studies.kit.jobs import Job
from studies.score import study as score
from studies.sources.registry import SOURCES


@pytest.fixture(autouse=True)
def in_this_process(request, monkeypatch):
    """Let no job and no engine need a process of its own, but in tests of what these do."""
    if "processes" not in request.keywords:
        monkeypatch.setattr(Job, "needs_process", False)
        monkeypatch.setattr(foreign, "kept_out", nullcontext)


@pytest.fixture
def alone(monkeypatch):
    """Let what is announced be forgotten after the test."""
    monkeypatch.setenv(registry.FURTHER, "")
    kept = dict(SOURCES)
    yield
    monkeypatch.undo()
    registry._places.cache_clear()
    registry._declared.cache_clear()
    SOURCES.clear()
    SOURCES.update(kept)


def some_of(jobs):
    """Return two jobs of each table and preset: the first, on which all is well, and another."""
    seen = Counter()
    for job in jobs:
        seen[key := (job.labels["table"], job.source)] += 1
        if seen[key] in (1, 4):
            yield job


@pytest.fixture
def few(monkeypatch):
    """Let a score ask two jobs of each table and preset; give what returns these of an engine."""
    everything = score.score_jobs

    def chosen(*asked):
        return list(some_of(everything(*asked)))

    monkeypatch.setattr(score, "score_jobs", chosen)
    monkeypatch.setattr(score, "answer", lambda case, job, source, limit: score.plain(job, source))
    return chosen
