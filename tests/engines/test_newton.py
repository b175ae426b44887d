"""Newton: what it keeps from run to run on the CPU, and the traps that it sets without a word."""

from dataclasses import replace

import pytest
from declared import run
from uses import BLOCK, HERE, error, pulse, rocked, scene, take_a_step

from analytic import simulate
from analytic.block import RigidBlock
from analytic.response import Outcome
from engines import ENGINES
from engines import newton as newton_models
from engines.declaration import AT_REST
from engines.run.run import build

pytestmark = pytest.mark.skipif("newton" not in HERE, reason="newton is not installed")


def test_a_corrected_depth_spoils_short_steps():
    """The library's own hundredth of it in a step is a velocity that grows as the step shrinks."""
    block = RigidBlock(width=1.0, height=1.5)
    motion = pulse(1.5, 3.0, 1, block)
    asked = {"system": block, "preset": "fixed", "duration": 1.0, "step": 2.5e-4}
    assert error("newton", motion, **asked) < 1e-3
    corrected = rocked("newton", motion, **asked, settings={"baumgarte": 0.01})
    assert corrected.peak_ratio < 0.5 * simulate(block, motion).peak_ratio


@pytest.mark.parametrize("solver", ["xpbd", "padmm", "dvi"])
def test_the_base_is_felt_by_each_solver(solver):
    """Below g tan(alpha) nothing lifts, and above it something does."""
    iterations = None if solver == "dvi" else 50
    settings = {"solver": solver, "iterations": iterations}
    for ratio, outcome in ((0.95, Outcome.AT_REST), (1.05, Outcome.ROCKED)):
        response = rocked("newton", pulse(ratio, 1.0), preset="fixed", settings=settings)
        assert response.outcome is outcome


def test_corrections_without_weights_are_made_by_each_corner():
    """Two corners then correct twice what one would: weighting is what the library does itself."""
    naive, rested = (error("newton", preset=preset) for preset in ("naive", AT_REST))
    assert max(naive, rested) < 0.15
    assert error("newton", preset="naive", settings={"weighting": False}) > 5.0 * naive


def test_a_recorded_step_has_its_length_for_good():
    """Another one would be taken as if it were as long as the one that was recorded."""
    world = build(HERE["newton"].use(scene()))
    step = take_a_step(world, scene(), "newton")
    assert not world.fault()
    world.step(step._replace(dt_s=2.0 * step.dt_s))
    assert world.fault() == "its steps are recorded, and all of one length"
    world.close()


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


def test_what_naive_leaves_is_what_the_library_does_itself():
    import newton

    world = build(HERE["newton"].use(scene(preset="naive")))
    solver, bare = world._recorded.it.solver, newton.solvers.SolverXPBD(world._recorded.it.model)
    for name in (
        *("iterations", "rigid_contact_relaxation", "rigid_contact_con_weighting"),
        *("angular_damping", "enable_restitution"),
    ):
        assert getattr(solver, name) == getattr(bare, name)
    assert (bare.iterations, bare.angular_damping) == (2, 0.0)
    assert newton.ModelBuilder.ShapeConfig().mu == ENGINES["newton"].presets[0].settings.friction
    world.close()
