"""Traps that libraries set without a word, beside `engines.troubles`; what stays after a run."""

from concurrent.futures import ThreadPoolExecutor
from itertools import chain, islice

import numpy as np
import pytest
from declared import run
from given import all_but_times
from uses import BLOCK, HERE, error, pulse, rocked, scene, take_a_step

from analytic import RigidBlock, SinePulse, Still
from analytic.response import Outcome, Reason
from engines import drake
from engines.declaration import AT_REST
from engines.parts import NO_JAM, imported
from engines.run.run import build
from studies.cases.drawn import draw
from studies.cases.extreme import extremes

SLENDER = RigidBlock(width=0.5, height=5.5)
SQUAT = RigidBlock(width=1.0, height=1.5)
THIN = RigidBlock(width=1.0, height=10.0)
DRAWN = next(islice(draw(1), 77, None))
LARGE = RigidBlock(width=30.0, height=90.0)
SOFT = {"frequency": 30.0, "damping_ratio": 10.0, "correction": None}
OWN_STEPS = "error-controlled"
SMALL_BALLS = {"corner_radius": 1e-7}


def of(block, *shaken, **options):
    """Return what is asked of a block under a pulse."""
    return {"motion": pulse(*shaken, block), "system": block, **options}


LONG = "a corrected depth spoils short steps"
TRAPS = {
    # on two corners of H/B = 11 each iteration takes some 6 % off an impulse's error
    "a slender block takes more iterations": (
        *("box2d", of(SLENDER, 1.5, 5.8, 1), 1e-5, {"iterations": 100}, 1e-3),
    ),
    # between its impacts the block rises by a few roundings of its height
    "small swings are seen near the origin": (
        *("box2d", of(SLENDER, 1.5, 5.8, 3), 5e-5, {"centred": False}, 1e-4),
    ),
    # set by its mass alone, a block keeps the moments of inertia of 1 kg m2 and hardly rocks
    "a mass brings no inertia": (
        *("dart", {"preset": "default"}, 0.3, {"exact_inertia": False}, 0.8),
    ),
    # in metres a pivot is pushed out of its margin at up to 1 mm/s, in 1e-5 m at 1e-8 m/s
    "corrections go by the unit of length": (
        *("dart", {"settings": {"unit": 1e5}}, 1e-4, {"unit": 1.0}, 1e-3),
    ),
    # CENIC's own are 1e-3 m or rad a step, whatever the size: a block may go through its base
    "smaller errors of a step make smaller errors": (
        *("drake", {"preset": OWN_STEPS, "settings": {"accuracy": 1e-6}}, 1e-2),
        *({"accuracy": 1e-3 / BLOCK.alpha}, 0.05),
    ),
    # 1e6 N/m, whatever stands on it: a light block errs little, a heavy one sinks in
    "a contact is as stiff under a heavier block": (
        *("drake", {"preset": AT_REST, "density": 10.0}, 0.02, {"density": 1000.0}, 0.05),
    ),
    # it goes by the normal force at the beginning of a step, of which dissipation makes much or
    # nothing; more friction does not hide that
    "friction lags behind what dissipates": (
        *("drake", {"preset": "tuned"}, 5e-3, {"dissipation": 1e4, "friction": NO_JAM}, 0.05),
    ),
    # the library's own hundredth of it in a step is a velocity that grows as the step shrinks
    LONG: (
        *("newton", of(SQUAT, 1.5, 3.0, 1, preset="tuned", duration=1.0, step=2.5e-4), 1e-3),
        *({"baumgarte": 0.01}, 0.5),
    ),
    # two corners then correct twice what one would: weighting is what the library does itself
    "corrections without weights are made by each corner": (
        *("newton", {"preset": "default"}, 0.01, {"weighting": False}, 0.02),
    ),
    # the more of it the shorter the step
    "a depth that is corrected at once is noise": (
        *("physx", {"preset": "tuned", "step": 2.5e-4}, 2e-3),
        *({"depenetration": None, "contact_offset": None}, 6e-3),
    ),
    "it iterates as slender blocks need": (
        *("pymunk", of(THIN, 1.3, 3.0, 2, accuracy="loose"), 1e-3, {"iterations": 20}, 1e-2),
    ),
    # the pivot slides by inches, and the block overturns or leaves the problem
    "contacts that are recycled let the pivot go": ("rapier", {}, 1e-3, {"recycling": True}, 1.0),
    "stabilization takes velocities out again": ("rapier", {}, 1e-3, {"stabilization": 1}, 1e-2),
    "the library's own contact is a spring of 30 Hz": ("rapier", {}, 1e-3, SOFT, 1e-2),
    # it has no normal there: the block falls freely for a step, now and then
    "a ball whose centre rounds onto a deep base loses its contact": (
        *("rapier", {"motion": DRAWN.motion, "system": DRAWN.block, "settings": SMALL_BALLS}, 1e-3),
        *({**SMALL_BALLS, "base_depth": 1.0}, 3e-2),
    ),
    "in metres the corners of a large block are rounded by its size": (
        *("rapier", of(LARGE, 1.3, 3.0, 2), 1e-3, {"units": None, "centred": False}, 1e-2),
    ),
}
"""Engine, scene, error at most, what is set otherwise, and its error at least then."""


EACH = [
    pytest.param(name, marks=[pytest.mark.slow] * (name == LONG))
    for name, row in TRAPS.items()
    if row[0] in HERE
]


@pytest.mark.parametrize("trap", EACH)
def test_what_an_engine_sets_spares_it_an_error(trap):
    engine, asked, most, changed, least = TRAPS[trap]
    assert error(engine, **asked) < most
    otherwise = changed if "density" in changed else {"settings": changed}
    assert not error(engine, **{**asked, **otherwise}) < least  # nan where the block is lost


