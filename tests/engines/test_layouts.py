"""Scenes of other things than one block: side by side, a frame, a slide."""

from dataclasses import dataclass

import pytest
from declared import equal_to
from given import FULL_SINE as SINE
from known import Bare
from uses import BLOCK, HERE, pulse, rocked, scene

from analytic import RockingFrame, SlidingBlock, Still, simulate
from analytic.response import Outcome, Reason
from engines.declaration import UNTUNED, Stepping
from engines.layouts import BASE, LOWER, UPPER, Ability, SideBySide, layout_of
from engines.run.drive import simulate_world
from engines.world import Moment, Pose

STACKING = [name for name, engine in HERE.items() if Ability.STACKED in engine.abilities]
APART_BY = {"dart": 5e-4, "physx": 2e-2}
"""Engine -> by how much two equal blocks differ, where that is more than its rounding."""

APART = [
    (name, preset.name)
    for name, engine in HERE.items()
    if Ability.SEVERAL in engine.holds
    for preset in engine.presets
    if preset.name not in UNTUNED
]


@pytest.mark.parametrize(("engine", "preset"), APART)
def test_blocks_apart_rock_as_one_alone(engine, preset):
    """To the rounding of the engine, but for DART and PhysX, whose contacts depend on where one is;
    as they come, pymunk's ten sweeps do not converge, and hang on the order of its contacts."""
    alone, both = (
        rocked(engine, pulse(1.2, 2.0, 2), system=system, preset=preset)
        for system in (BLOCK, SideBySide(block=BLOCK))
    )
    peaks = [both.observables["peak_1"], both.observables["peak_2"]]
    assert peaks == pytest.approx(
        [alone.peak_ratio] * 2, rel=APART_BY.get(engine, equal_to(engine))
    )


BOX = SlidingBlock(width=1.0, height=0.5, friction=0.2)


def frame(load, columns=2):
    return RockingFrame(width=0.5, height=1.5, columns=columns, load=load)


LANDED = {"mujoco": (2, 3, 5), "pymunk": (2, 3)}
"""Engine -> columns with which a frame moves as one; in pymunk one of five leaves a light beam."""


@pytest.mark.parametrize(("engine", "columns"), [(e, n) for e, of in LANDED.items() for n in of])
@pytest.mark.parametrize("load", [0.1, 1.0, 10.0])
def test_a_frame_lands_as_a_block(engine, columns, load):
    """Of second order in p dt = 5e-3; MuJoCo's contact yields by a part 1e-4 of what it carries, so
    that a heavy beam lifts a little early at any step."""
    system, exactly = frame(load, columns), 1e-5 * (1.0 + load)
    response = rocked(engine, SINE, system=system)
    assert response.peak_ratio == pytest.approx(simulate(system, SINE).peak_ratio, rel=exactly)
    seen = response.observables
    assert max(seen["parting"], seen["tilt"]) < 1e-5
    assert seen["drift_m"] < 1e-6 * system.width
    ratios = [impact.ratio for impact in response.impacts]
    assert ratios == pytest.approx([system.restitution] * len(ratios), rel=1e-4)


@pytest.mark.parametrize("engine", STACKING)
def test_a_frame_rocks_at_equal_steps(engine):
    """Where in a step an impact falls costs half a per cent; PyBullet's boxes lose one more."""
    response = rocked(engine, SINE, system=frame(2.0), preset="fixed")
    assert response.peak_ratio == pytest.approx(simulate(frame(2.0), SINE).peak_ratio, rel=1.5e-2)
    assert response.observables["parting"] < 1e-4


def test_the_released_frame_swings_back():
    system, asked = frame(1.0), {"start": (0.4 * BLOCK.alpha, 0.0), "duration": 2.0}
    found = rocked("mujoco", Still(), system=system, **asked)
    exact = simulate(system, Still(), **asked)
    times = [impact.time for impact in exact.impacts[:3]]
    assert [impact.time for impact in found.impacts[:3]] == pytest.approx(times, rel=1e-4)


@pytest.mark.parametrize("engine", [name for name in HERE if name not in ("drake", "newton")])
@pytest.mark.parametrize("friction", [0.1, 0.2])
def test_a_slide_ends_where_it_should(engine, friction):
    """Tuned engines give up g mu dt^2 of a slip where it starts and stops, dt = 1e-4 s at most, and
    single precision a part 1e-4 of its end."""
    box = SlidingBlock(width=1.0, height=0.5, friction=friction)
    found = rocked(engine, SINE, system=box, preset="fixed")
    assert found.outcome is Outcome.SLID
    assert found.slips == pytest.approx(simulate(box, SINE).slips, abs=5e-4)


