"""Interpreted or compiled, every kernel answers the same, to the bit."""

import math
import subprocess
import sys
from dataclasses import replace
from functools import partial
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
from analytic.kernels import forms
from analytic.steppers import METHODS
from studies.cases.drawn import draw
from studies.cases.paper import sweep_cases


@pytest.fixture
def both(monkeypatch):
    """Return what an action returns, in Python and compiled."""

    def in_both(action):
        answers = []
        for form in (forms.Kernel.python, forms.Kernel.compiled):
            monkeypatch.setattr(forms.Kernel, "few", lambda it, *_, form=form: partial(form, it))
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


AGAIN = """
import sys
from analytic import RigidBlock, SinePulse, simulate
from analytic.kernels import forms

block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=4.0, omega=6.0)
few = [simulate(block, pulse) for _ in range(forms.FEW_CASES)]
assert "numba" not in sys.modules
many = simulate(block, pulse)
assert "numba" in sys.modules
assert few[0].peak_ratio == many.peak_ratio and few[0].impacts == many.impacts
"""


def test_what_is_asked_again_and_again_is_compiled():
    done = subprocess.run([sys.executable, "-c", AGAIN], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_python_refuses_is_left_to_compiled_code():
    def quotient(x, y):
        return x / y

    kernel = forms.Kernel(quotient)
    assert kernel.python(1.0, 0.0) == math.inf
    assert kernel.python(np.float64(1.0), np.float64(0.0)) == math.inf


def test_how_many_and_how_long_decide(monkeypatch):
    kernel = forms.Kernel(abs)
    for cases, steps, form in ((1, 10, "python"), (10_000, 10, "compiled"), (1, 1e6, "compiled")):
        monkeypatch.setattr(forms.Kernel, "cases", 0)
        assert kernel.few(cases, steps) == getattr(kernel, form)
    forms.compile_all()
    assert kernel.few(1, 1) == kernel.compiled
