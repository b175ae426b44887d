"""Steps that land on impacts: how near they bring an engine to the exact solution.

The bands are of the default accuracy, 200 steps in 1/p, unless a test names another. The scheme is
of second order: 1/200^2 = 2.5e-5, times a factor that is of order one for the paper's cases and as
large as the conditioning of a case elsewhere.
"""

import itertools
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from uses import BLOCK, pulse

from analytic import simulate
from analytic.block import RigidBlock
from analytic.criteria import free_amplitude, quarter_period
from analytic.motion import SinePulse
from analytic.response import Outcome
from engines import FRAMES, Scene, core_engines
from engines.run.drive import run
from engines.scene import ACCURACIES


def sweep_cases():
    """Return the paper's 960 cases."""
    cases = []
    for (half_cycles, excess), aspect, width, k in itertools.product(
        ((1, 0.05), (1, 0.1), (2, 0.1), (2, 0.125)), (2, 3, 4), (0.5, 1.0), range(1, 41)
    ):
        block = RigidBlock(width=width, height=width * aspect)
        amplitude = (1.0 / aspect + excess) * block.gravity
        omega = 0.1 * k * block.p
        cases.append((block, SinePulse(amplitude=amplitude, omega=omega, half_cycles=half_cycles)))
    return cases


def random_cases(number):
    """Return random cases in which the pivot stays on the base, with their exact responses."""
    random = np.random.default_rng(2)
    cases = []
    while len(cases) < number:
        width = 0.02 * 500.0 ** random.uniform()
        block = RigidBlock(width=width, height=width * random.uniform(1.2, 12.0))
        motion = pulse(
            1.02 * (4.0 / 1.02) ** random.uniform(),
            0.3 * 40.0 ** random.uniform(),
            int(random.integers(1, 5)),
            block,
        )
        exact = simulate(block, motion)
        if exact.min_normal > 0.2:
            cases.append((block, motion, exact))
    return cases


def conditioning(block, motion, exact):
    """Return d ln theta_max / d ln a_p, at least 1."""
    more = simulate(block, replace(motion, amplitude=motion.amplitude * (1.0 + 1e-6)))
    return max(abs(math.log(more.peak_ratio / exact.peak_ratio)) / 1e-6, 1.0)


