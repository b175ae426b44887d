"""Kernels answer alike compiled and interpreted, and are kept with their own sources alone."""

import errno
import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from given import all_but_times, onset_of
from numba.core import caching

from analytic import MODELS, Record, Still, integrate, overturning_modes, peak_ratios, simulate
from analytic.conditioning import condition_numbers, conditioning, sensitivity
from analytic.kernels import forms, kept
from analytic.steppers import METHODS
from studies.cases.drawn import draw
from studies.cases.paper import sweep_cases


def bits(numbers):
    """Return numbers as bytes: nan equals itself, and 0 differs from -0."""
    return np.asarray(numbers, dtype=np.float64).tobytes()


def some_cases(seed, count):
    """Yield blocks, motions and starts, of every kind that there is."""
    generator = np.random.default_rng(seed)
    for number, case in enumerate(islice(draw(seed), count)):
        block, restitution = case.block, (0.0, 0.5, 0.9, 1.0)[number // 3 % 4]
        if number % 3 == 0:
            block = replace(block, restitution=restitution)
        samples = onset_of(block) * generator.normal(size=10 + 5 * number)
        record = Record(dt=float(generator.uniform(0.005, 0.05)), samples=samples)
        turned = replace(case.motion, phase=float(generator.uniform(0.0, 6.0)))
        motion = (case.motion, turned, record, Still())[number % 4]
        tilt, rate = generator.uniform(-1.2, 1.2), (number % 2) * generator.normal() * block.p
        still = number % 4 < 2 and number % 5 > 0
        yield block, motion, (0.0, 0.0) if still else (tilt * block.alpha, rate * block.alpha)


def answers(model):
    """Yield what every kernel says of random cases of every kind, and of some of the paper's."""
    cases = [(case.block, case.motion, (0.0, 0.0)) for case in [*sweep_cases([6, 7, 8, 9])][::16]]
    for number, (block, motion, start) in enumerate([*cases, *some_cases(35, 60)]):
        sampled = motion.duration and number % 5 == 0
        yield all_but_times(
            simulate(
                block,
                motion,
                model,
                start,
                duration=motion.duration + 3.0 / block.p if number % 2 else None,
                times=np.linspace(0.0, motion.duration, 9) if sampled else None,
                tolerance=1e-9 if number % 7 == 0 else 1e-16,
            )
        )
    for block, motion, start in some_cases(36, 12):
        for method in METHODS:
            asked = {"method": method, "step": 0.02, "times": np.linspace(0.0, 1.0, 9)}
            yield all_but_times(integrate(block, motion, model, start, **asked))
        yield bits(conditioning(block, motion, model, start))
        yield bits(sensitivity(block, motion, model, start))
    generator = np.random.default_rng(38)
    alpha = generator.uniform(0.05, 0.9, 40)
    amplitude = np.tan(alpha) * 10.0 ** generator.uniform(-0.1, 1.0, 40)
    omega = 10.0 ** generator.uniform(-1.0, 1.3, 40)
    cases = (alpha, amplitude, omega, generator.integers(1, 6, 40), model)
    peaks, outcomes = peak_ratios(*cases)
    modes = overturning_modes(*cases)
    yield modes.mode.tolist(), modes.steps.tolist(), outcomes.tolist()
    yield from map(bits, (peaks, modes.margin, condition_numbers(*cases)))


@pytest.mark.parametrize("model", MODELS)
def test_answers_are_the_same(model, monkeypatch):
    given = []
    for form in (forms.Kernel.python, forms.Kernel.compiled):
        monkeypatch.setattr(forms.Kernel, "few", lambda it, *_, form=form: partial(form, it))
        given.append(list(answers(model)))
    assert given[0] == given[1]


AGAIN = """
import signal, sys
from contextlib import suppress
from analytic import RigidBlock, SinePulse, simulate
from analytic.kernels import forms

block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=4.0, omega=6.0)
few = [simulate(block, pulse) for _ in range(forms.FEW_CASES)]
assert "numba" not in sys.modules
many = simulate(block, pulse)
assert "numba" in sys.modules
assert few[0].peak_ratio == many.peak_ratio and few[0].impacts == many.impacts
signal.signal(signal.SIGALRM, signal.default_int_handler)
for number in range(100):  # interrupted anywhere, it is never made to crash
    with suppress(KeyboardInterrupt):
        signal.setitimer(signal.ITIMER_REAL, 1e-3 + 1e-5 * number)
        for _ in range(1000):
            simulate(block, pulse)
"""


def test_what_is_asked_again_and_again_is_compiled():
    done = subprocess.run([sys.executable, "-c", AGAIN], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_python_refuses_is_left_to_compiled_code():
    assert forms.Kernel(lambda x, y: x / y).python(1.0, 0.0) == math.inf


KERNELS = {
    "__init__.py": "",
    "inner/__init__.py": "",
    "kernels/__init__.py": "",
    "inner/law.py": """
def law(x):
    return x + 1.0
""",
    "steps.py": """
from analytic.kernels.forms import Kernel
from analytic.inner.law import law

def steps(x):
    return 10.0 * law(x)

STEPS = Kernel(steps)
""",
}
PLACES = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME", "TMPDIR")
PROGRAM = """
from analytic.steps import STEPS
from analytic.kernels import forms, kept
value = STEPS.compiled(1.0)
hits = sum(STEPS._compiled.stats.cache_hits.values())
print(value, hits, kept.kept_in(forms.SOURCES))
"""


@pytest.fixture
def package(tmp_path):
    """A package of two kernels, the one in need of the other."""
    for name, text in KERNELS.items():
        path = tmp_path / "package" / "analytic" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for module in (forms, kept):
        shutil.copy(module.__file__, tmp_path / "package" / "analytic" / "kernels")
    return tmp_path / "package"


def asked(package, **variables):
    """Return the kernel's answer, whether it was read from disk, and from where."""
    inherited = {k: v for k, v in os.environ.items() if k not in PLACES}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**inherited, **variables},
        cwd=package,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    value, hits, folder = done.stdout.split(maxsplit=2)
    return float(value), bool(int(hits)), Path(folder.strip())


@pytest.mark.parametrize("chosen", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_kernel_is_never_older_than_what_it_calls(chosen, package, tmp_path):
    kept = tmp_path / "chosen" if chosen else package / "analytic" / "__pycache__"
    variables = {"NUMBA_CACHE_DIR": str(kept)} if chosen else {}
    first, again = asked(package, **variables), asked(package, **variables)
    assert (first, again) == ((20.0, False, first[2]), (20.0, True, first[2]))
    assert first[2].parent == kept
    law = package / "analytic" / "inner" / "law.py"
    law.write_text(law.read_text().replace("1.0", "2.0"))
    edited = asked(package, **variables)
    assert edited == (30.0, False, edited[2])
    # the package's own folder does not fill up; others may be shared
    assert first[2].exists() == chosen


def test_kernels_run_where_nothing_can_be_written(package, tmp_path):
    (package / "analytic" / "__pycache__").write_text("")
    closed = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "NUMBA_CACHE_DIR": "/dev/null"}
    value, _, folder = asked(package, **closed, TMPDIR=str(tmp_path))
    assert (value, folder.parent) == (20.0, tmp_path / f"rocking-{os.getuid()}")
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    folder.parent.chmod(0o777)
    value, hit, folder = asked(package, **closed, TMPDIR=str(tmp_path))
    assert (value, hit, str(folder)) == (20.0, False, "None")


def half(x):
    return 0.5 * x


def test_a_kernel_runs_where_the_disk_is_full(monkeypatch):
    def save(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", save)
    kernel = forms.Kernel(half)
    assert [kernel.compiled(2.0), kernel.compiled(3.0)] == [1.0, 1.5]


def test_who_waits_is_told_once_and_only_where_something_is_compiled(monkeypatch, tmp_path):
    told = []
    monkeypatch.setattr(forms, "kept_in", lambda _: tmp_path)
    for count in (1, 0):
        monkeypatch.setattr(forms.Kernel, "tell", told.append)
        assert forms.Kernel(half).compiled(2.0) == 1.0
        assert len(told) == count
        told.clear()
