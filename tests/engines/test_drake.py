"""Drake: how near it comes, by steps of its own too, and the traps that it sets without a word."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_landing import errors_of_sweep, sweep_cases
from uses import BLOCK, HERE, pulse, scene

from analytic import simulate
from analytic.response import Outcome, Reason
from engines import ENGINES, Scene
from engines.declaration import AT_REST
from engines.parts.shapes import NO_JAM
from engines.run.drive import LAG, build, run
from studies.kit.executors import Local
from studies.kit.jobs import Job

pytestmark = pytest.mark.skipif("drake" not in HERE, reason="pydrake is not installed")

MOTION = pulse(1.3, 3.0, 2)
OWN_STEPS = "error-controlled"


def rocked(preset, density=1000.0, frame=None, **settings):
    asked = scene(MOTION, preset=preset, density=density, frame=frame, settings=settings)
    return run("drake", asked)


def error(preset, density=1000.0, frame=None, **settings):
    peak = rocked(preset, density, frame, **settings).peak_ratio
    return abs(peak / simulate(BLOCK, MOTION).peak_ratio - 1.0)


def test_some_of_the_sweep():
    """Some twenty thousand steps err by 2e-9 alpha each."""
    errors = errors_of_sweep("drake", every=120)
    assert np.median(errors) < 2e-4
    assert max(errors) < 1e-3


def test_the_worst_conditioned_case_of_the_sweep():
    """It survives by 3 %, and a part of the pulse more makes its peak 72 parts larger."""
    block, motion = max(sweep_cases(), key=lambda case: survived(*case))
    exact = simulate(block, motion)
    assert exact.peak_ratio == pytest.approx(0.97170219)
    for preset, largest in ((OWN_STEPS, 3e-3), ("fixed", 1e-2)):
        response = run("drake", Scene(system=block, motion=motion, preset=preset))
        assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=largest)


def survived(block, motion):
    """Return the exact peak over alpha, 0 where the block falls."""
    peak = simulate(block, motion).peak_ratio
    return peak if peak < np.inf else 0.0


def test_smaller_errors_of_a_step_make_smaller_errors():
    found = [error(OWN_STEPS, accuracy=accuracy) for accuracy in (1e-4, 1e-6, 1e-8)]
    assert found[0] > 5.0 * found[1]
    assert found[1] > 2.0 * found[2]


def test_looks_may_be_far_apart():
    """The base's motion is told look by look, the engine's steps are its own in between."""
    loose, standard = (
        run("drake", Scene(system=BLOCK, motion=MOTION, accuracy=accuracy))
        for accuracy in ("loose", "standard")
    )
    assert loose.peak_ratio == pytest.approx(standard.peak_ratio, rel=2e-3)
    assert loose.steps > 0.5 * standard.steps


def test_the_library_s_own_accuracy_is_too_loose_for_a_block():
    """CENIC's own is 1e-3 m or rad a step, whatever the size: a block may go through its base."""
    assert error(OWN_STEPS, accuracy=1e-3 / BLOCK.alpha) > 0.05


def test_a_contact_is_as_stiff_under_a_heavier_block():
    """1e6 N/m, whatever stands on it: a light block errs little, a heavy one sinks in."""
    light, ordinary = (error(AT_REST, density) for density in (10.0, 1000.0))
    assert light < 0.02 < 0.1 < ordinary
    heavy = rocked(AT_REST, density=1e5)
    assert heavy.sink_m > 0.05 * BLOCK.width
    assert "sank" in heavy.message


def test_a_contact_that_goes_with_the_mass_errs_as_much_under_any():
    light, heavy = (rocked("fixed", density=density).peak_ratio for density in (10.0, 1e5))
    assert light == pytest.approx(heavy, rel=1e-6)


@pytest.mark.parametrize(("block", "motion"), list(itertools.islice(sweep_cases(), 3, None, 97)))
def test_a_block_in_a_soft_contact_rocks_as_deep_as_it_stands(block, motion):
    """With the library's own it sinks by centimetres all the while, and its rocking is seen."""
    exact = simulate(block, motion)
    found = run("drake", Scene(system=block, motion=motion, preset="naive"))
    assert exact.outcome is not Outcome.AT_REST
    assert found.outcome is exact.outcome
    if exact.outcome is Outcome.ROCKED:
        assert 0.5 < found.peak_ratio / exact.peak_ratio < 2.5


def test_friction_lags_behind_what_dissipates():
    """It goes by the normal force at the beginning of a step, of which dissipation makes much or
    nothing: the pivot slides, at equal steps by inches, and more friction hides it in part."""
    assert error("fixed") < 5e-3
    assert error("fixed", dissipation=1e4) > 0.02
    assert error("fixed", dissipation=1e4, friction=NO_JAM) > 0.05
    assert rocked("fixed", dissipation=1e5, friction=NO_JAM).reason is Reason.SLID