def test_a_launched_box_stops():
    box = SlidingBlock(width=1.0, height=1.0, friction=0.5)
    for engine in {"pymunk", "pybullet"} & set(HERE):
        found = rocked(engine, Still(), system=box, start=(0.0, 6.0), preset="fixed")
        assert found.slips == pytest.approx((36.0 / 9.81,), rel=1e-6), engine
        assert found.slip_times[0][1] == pytest.approx(12.0 / 9.81, rel=1e-3)


def test_a_slide_that_is_cut_short_counts_as_far_as_it_got():
    """As the closed form counts it, with the places on the way."""
    box = SlidingBlock(width=1.0, height=1.0, friction=0.5)
    asked = {"start": (0.0, 6.0), "duration": 0.5, "times": [0.1, 0.3, 0.5]}
    exact = simulate(box, Still(), **asked)
    found = rocked("pymunk", Still(), system=box, preset="fixed", **asked)
    assert found.outcome is exact.outcome is Outcome.SLID
    # of first order in a step of 1e-4 s at 6 m/s
    assert found.slips == pytest.approx(exact.slips, abs=1e-3)
    assert found.history.theta == pytest.approx(exact.history.theta, abs=1e-3)
    assert found.history.velocity == pytest.approx(exact.history.velocity, abs=1e-2)


class Trembles(Bare):
    """A world in which a box is pushed to and fro, step by step, by a hundredth of a tremor's way.

    Its velocities are those of a slide.
    """

    moment = Moment.MIDDLE

    def __init__(self, way_m):
        self.way_m, self.steps = way_m, 0

    def step(self, step):
        self.steps += 1

    def state(self):
        return [Pose(self.way_m * (self.steps % 2), 0.25, 0.0, 0.0)]


def test_a_box_that_trembles_where_it_is_is_at_rest():
    """Else a run of a box that two contacts hold in turn would never end."""
    box = SlidingBlock(width=1.0, height=0.5, friction=0.5)
    posed = scene(SINE, system=box, max_steps=20_000)
    still, restless = (
        simulate_world(Trembles(way_m), posed, 1e-3, Stepping.FIXED) for way_m in (5e-6, 5e-4)
    )
    assert still.outcome is Outcome.AT_REST
    assert still.steps < 2_000
    assert restless.reason is Reason.UNDECIDED


def test_what_an_engine_cannot_hold_is_a_row_that_says_so():
    response = rocked("warp", SINE, system=frame(1.0))
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert response.message.endswith("is not built here for bodies that rest on other bodies")
    landing = rocked("mujoco", SINE, system=BOX, preset="landing")
    assert landing.reason is Reason.UNAVAILABLE
    assert "nothing rocks here" in landing.message


def test_a_plain_name_is_the_best_preset_that_can_be_used_and_says_which():
    best, fixed = (rocked("pymunk", SINE, system=BOX, preset=preset) for preset in (None, "fixed"))
    assert best.message == "as pymunk:fixed"
    assert best.slips == fixed.slips
    assert not rocked("pymunk").message


def test_a_frame_is_columns_that_share_their_beam():
    layout = layout_of(frame(2.0, 3), 1000.0, 1.0, (0.0, 0.0))
    *columns, beam = layout.bodies
    assert beam.mass == pytest.approx(2.0 * sum(column.mass for column in columns))
    assert [contact.on for contact in layout.contacts] == [BASE] * 3 + [3] * 3
    tops = [layout.carried(contact) for contact in layout.contacts if contact.face == UPPER]
    feet = [layout.carried(contact) for contact in layout.contacts if contact.face == LOWER]
    assert tops == pytest.approx([beam.mass / 3.0] * 3)
    assert sum(feet) == pytest.approx(sum(body.mass for body in layout.bodies))


@dataclass(frozen=True)
class Nothing:
    width = height = alpha = p = gravity = 1.0


def test_what_has_no_layout_is_named():
    with pytest.raises(TypeError, match="system is a Nothing; it must be one of RigidBlock, "):
        layout_of(Nothing(), 1000.0, None, (0.0, 0.0))
    with pytest.raises(ValueError, match="count is 0; it must be a whole number from 1 on"):
        SideBySide(block=BLOCK, count=0)
