"""Newton: what it keeps from run to run on the CPU, and the traps that it sets without a word."""

import time
from dataclasses import replace
from functools import partial

import pytest
from uses import BLOCK, HERE, SHAKEN, error, pulse, rocked, scene

from analytic import simulate
from analytic.block import RigidBlock
from analytic.response import Outcome, Reason, Response
from engines import ENGINES
from engines.declaration import AT_REST, Stepping
from engines.newton import models as newton_models
from engines.registry import VARIANTS
from engines.run.drive import build, run
from engines.run.monitor import Monitor
from studies.cases.variants import variants
from studies.kit.executors import Local
from studies.kit.jobs import Job
from studies.sources.registry import SOURCES

installed = pytest.mark.skipif("newton" not in HERE, reason="newton is not installed")


@installed
def test_a_corrected_depth_spoils_short_steps():
    """The library's own hundredth of it in a step is a velocity that grows as the step shrinks."""
    block = RigidBlock(width=1.0, height=1.5)
    motion = pulse(1.5, 3.0, 1, block)
    asked = {"system": block, "preset": "fixed", "duration": 1.0, "step": 2.5e-4}
    assert error("newton", motion, **asked) < 1e-3
    corrected = rocked("newton", motion, **asked, settings={"baumgarte": 0.01})
    assert corrected.peak_ratio < 0.5 * simulate(block, motion).peak_ratio


@installed
@pytest.mark.parametrize("solver", ["xpbd", "padmm", "dvi"])
def test_the_base_is_felt_by_each_solver(solver):
    """Below g tan(alpha) nothing lifts, and above it something does."""
    iterations = None if solver == "dvi" else 50
    settings = {"solver": solver, "iterations": iterations}
    for ratio, outcome in ((0.95, Outcome.AT_REST), (1.05, Outcome.ROCKED)):
        response = rocked("newton", pulse(ratio, 1.0), preset="fixed", settings=settings)
        assert response.outcome is outcome


@installed
def test_corrections_without_weights_are_made_by_each_corner():
    """Two corners then correct twice what one would: weighting is what the library does itself."""
    alone = {"weighting": False}
    assert error("newton", preset="naive", settings=alone) > 5.0 * error("newton", preset="naive")


@installed
def test_a_recorded_step_has_its_length_for_good():
    """Another one would be taken as if it were as long as the one that was recorded."""
    motion = scene()
    world = build(HERE["newton"], motion)
    monitor = Monitor(motion, world._dt, Stepping.FIXED)
    monitor.make_room(1)
    step = monitor.next(world.state())
    world.step(step)
    assert not world.fault()
    world.step(step._replace(dt_s=2.0 * step.dt_s))
    assert world.fault() == "its steps are recorded, and all of one length"
    world.close()


@installed
def test_a_trial_step_leaves_no_trace():
    """A step is tried so that it compiles: the block then sets out from where it should."""
    start = (0.4 * BLOCK.alpha, 0.2 * BLOCK.p * BLOCK.alpha)
    asked = scene(start=start)
    world = build(HERE["newton"], asked)
    begin = asked.bodies[0].at
    assert world.state()[0] == pytest.approx((begin.x, begin.z, begin.theta, begin.rate), rel=1e-6)
    world.close()


@installed
@pytest.mark.parametrize("solver", ["xpbd", "dvi"])
def test_a_model_is_as_good_as_new_for_the_next_run(solver):
    """Making it takes as long as hundreds of steps; what a solver remembers would show."""
    asked = scene(preset="fixed", settings={"solver": solver})
    other = replace(asked, motion=pulse(1.6, 2.0, 1), start=(0.4 * BLOCK.alpha, 0.0))
    newton_models.idle.clear()
    first = run("newton", asked)
    [made] = newton_models.idle
    run("newton", other)
    again = run("newton", asked)
    assert list(newton_models.idle) == [made]
    assert (first.peak_ratio, first.impacts) == (again.peak_ratio, again.impacts)


@installed
def test_two_runs_at_once_have_a_model_each():
    first, second = (build(HERE["newton"], scene()) for _ in range(2))
    before = second.state()
    monitor = Monitor(scene(), HERE["newton"].best.ordinary_step_s(scene()), Stepping.FIXED)
    monitor.make_room(1)
    first.step(monitor.next(first.state()))
    assert first.state() != before
    assert second.state() == before
    for world in (first, second):
        world.close()


@installed
def test_naive_and_the_same_at_rest_are_near_the_exact_peak():
    assert error("newton", preset="naive") < 0.15
    assert error("newton", preset=AT_REST) < 0.15


@installed
def test_what_naive_leaves_is_what_the_library_does_itself():
    import newton

    world = build(HERE["newton"], scene(preset="naive"))
    solver, bare = world._recorded._solver, newton.solvers.SolverXPBD(world._recorded.model)
    for name in (
        *("iterations", "rigid_contact_relaxation", "rigid_contact_con_weighting"),
        *("angular_damping", "enable_restitution"),
    ):
        assert getattr(solver, name) == getattr(bare, name)
    assert (bare.iterations, bare.angular_damping) == (2, 0.0)
    assert newton.ModelBuilder.ShapeConfig().mu == ENGINES["newton"].presets[0].settings.friction
    world.close()


def slow_at_first(marker, job, source):
    """Take longer than the time limit where nothing was compiled yet."""
    if not marker.exists():
        time.sleep(4.0)
        marker.touch()
    return Response.failure("compiled")


def test_what_compiles_itself_does_so_outside_the_time_limit(tmp_path, monkeypatch):
    job = Job(labels={}, block=BLOCK, motion=SHAKEN, source="newton")
    ask = partial(slow_at_first, tmp_path / "compiled")
    engine = replace(ENGINES["newton"], library="numpy")
    monkeypatch.setattr("engines.registry._declared", lambda name, place: engine)
    assert [r.message for _, r in Local(1, 3.0, ask)([job])] == ["compiled"]


OTHERS = [name for name in VARIANTS if name.startswith("newton-")]
"""Its other solvers, each an engine that no list names."""


def has_warp(name):
    return name != "newton-mujoco" or ENGINES["warp"].installed


@installed
@pytest.mark.parametrize("name", OTHERS)
def test_another_solver_holds_the_block(name):
    """Below g tan(alpha) nothing lifts; above, its peak is near the exact one at an ordinary step.

    The same run after another one of the same model answers the same to the bit.
    """
    motion = pulse(1.3, 3.0, 1)
    first, still, again = (rocked(name, it) for it in (motion, pulse(0.9, 1.0), motion))
    if not has_warp(name):
        assert first.reason is Reason.UNAVAILABLE
        assert first.message.endswith("pip install 'rocking[newton,warp]'")
        return
    assert (first.outcome, still.outcome) == (Outcome.ROCKED, Outcome.AT_REST)
    assert first.peak_ratio == pytest.approx(simulate(BLOCK, motion).peak_ratio, rel=0.03)
    assert (again.peak_ratio, again.steps) == (first.peak_ratio, first.steps)


def test_the_other_solvers_are_variants_and_no_engines_of_a_list():
    asked = {each.source.partition(":")[0] for each in variants("newton")}
    assert asked == {"newton", *OTHERS}
    assert not {*ENGINES} & {*OTHERS}
    assert {*OTHERS} <= {*SOURCES}