def test_a_box_touches_a_half_space_in_one_point():
    assert error("fixed", geometry="box") > 10.0 * error("fixed")


def test_what_the_library_gives_up_on_ends_the_run_and_not_the_process(monkeypatch):
    """A condition of its own that does not hold is no error in Python but the end of it."""
    from engines.drake import build as drake

    monkeypatch.setattr(drake, "mean_velocity_of", lambda _: lambda begin, end: float("nan"))
    response = rocked(OWN_STEPS)
    assert response.reason is Reason.FAULT
    assert "condition" in response.message
    assert "\n" not in response.message


def test_a_step_that_does_not_end_is_ended_by_the_limit():
    """Steps of its own may become as short as they like within one call of the library."""
    endless = {"settings": {"accuracy": 1e-300}, "step": 10.0}
    job = Job(labels={}, block=BLOCK, motion=MOTION, source="drake", options=endless)
    [(_, response)] = Local(1, 10.0)([job])
    assert response.outcome is Outcome.FAILED
    assert response.reason is Reason.UNDECIDED
    assert "time limit of 10 s" in response.message


def test_settings_are_read_back(monkeypatch):
    from engines.drake import build

    whole = build.values

    def forgetful(*asked):
        return SimpleNamespace(**{**vars(whole(*asked)), "friction": 0.5})

    monkeypatch.setattr(build, "values", forgetful)
    assert rocked("fixed").message == "friction was set to 100.0 but reads 0.5"


def test_a_box_turns_out_of_the_plane_about_its_one_contact():
    """Its deepest corner alone holds it: what is seen in the plane is a pivot that slides away,
    whatever the friction. Spheres at four corners hold it, and so does a joint in the plane."""
    hard = Scene(system=BLOCK, motion=pulse(7.0, 6.0, 2), preset=AT_REST)
    assert simulate(BLOCK, hard.motion).friction_needed < 0.7
    for friction in (1.0, 10.0):
        assert run("drake", replace(hard, settings={"friction": friction})).reason is Reason.SLID
    for settings in ({"planar": True}, {"geometry": "corners"}):
        assert run("drake", replace(hard, settings=settings)).slip_m < 2e-3


@pytest.mark.parametrize("preset", ["naive", "fixed", OWN_STEPS])
def test_a_base_on_a_rail_is_where_it_should_be(preset):
    found = run("drake", scene(MOTION, preset=preset, frame="world"))
    assert 0.0 < found.observables[LAG] < 1e-7
    assert error(preset, frame="world") < (0.2 if preset == "naive" else 5e-3)


@pytest.mark.parametrize("preset", ["naive", "fixed"])
def test_a_base_by_position_alone_drags_nothing(preset):
    found = run(
        "drake", scene(MOTION, preset=preset, frame="world", settings={"floor": "position"})
    )
    assert found.reason is Reason.SLID


def test_a_drive_that_yields_is_behind(monkeypatch):
    """An example's own gains, for a gripper of 0.1 kg, are nothing to a block."""
    from engines.drake import build as drake

    monkeypatch.setattr(drake, "GAINS", {"p": 1e4, "d": 1.0})
    assert run("drake", scene(MOTION, preset="naive")).observables[LAG] > 0.1


def test_what_naive_leaves_is_what_the_library_does_itself():
    from pydrake.geometry import SceneGraphConfig
    from pydrake.multibody.plant import MultibodyPlantConfig

    said = {source.setting: source.value for source in ENGINES["drake"].presets[0].documented}
    bare, shapes = MultibodyPlantConfig(), SceneGraphConfig().default_proximity_properties
    assert f"time_step = {bare.time_step}" in said["step"]
    assert f"{bare.discrete_contact_approximation!r}" in said["solver"]
    assert f"stiction_tolerance = {bare.stiction_tolerance}" in said["solver"]
    assert f"contact_model = {bare.contact_model!r}" in said["contact"]
    assert f"compliance_type = {shapes.compliance_type!r}" in said["contact"]
    assert f"point_stiffness = {shapes.point_stiffness:.0f}" in said["contact"]
    assert f"dissipation = {shapes.hunt_crossley_dissipation:.0f}" in said["contact"]
    assert f"static_friction = {shapes.static_friction}" in said["friction"]
    world = build(HERE["drake"], scene(MOTION, preset="naive"))
    assert world._plant.time_step() == bare.time_step
    assert world._plant.get_contact_model().name == "kHydroelasticWithFallback"
