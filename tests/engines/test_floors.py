"""Engines as they come, on a floor that a constraint or a weld drags: its lag, and what is set."""

import math

import numpy as np
import pytest
from uses import BLOCK, HERE, SHAKEN, agreed, pulse, rocked, scene

from analytic.response import Outcome
from engines.pybullet import NAIVE
from engines.run.run import LAG, build

FASTEST = 2.0 * SHAKEN.amplitude / SHAKEN.omega
ERROR_REDUCTION = 0.2
"""Part of its error that PyBullet's constraint takes out of the floor's place in a step."""
LAGS_S = {
    "pybullet": (1.0 - ERROR_REDUCTION) / ERROR_REDUCTION * NAIVE.step_s,
    "mujoco": 2.0 * 0.02 * 0.95,  # damping over stiffness of its weld
}
"""Engine -> by how long its floor lags behind a steady velocity."""
WITHIN = {"pybullet": 1e-2, "mujoco": 5e-2}
LED_M = {"drake": 1e-7, "newton": 1e-6}
"""Engine -> by less than what the floor is off that it leads."""

BARE = """<mujoco><worldbody><body name="there" mocap="true"/><body name="here"><freejoint/>
<geom type="box" size="1 1 1"/></body></worldbody>
<equality><weld body1="there" body2="here"/></equality></mujoco>"""


def peak(engine):
    return rocked(engine, preset="naive").peak_ratio


@pytest.mark.parametrize("engine", [name for name in LAGS_S if name in HERE])
def test_the_floor_lags_by_what_holds_it(engine):
    lag = rocked(engine, preset="naive").observables[LAG]
    assert lag == pytest.approx(LAGS_S[engine] * FASTEST, rel=WITHIN[engine])


@pytest.mark.parametrize("engine", [name for name in LED_M if name in HERE])
def test_a_floor_that_is_led_is_where_it_should_be(engine):
    exact, response = agreed(engine, preset="naive", frame="world")
    assert 0.0 < response.observables[LAG] < LED_M[engine]
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=0.2)


@pytest.mark.parametrize("engine", [name for name in LAGS_S if name in HERE])
@pytest.mark.parametrize("onsets", [0.8, -0.8])
def test_what_stands_on_a_floor_that_lags_is_at_rest(engine, onsets):
    """A block is seen from where the floor is, not from where it should be."""
    response = rocked(engine, pulse(onsets, 3.0, 2), preset="naive")
    assert response.outcome is Outcome.AT_REST
    assert response.observables[LAG] > 1e-3


def test_what_naive_pybullet_does_not_set_is_the_library_s_own():
    """Damping cannot be read back: two boxes that fly are slowed alike."""
    p = pytest.importorskip("pybullet")
    world, bare = build(HERE["pybullet"].use(scene(preset="naive"))), p.connect(p.DIRECT)
    half = (0.5 * BLOCK.width, 0.5 * BLOCK.width, 0.5 * BLOCK.height)
    box = p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=bare)
    body = p.createMultiBody(375.0, box, physicsClientId=bare)
    read = []
    for client, block in ((world._client, world.bodies[0]), (bare, body)):
        place = (0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0)
        p.resetBasePositionAndOrientation(block, *place, physicsClientId=client)
        p.resetBaseVelocity(block, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), physicsClientId=client)
        for _ in range(240):
            p.stepSimulation(physicsClientId=client)
        rest = p.getDynamicsInfo(block, -1, physicsClientId=client)[2:]  # after mass and friction
        parameters = p.getPhysicsEngineParameters(physicsClientId=client)
        velocity = np.ravel(p.getBaseVelocity(block, physicsClientId=client)).tolist()
        read.append((rest, parameters, velocity))
    world.close()
    p.disconnect(bare)
    assert read[0] == read[1]
    assert read[0][2][0] < math.exp(-0.04)


def test_what_naive_mujoco_does_not_set_is_the_library_s_own():
    mj = pytest.importorskip("mujoco")
    world = build(HERE["mujoco"].use(scene(preset="naive")))
    bare, read = mj.MjModel.from_xml_string(BARE), world.model
    for name in dir(bare.opt):
        found = getattr(read.opt, name)
        if not name.startswith("_") and not callable(found):
            assert np.array_equal(found, getattr(bare.opt, name)), name
    for name in ("solref", "solimp", "friction", "margin", "gap", "condim", "solmix", "priority"):
        own = getattr(bare, f"geom_{name}")[0]
        assert all(np.array_equal(found, own) for found in getattr(read, f"geom_{name}")), name
    for name in ("eq_solref", "eq_solimp"):
        assert np.array_equal(getattr(read, name), getattr(bare, name)), name
    world.close()
