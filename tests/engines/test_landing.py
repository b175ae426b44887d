"""Steps that land on impacts: how near they bring an engine to the exact solution.

The bands are of 200 steps in 1/p: 1/200^2 = 2.5e-5, times a factor of order one for the paper's
cases, and of a case's conditioning elsewhere.
"""

import itertools
import math
from functools import cache

import numpy as np
import pytest
from declared import equal_to
from uses import CORE, HERE, agreed, error, errors_of_sweep, pulse, rocked

from analytic import Outcome, RigidBlock, conditioning, simulate
from engines import core_engines
from studies.cases.drawn import draw


def within(engine):
    """Return which cases of the sweep are asked of an engine, and its median and largest error."""
    roundings = equal_to(engine)
    return {
        "box2d": (96, 1e-5, 5e-4),  # a weak impact is landed to 1e-4 of its swing
        "drake": (120, 2e-4, 1e-3),  # some twenty thousand steps err by 2e-9 alpha each
        "newton": (118, 3e-3, 2e-2),  # of first order in the step
        "physx": (48, 1e-3, 6e-3),  # by the noise of a contact, a rounding of its place
        "rapier": (96, roundings / 6.0, 10.0 * roundings),  # by one at an impact
        "moreau": (96, 1e-4, 1e-3),
        **dict.fromkeys(core_engines(), (31, 1e-5, 2e-4)),
    }.get(engine, (96, 1e-5, 1e-4))


@cache
def some_errors(engine):
    every, _, _ = within(engine)
    return errors_of_sweep(engine, every)


@pytest.mark.parametrize("engine", HERE)
def test_some_of_the_sweep(engine):
    _, median, largest = within(engine)
    assert np.median(some_errors(engine)) < median
    assert max(some_errors(engine)) < largest


@pytest.fixture(params=CORE)
def engine(request):
    return str(request.param)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("accuracy", "median", "largest"),
    [("loose", 2e-4, 2e-3), ("standard", 1e-5, 2e-4), ("tight", 1e-6, 2e-5)],
)
def test_the_whole_sweep(engine, accuracy, median, largest):
    errors = errors_of_sweep(engine, every=1, accuracy=accuracy)
    assert np.median(errors) < median
    assert np.quantile(errors, 0.99) < 0.5 * largest
    assert max(errors) < largest


@pytest.mark.parametrize("number", [60, pytest.param(500, marks=pytest.mark.slow)])
def test_random_cases(engine, number):
    """The scheme's (p dt)^2 = 2.5e-5, amplified by the condition."""
    errors = []
    for case in itertools.islice(draw(2), number):
        exact, response = agreed(engine, case.motion, system=case.block)
        if exact.outcome is Outcome.ROCKED:
            missed = abs(response.peak_ratio / exact.peak_ratio - 1.0)
            errors.append(missed / max(abs(conditioning(case.block, case.motion)[0]), 1.0))
    assert len(errors) > number // 4
    assert np.median(errors) < 2.5e-6
    assert max(errors) < 2.5e-5


def test_second_order(engine):
    """Four times the steps, a sixteenth of the error, in the median over the full-sine cases."""
    coarse, fine = (
        np.median(errors_of_sweep(engine, every=23, step=1.0 / steps)) for steps in (50, 200)
    )
    assert 1.7 < math.log(coarse / fine, 4.0) < 2.3


def test_rest_and_uplift_again(engine):
    """The second half of a slow pulse lifts a block that the first half had left to rest."""
    block = RigidBlock(width=0.5, height=0.75)
    motion = pulse(1.03, 0.4, 2, block)
    exact, response = agreed(engine, motion, system=block)
    assert len(exact.uplifts) == 2
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=2e-5)
    # an uplift is told from the steps after it, a rest lacks the last of its bounces
    assert np.array(response.uplifts) == pytest.approx(np.array(exact.uplifts), abs=3e-3 / block.p)
    assert np.array(response.rests) == pytest.approx(np.array(exact.rests), abs=2e-2 / block.p)


FINER = {2.0: (1.6, 3.5, 2), 6.0: (3.0, 6.0, 2)}
ERRORS = [
    # a whole peak is some 1e-5 of alpha, and goes with the cube of an excess of 0.02, so that an
    # error of 2e-5 in anything is one of 3e-3 in the peak
    *((3.0, (1.02, omega, 1), {}, 3e-3) for omega in (0.5, 4.0, 12.0)),
    # 2e-4^2 = 4e-8, times a factor of order one
    *((aspect, shaken, {"step": 2e-4}, 1e-7) for aspect, shaken in FINER.items()),
    # with a friction that suffices, that of the sweep
    *((3.0, (1.3, 3.0, 2), {"friction": friction}, 1e-4) for friction in (0.7, 1.0001, 3.0)),
    # two corners share the weight by a solver that needs the more iterations
    *((aspect, (1.3, 3.0, 1), {}, 1e-4) for aspect in (20.0, 50.0)),
]
"""H/B, a pulse, what else is asked, and by how much the peak may be missed."""


@pytest.mark.parametrize(("aspect", "shaken", "asked", "most"), ERRORS)
def test_errors(engine, aspect, shaken, asked, most):
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    motion = pulse(*shaken, block)
    assert simulate(block, motion).friction_needed < asked.get("friction", math.inf)
    assert error(engine, motion, system=block, **asked) < most


@pytest.mark.parametrize("aspect", [3.0, 11.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_block_at_rest_does_not_lean_on_the_corner_that_carries_it(engine, aspect, sign):
    """A lean is the error of a peak after it, and those of 1e-3 alpha are wanted to 1e-5."""
    block = RigidBlock(width=1.0, height=aspect)
    motion = pulse(sign * 1.01, 3.0, 1, block)
    onset = math.asin(1.0 / 1.01) / motion.omega
    # a slender block in PyBullet takes some steps to settle
    times = list(np.linspace(0.2, 1.0, 200) * onset)
    response = rocked(engine, motion, system=block, times=times)
    leans = np.abs(response.history.theta) / block.alpha
    # long steps feel the load of the one before, and the more so the farther off the onset is
    assert leans.max() < 1e-7
    assert leans[100:].max() < 1e-8
