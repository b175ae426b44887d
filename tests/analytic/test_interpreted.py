"""Interpreted or compiled, every kernel answers the same, to the bit."""

import math
import subprocess
import sys
from dataclasses import replace
from itertools import islice, product

import numpy as np
import pytest
from given import all_but_times, onset_of

from analytic import (
    MODELS,
    Record,
    Still,
    condition_numbers,
    conditioning,
    integrate,
    overturning_modes,
    peak_ratios,
    sensitivity,
    simulate,
)
from analytic.kernels import compiled
from analytic.steppers import METHODS
from studies.cases.drawn import draw
from studies.cases.paper import sweep_cases


@pytest.fixture
def purse(monkeypatch):
    """Let every kernel be interpreted, or none, whatever was before."""

    def use(interpret):
        monkeypatch.setattr(compiled.Purse, "shut", not interpret)
        monkeypatch.setattr(compiled.Purse, "open", property(lambda _: interpret))
        monkeypatch.setattr(compiled.Purse, "spend", lambda _: None)

    return use


@pytest.fixture
def both(monkeypatch, purse):
    """Return what an action returns, interpreted and compiled."""

    def interpret(kernel, *arguments):
        with compiled.interpreting(compiled.Purse(compiled.SOURCES, 10**9, 0)):
            return kernel.py_func(*arguments)

    def in_both(action):
        answers = []
        for form in (interpret, compiled.Kernel.run):
            purse(form is interpret)
            # what was compiled once is compiled from then on, but not here
            monkeypatch.setattr(compiled.Kernel, "__call__", form)
            answers.append(action())
        return answers

    return in_both


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


def responses(model):
    """In the paper's grid, one case in 8, and in random cases of every kind."""
    cases = [(case.block, case.motion, (0.0, 0.0)) for case in [*sweep_cases([6, 7, 8, 9])][::8]]
    cases += some_cases(35, 60)
    for number, (block, motion, start) in enumerate(cases):
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


def solved(model):
    times, cases = np.linspace(0.0, 1.0, 9), list(some_cases(36, 12))
    for method in METHODS:
        for block, motion, start in cases:
            asked = {"method": method, "step": 0.02, "times": times}
            yield all_but_times(integrate(block, motion, model, start, **asked))


def moved(model):
    for block, motion, start in some_cases(37, 25):
        yield bits(conditioning(block, motion, model, start))
        yield bits(sensitivity(block, motion, model, start))


def arrays(model):
    generator = np.random.default_rng(38)
    alpha = generator.uniform(0.05, 0.9, 40)
    amplitude = np.tan(alpha) * 10.0 ** generator.uniform(-0.1, 1.0, 40)
    omega = 10.0 ** generator.uniform(-1.0, 1.3, 40)
    cases = (alpha, amplitude, omega, generator.integers(1, 6, 40), model)
    peaks, outcomes = peak_ratios(*cases)
    modes = overturning_modes(*cases)
    yield modes.mode.tolist(), modes.steps.tolist(), outcomes.tolist()
    yield from map(bits, (peaks, modes.margin, condition_numbers(*cases)))


@pytest.mark.parametrize(
    ("answers", "model"),
    [
        *product((responses, arrays), MODELS),
        *product((solved, moved), ("exact", "modified")),
    ],
)
def test_answers_are_the_same(answers, model, both):
    interpreted, once_compiled = both(lambda: list(answers(model)))
    assert interpreted == once_compiled


SPENDING = """
import sys
import numpy as np
from analytic import Record, RigidBlock, simulate
from analytic.kernels import compiled
from analytic.steppers import METHODS

block = RigidBlock(width=0.5, height=1.5)
record = Record(dt=0.01, samples=4.0 * np.sin(0.3 * np.arange(300)))
few = simulate(block, record)
assert "numba" not in sys.modules
for _ in range(200):
    many = simulate(block, record)
    if "numba" in sys.modules:
        break
else:
    raise SystemExit("nothing was compiled")
again = simulate(block, record)
assert few.peak_ratio == many.peak_ratio == again.peak_ratio and few.impacts == again.impacts
print(few.steps)
"""


def test_what_is_asked_again_and_again_is_compiled():
    """A case of some 300 steps uses up the steps that are interpreted in some dozens of calls."""
    done = subprocess.run([sys.executable, "-c", SPENDING], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) >= 300


def test_what_python_refuses_is_left_to_compiled_code(purse):
    purse(True)

    @compiled.kernel
    def quotient(x, y):
        return x / y

    assert quotient(1.0, 0.0) == math.inf
    assert quotient(np.float64(1.0), np.float64(0.0)) == math.inf


def test_few_cases_are_interpreted_and_many_are_not():
    kernel = compiled.Kernel(abs, compiled.SOURCES, None)
    assert compiled.form_for(1, kernel) is kernel
    assert compiled.form_for(10_000, kernel) == kernel.run