def errors_of_sweep(engine, every, **options):
    """Return the relative errors of the peaks of the survivors, outcomes having agreed."""
    errors = []
    for block, motion in sweep_cases()[every // 2 :: every]:
        exact = simulate(block, motion)
        response = run(engine, Scene(system=block, motion=motion, **options))
        assert response.outcome is exact.outcome, (block, motion, response.message)
        if exact.outcome is Outcome.ROCKED:
            errors.append(abs(response.peak_ratio / exact.peak_ratio - 1.0))
    return errors


@pytest.fixture(params=core_engines())
def engine(request):
    return str(request.param)


def test_some_of_the_sweep(engine):
    errors = errors_of_sweep(engine, every=31)
    assert np.median(errors) < 1e-5
    assert max(errors) < 2e-4


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


def compare_random_cases(engine, number):
    """Compare outcomes and peaks; an error in anything is amplified by the conditioning."""
    errors = []
    for block, motion, exact in random_cases(number):
        response = run(engine, Scene(system=block, motion=motion))
        assert response.outcome is exact.outcome, (block, motion, response.message)
        if exact.outcome is Outcome.ROCKED:
            error = abs(response.peak_ratio / exact.peak_ratio - 1.0)
            errors.append(error / conditioning(block, motion, exact))
    assert np.median(errors) < 1e-5
    assert max(errors) < 2e-4


def test_random_cases(engine):
    compare_random_cases(engine, 30)


@pytest.mark.slow
def test_many_random_cases(engine):
    compare_random_cases(engine, 500)


def test_second_order(engine):
    """Four times the steps, a sixteenth of the error, in the median over the full-sine cases."""
    coarse, fine = (
        np.median(errors_of_sweep(engine, every=23, step=1.0 / steps)) for steps in (50, 200)
    )
    assert 1.7 < math.log(coarse / fine, 4.0) < 2.3


@pytest.mark.parametrize(("aspect", "onsets", "omega_over_p"), [(2.0, 1.6, 3.5), (6.0, 3.0, 6.0)])
def test_steps_finer_by_far(engine, aspect, onsets, omega_over_p):
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    motion = pulse(onsets, omega_over_p, 2, block)
    found = run(engine, Scene(system=block, motion=motion, step=2e-4)).peak_ratio
    # 2e-4^2 = 4e-8, times a factor of order one
    assert found == pytest.approx(simulate(block, motion).peak_ratio, rel=1e-7)


@pytest.mark.parametrize("aspect", [1.5, 2.0, 3.0, 4.0, 6.0, 10.0])
def test_velocity_ratio_of_an_impact(engine, aspect):
    """Housner's ratio comes out of the engine's contact.

    The velocities are extrapolated over two steps of 1/200 by parabolas: 1e-4 at most.
    """
    block = RigidBlock(width=1.0, height=aspect)
    motion = pulse(1.4, 3.0, 1, block)
    response = run(engine, Scene(system=block, motion=motion, duration=6.0 / block.p))
    assert response.impacts[0].ratio == pytest.approx(block.restitution, abs=1e-4)


def test_velocity_ratio_of_small_swings(engine):
    """Swings below 1e-2 alpha lose what large ones lose: a corner that stays within the contact's
    reach between two of its impacts must not be drawn to where it stood."""
    block = RigidBlock(width=2.0, height=10.8)
    motion = pulse(1.027, 1.08, 4, block)
    response = run(engine, Scene(system=block, motion=motion))
    ratios = [impact.ratio for impact in response.impacts[:12]]
    assert response.peak_ratio < 1e-2
    assert ratios == pytest.approx([block.restitution] * 12, abs=5e-5)


def test_impacts_by_the_dozen(engine):
    """Twenty impacts: each adds to the time of the next some 1e-5/p."""
    motion = pulse(1.5, 2.0)
    duration = 12.0 / BLOCK.p
    exact = simulate(BLOCK, motion, duration=duration)
    response = run(engine, Scene(system=BLOCK, motion=motion, duration=duration))
    assert len(exact.impacts) > 20
    for seen, true in zip(response.impacts[:20], exact.impacts, strict=False):
        assert BLOCK.p * abs(seen.time - true.time) < 1e-3
        assert seen.velocity_before == pytest.approx(true.velocity_before, rel=1e-2)


def test_free_rocking(engine):
    """Between impacts n and n + 1 lie two quarter periods of the n-th free amplitude."""
    motion = pulse(1.5, 3.0)
    times = np.linspace(0.0, 8.0 / BLOCK.p, 4001)
    response = run(
        engine, Scene(system=BLOCK, motion=motion, duration=8.0 / BLOCK.p, times=list(times))
    )
    hits = [impact.time for impact in response.impacts if impact.time > motion.duration]
    first = np.abs(response.history.theta[(times > hits[0]) & (times < hits[1])]).max()
    for n, (begin, end) in enumerate(itertools.pairwise(hits[:5])):
        amplitude = free_amplitude(BLOCK, first, n)
        theta = response.history.theta[(times > begin) & (times < end)]
        assert np.abs(theta).max() == pytest.approx(amplitude, rel=1e-4)
        assert end - begin == pytest.approx(2.0 * quarter_period(BLOCK, amplitude), rel=1e-4)


def test_energy_never_grows(engine):
    """After the motion, each peak is lower than the one before."""
    motion = pulse(1.5, 3.0)
    duration = 12.0 / BLOCK.p
    times = list(np.linspace(motion.duration, duration, 3000))
    response = run(engine, Scene(system=BLOCK, motion=motion, duration=duration, times=times))
    theta, rate = np.abs(response.history.theta), response.history.velocity
    energy = (rate / BLOCK.p) ** 2 / 2.0 + np.cos(BLOCK.alpha - theta) - math.cos(BLOCK.alpha)
    assert len(response.impacts) > 15
    # in a step that holds an impact, a sampled velocity is neither the one before nor after
    assert np.diff(energy).max() < 1e-4 * energy[0]


def test_rest_and_uplift_again(engine):
    """The second half of a slow pulse lifts a block that the first half had left to rest."""
    block = RigidBlock(width=0.5, height=0.75)
    motion = pulse(1.03, 0.4, 2, block)
    exact = simulate(block, motion)
    response = run(engine, Scene(system=block, motion=motion))
    assert len(exact.uplifts) == 2
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=2e-5)
    # an uplift is told from the steps after it, a rest lacks the last of its bounces
    assert np.array(response.uplifts) == pytest.approx(np.array(exact.uplifts), abs=3e-3 / block.p)
    assert np.array(response.rests) == pytest.approx(np.array(exact.rests), abs=2e-2 / block.p)


