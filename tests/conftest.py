"""Fixtures of more than one file of tests."""

from collections import Counter

import pytest

from engines import registry
from studies.kit.jobs import Job
from studies.sources.registry import SOURCES


@pytest.fixture(autouse=True)
def in_this_process(request, monkeypatch):
    """Let no job need a process of its own, but in tests of what these do."""
    if "processes" not in request.keywords:
        monkeypatch.setattr(Job, "needs_process", False)


def forgetting():
    """Let what is announced be forgotten afterwards."""
    kept = dict(SOURCES)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(registry.FURTHER, "")
        yield patch
    registry._places.cache_clear()
    registry.loaded.cache_clear()
    SOURCES.clear()
    SOURCES.update(kept)


alone = pytest.fixture(forgetting)
alone_in_module = pytest.fixture(forgetting, scope="module")


@pytest.fixture
def few(monkeypatch):
    """Let a score ask the first, on which all is well, and another job of each table and preset."""
    from studies import score

    everything = score.jobs

    def chosen(*asked):
        seen, found = Counter(), []
        for job in everything(*asked):
            seen[key := (job.labels["part"], job.source)] += 1
            found += [job] * (seen[key] in (1, 4))
        return found

    monkeypatch.setattr(score, "jobs", chosen)
    return chosen
