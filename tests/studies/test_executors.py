"""Jobs in processes of their own: crashes, time limits, and what is timed."""

import ast
import math
import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from commanding import PATIENCE_S, python
from given import BLOCK, FULL_SINE

from analytic import SinePulse
from analytic.response import Response
from studies.kit.executors import Local
from studies.kit.jobs import Job, summary
from studies.kit.pool import Pool
from studies.kit.runner import run_jobs
from studies.sources.registry import SOURCES, Source

pytestmark = pytest.mark.processes


def job(source, motion=FULL_SINE, **more):
    return Job(labels={}, block=BLOCK, motion=motion, source=source, **more)


def test_a_long_solve_has_a_time_limit_too():
    long = SinePulse(amplitude=0.34 * 9.81, omega=100.0, half_cycles=10**9)
    rows = run_jobs([job("rk4", long)], executor=Local(2, 0.5), reduce=summary)
    assert ["time limit" in row["message"] for row in rows] == [True]


def dies_soon():
    threading.Timer(0.2, os._exit, [3]).start()
    return os.getpid()


def test_a_process_that_ended_between_two_tasks_is_replaced():
    with Pool(1) as pool:
        first = pool.schedule(dies_soon, (), PATIENCE_S).result()
        while Path(f"/proc/{first}").exists():
            time.sleep(0.05)
        time.sleep(0.2)  # and whoever keeps it
        assert pool.schedule(os.getpid, (), PATIENCE_S).result() != first


ASKED = []


def remembers(block, motion, *, duration, times, step=1e-3):
    """Tell what this process was asked so far."""
    ASKED.append((motion.duration, duration, len(times), step))
    return Response.failure(repr(ASKED))


def test_a_long_solve_is_not_timed_while_its_kernels_are_loaded(monkeypatch):
    monkeypatch.setitem(SOURCES, "remembers", Source("solver", remembers))
    slow = SinePulse(amplitude=0.34 * 9.81, omega=1e-5, half_cycles=2)
    window = {"duration": slow.duration, "times": np.arange(100.0)}
    jobs = [job("remembers", slow, **window, options={"step": step}) for step in (1e-9, 1e-8)]
    assert all(asked.needs_process for asked in jobs)
    rows = run_jobs(jobs, executor=Local(1, PATIENCE_S), reduce=summary)
    first, second = (ast.literal_eval(row["message"]) for row in rows)
    # a short question once in each process, and then what was to be timed
    assert first[0][0] * BLOCK.p == pytest.approx(math.pi / 4.0)
    assert first[0][2:] == (3, 1e-3)
    assert first[1:] == [(slow.duration, slow.duration, 100, 1e-9)]
    assert second == [*first, (slow.duration, slow.duration, 100, 1e-8)]


KERNELS = """
import sys
import numpy as np
from analytic import Record, RigidBlock, SinePulse
from analytic.kernels.compiled import Kernel, compile_all
from studies.kit.jobs import Job, ask, short
from studies.sources.registry import resolve

def loaded():
    modules = [m for name, m in sys.modules.items() if name.startswith("analytic")]
    return {
        f"{f.__module__}.{f.__name__}": len(f.compiled.signatures)
        for m in modules for f in vars(m).values()
        if isinstance(f, Kernel) and f.compiled.signatures
    }

compile_all()

block = RigidBlock(width=0.5, height=1.5)
pulse = SinePulse(amplitude=0.36 * 9.81, omega=4.0, half_cycles=3)
record = Record(dt=0.01, samples=3.6 * np.sin(0.04 * np.arange(400)))
for name in ("exact", "modified", "rk4", "average-acceleration"):
    for motion in (pulse, record):
        for window in ({}, {"duration": motion.duration + 2.0, "times": np.linspace(0.0, 3.0, 50)}):
            job = Job(labels={}, block=block, motion=motion, source=name, **window)
            quick, source = short(job), resolve(name)
            assert not quick.needs_process
            assert ask(quick, source).outcome.value == "rocked"
            before = loaded()
            assert ask(job, source).outcome.value in ("rocked", "overturned")
            assert before == loaded() != {}, (name, motion, window)
"""


def test_a_short_question_loads_the_kernels_of_the_long_one():
    done = python("-c", KERNELS)
    assert (done.returncode, done.stderr) == (0, "")