def test_histories(engine):
    motion = pulse(1.3, 3.0, 2)
    times = [0.01 * i for i in range(300)]
    response = run(engine, Scene(system=BLOCK, motion=motion, duration=3.0, times=times))
    exact = simulate(BLOCK, motion, duration=3.0, times=times)
    assert response.history.theta == pytest.approx(exact.history.theta, abs=1e-4 * BLOCK.alpha)


@pytest.mark.parametrize("width", [0.5, 20.0])
def test_frames(engine, width):
    block = RigidBlock(width=width, height=3.0 * width)
    motion = pulse(1.3, 3.0, 2, block)
    base, world = (
        run(engine, Scene(system=block, motion=motion, frame=frame)).peak_ratio for frame in FRAMES
    )
    assert base == pytest.approx(world, rel=1e-6)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("aspect", [1.5, 3.0, 6.0])
def test_mirror(engine, aspect, frame):
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    motion = pulse(1.3, 3.0, 2, block)
    there, back = (
        run(
            engine, Scene(system=block, motion=replace(motion, amplitude=a), frame=frame)
        ).peak_ratio
        for a in (motion.amplitude, -motion.amplitude)
    )
    assert there == pytest.approx(back, rel=1e-9)


@pytest.mark.parametrize("friction", [0.7, 1.0001, 3.0])
def test_friction_that_suffices_is_as_good_as_any(engine, friction):
    motion = pulse(1.3, 3.0, 2)
    exact = simulate(BLOCK, motion)
    assert exact.friction_needed < friction
    response = run(engine, Scene(system=BLOCK, motion=motion, friction=friction))
    # the band of the sweep
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-4)


def test_size(engine):
    """theta/alpha depends on omega/p, a_p/g, alpha and the ratio at an impact alone."""
    peaks = []
    for width in (0.02, 20.0):
        block = RigidBlock(width=width, height=3.0 * width)
        motion = pulse(1.3, 3.0, 2, block)
        peaks.append(run(engine, Scene(system=block, motion=motion)).peak_ratio)
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-6)


@pytest.mark.parametrize("omega_over_p", [0.5, 4.0, 12.0])
def test_onset(engine, omega_over_p):
    """Also where the whole peak is some 1e-5 of alpha, and goes with the cube of an excess of
    0.02, so that an error of 2e-5 in anything is one of 3e-3 in the peak."""
    below = run(engine, Scene(system=BLOCK, motion=pulse(0.95, omega_over_p)))
    above = run(engine, Scene(system=BLOCK, motion=pulse(1.02, omega_over_p)))
    exact = simulate(BLOCK, pulse(1.02, omega_over_p))
    assert (below.outcome, below.peak_ratio) == (Outcome.AT_REST, 0.0)
    assert above.peak_ratio == pytest.approx(exact.peak_ratio, rel=3e-3)