def test_friction_that_has_no_mass_is_left_to_another_solver():
    """Nothing moves a planar block aside: its response has no mirror image unless the base can."""
    pytest.importorskip("dartpy")
    for settings, mirrored in (({}, True), ({"aside": False}, False)):
        there, back = (
            rocked("dart", pulse(onsets, 3.0, 2), settings=settings).peak_ratio
            for onsets in (1.3, -1.3)
        )
        apart = abs(there / back - 1.0)
        assert apart < 1e-12 if mirrored else apart > 1e-5


def test_what_drake_gives_up_on_ends_the_run_and_not_the_process(monkeypatch):
    """A condition of its own that does not hold is no error in Python but the end of it."""
    pytest.importorskip("pydrake")
    monkeypatch.setattr(drake, "mean_velocity_of", lambda _: lambda begin, end: float("nan"))
    response = rocked("drake", preset=OWN_STEPS)
    assert response.reason is Reason.FAULT
    assert "condition" in response.message
    assert "\n" not in response.message


def test_a_recorded_step_of_newton_has_its_length_for_good():
    """Another one would be taken as if it were as long as the one that was recorded."""
    pytest.importorskip("newton")
    world = build(HERE["newton"].use(scene()))
    step = take_a_step(world, scene(), "newton")
    assert not world.fault()
    world.step(step._replace(dt_s=2.0 * step.dt_s))
    assert world.fault() == "its steps are recorded, and all of one length"
    world.close()


def test_physx_reads_back_what_is_set_for_all_and_what_is_not():
    physx = imported("sapien").physx if "physx" in HERE else pytest.skip("sapien is not installed")
    asked = {"preset": "tuned", "settings": {"bounce_threshold": 0.01, "units": None}}
    for options, threshold, sleep in (({"preset": "default"}, 2.0, 0.005), (asked, 0.01, 0.0)):
        world = build(HERE["physx"].use(scene(**options)))
        assert world.fault() == ""
        world.close()
        body = physx.PhysxRigidDynamicComponent()
        assert physx.PhysxCpuSystem().config.bounce_threshold == pytest.approx(threshold)
        assert body.sleep_threshold == pytest.approx(sleep)


def test_corners_jam_from_four_thirds_on():
    """Painlevé: a push N at (x, z), with drag mu N, lifts the corner by 1/m + x^2/I - mu x z/I."""
    tilt = np.linspace(1e-3, 0.5 * np.pi - 1e-3, 100_001)
    x, z = np.cos(tilt), np.sin(tilt)
    jamming = (1.0 + 3.0 * x**2) / (3.0 * x * z)
    assert jamming.min() == pytest.approx(4.0 / 3.0, rel=1e-8)
    assert jamming.min() > NO_JAM


def test_a_block_that_sleeps_is_at_rest_on_its_base_and_has_no_answer_aloft():
    """A slender block is slow enough at the turn of its swing to be put to sleep there."""
    pytest.importorskip("rapier3d")
    weak = pulse(0.9, 3.0)
    rested = rocked("rapier", weak, preset="default", duration=3.0, times=(3.0,))
    assert rested.outcome is Outcome.AT_REST
    assert 0.0 < abs(rested.history.theta[-1]) < 1e-3 * BLOCK.alpha
    case = next(case for case in extremes(False) if case.name == "H/B 50")
    asked = {"system": case.block, "duration": case.duration}
    slept = rocked("rapier", case.motion, preset="default", **asked)
    assert slept.outcome is Outcome.FAILED
    assert "to sleep aloft" in slept.message


def test_swings_that_rounding_hides_are_left_to_the_contacts():
    """Below 1e-6 of the height a swing cannot be told from rest, and need not be followed."""
    pytest.importorskip("rapier3d")
    start = (1e-3 * BLOCK.alpha, 0.0)
    assert rocked("rapier", Still(), start=start, duration=8.0 / BLOCK.p).steps < 10_000


@pytest.fixture
def bullet(monkeypatch):
    """PyBullet's adapter, no client of which is left."""
    pytest.importorskip("pybullet")
    from engines.pybullet import build as adapter

    monkeypatch.setattr(adapter, "idle", [])
    return adapter


def answer(number):
    """Return the answer to a scene in which contacts are kept up to a gap of its own."""
    block = RigidBlock(width=0.2 + 0.1 * number, height=1.5)
    asked = scene(pulse(1.3, 3.0, 1, block), system=block, accuracy="loose")
    return all_but_times(run("pybullet", asked))


@pytest.mark.usefixtures("bullet")
def test_threads_do_not_disturb_each_other():
    """PyBullet holds that gap for the whole process, and looks at it when two bodies meet first."""
    alone = [answer(number) for number in range(6)]
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(answer, 4 * list(range(6)))) == 4 * alone


@pytest.mark.parametrize("wanted", [{"start": (0.5 * BLOCK.alpha, 0.0), "preset": "default"}, {}])
def test_nothing_stays_of_any_setting(wanted, bullet):
    """A run in a client that others have used, or in which one failed, is that of a new one."""

    def answered():
        return all_but_times(rocked("pybullet", pulse(1.35, 4.0), **wanted))

    first = answered()
    lost = rocked("pybullet", SinePulse(amplitude=1e30, omega=1.0), preset="tuned")
    assert lost.outcome is Outcome.FAILED
    for level in chain.from_iterable(factor.levels for factor in HERE["pybullet"].factors):
        for preset in level.presets:
            few = {"preset": preset, "settings": level.settings, "max_steps": 30}
            rocked("pybullet", pulse(1.35, 4.0), **few, **level.scene)
        assert len(bullet.idle) == 1
        assert answered() == first, level.name