@pytest.mark.slow
def test_a_minute_of_rest(engine):
    times = [1.0, 59.0]
    motion = pulse(0.5, 1.0)
    response = run(engine, Scene(system=BLOCK, motion=motion, duration=60.0, times=times))
    assert response.outcome is Outcome.AT_REST
    assert np.abs(response.history.theta).max() < 1e-9
    assert response.slip_m < 1e-9


def test_accuracies(engine):
    """Loose costs a quarter of the standard, tight four times as much."""
    motion = pulse(1.3, 3.0, 2)
    exact = simulate(BLOCK, motion).peak_ratio
    loose, standard, tight = (
        run(engine, Scene(system=BLOCK, motion=motion, accuracy=accuracy))
        for accuracy in ACCURACIES
    )
    assert 3.0 * loose.steps < standard.steps < tight.steps / 3.0
    assert loose.peak_ratio == pytest.approx(exact, rel=2e-4)
    assert tight.peak_ratio == pytest.approx(exact, rel=2e-6)


def test_processes_agree_bit_by_bit(engine):
    motion = pulse(1.3, 3.0, 2)
    script = (
        "from analytic.block import RigidBlock\n"
        "from analytic.motion import SinePulse\n"
        "from engines import Scene\n"
        "from engines.run.drive import run\n"
        f"block, motion = {BLOCK!r}, {motion!r}\n"
        f"print(run({engine!r}, Scene(system=block, motion=motion)).peak_ratio.hex())\n"
    )
    there = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    here = run(engine, Scene(system=BLOCK, motion=motion))
    assert there.stdout.decode().strip() == here.peak_ratio.hex()


def test_a_base_without_velocity_is_noticed(engine, monkeypatch):
    """Where only the base's position moves, friction feels nothing and the block slides."""
    from engines.pybullet import build as bullet

    if engine == "pybullet":
        monkeypatch.setattr(bullet.BulletWorld, "_move_base", lambda self, step: None)
    settings = {"floor": "position"}
    asked = Scene(system=BLOCK, motion=pulse(1.5, 1.0), frame="world", settings=settings)
    response = run(engine, asked)
    assert response.outcome is not Outcome.ROCKED
    assert response.outcome is not Outcome.OVERTURNED


def test_out_of_the_plane(engine):
    """Four corners in space, free to leave the plane, move as two corners in the plane."""
    motion = pulse(1.3, 3.0, 2)
    plane = run(engine, Scene(system=BLOCK, motion=motion))
    space = run(engine, Scene(system=BLOCK, motion=motion, settings={"planar": False}))
    assert space.peak_ratio == pytest.approx(plane.peak_ratio, rel=2e-4)


@pytest.mark.parametrize("aspect", [20.0, 50.0])
def test_slender_blocks(engine, aspect):
    """Their two corners share the weight by a solver that needs the more iterations."""
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    motion = pulse(1.3, 3.0, 1, block)
    response = run(engine, Scene(system=block, motion=motion))
    exact = simulate(block, motion)
    assert response.outcome is exact.outcome is Outcome.ROCKED
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-4)


@pytest.mark.parametrize("aspect", [3.0, 11.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_block_at_rest_does_not_lean_on_the_corner_that_carries_it(engine, aspect, sign):
    """Not even where one corner is about to carry all of it: a lean is the error of a peak after
    it, and peaks of 1e-3 alpha are wanted to the 1e-5 of the scheme."""
    block = RigidBlock(width=1.0, height=aspect)
    motion = pulse(sign * 1.01, 3.0, 1, block)
    onset = math.asin(1.0 / 1.01) / motion.omega
    # a slender block in PyBullet takes some steps to settle
    times = list(np.linspace(0.2, 1.0, 200) * onset)
    response = run(engine, Scene(system=block, motion=motion, times=times))
    leans = np.abs(response.history.theta) / block.alpha
    # long steps feel the load of the one before, and the more so the farther off the onset is
    assert leans.max() < 1e-7
    assert leans[100:].max() < 1e-8
