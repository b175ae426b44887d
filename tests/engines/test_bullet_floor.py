"""PyBullet as it comes, on a floor that a constraint holds: how far it lags, and what is set."""

import math

import numpy as np
import pytest
from uses import BLOCK, HERE, pulse, scene

from analytic.response import Outcome
from engines.pybullet import calls
from engines.run.drive import LAG, build, run

p = pytest.importorskip("pybullet")

MOTION = pulse(1.3, 3.0, 2)
FASTEST = 2.0 * MOTION.amplitude / MOTION.omega
NAIVE = HERE["pybullet"].preset("naive")

ERROR_REDUCTION = 0.2
"""Part of its error that the constraint takes out of the floor's place in a step."""


def peak():
    return run("pybullet", scene(MOTION, preset="naive")).peak_ratio


def test_the_floor_lags_by_what_the_constraint_leaves():
    response = run("pybullet", scene(MOTION, preset="naive"))
    assert response.driver == "python: the base is held by a constraint"
    left = (1.0 - ERROR_REDUCTION) / ERROR_REDUCTION
    assert response.observables[LAG] == pytest.approx(left * FASTEST * NAIVE.step_s, rel=1e-2)


@pytest.mark.parametrize("ratio", [0.8, -0.8])
def test_what_stands_on_a_floor_that_lags_is_at_rest(ratio):
    """A block is seen from where the floor is, not from where it should be."""
    response = run("pybullet", scene(pulse(ratio, 3.0, 2), preset="naive"))
    assert response.outcome is Outcome.AT_REST
    assert response.observables[LAG] > 1e-3


def test_neither_mass_nor_force_of_the_floor_matters(monkeypatch):
    found = peak()
    for name, value in (("FLOOR_MASSES", 1000.0), ("FLOOR_MASSES", 10.0), ("FLOOR_G", 2.0)):
        with monkeypatch.context() as patch:
            patch.setattr(calls, name, value)
            assert peak() == pytest.approx(found, rel=2e-3)
    monkeypatch.setattr(calls, "FLOOR_G", 0.9)
    world = build(HERE["pybullet"], scene(MOTION, preset="naive", frame="world"))
    p.setGravity(0.0, 0.0, -BLOCK.gravity, physicsClientId=world._client)
    for _ in range(240):
        p.stepSimulation(physicsClientId=world._client)
    assert world.state()[0][1] == pytest.approx(0.5 * BLOCK.height, abs=1e-2)
    ((_, _, fallen), _) = p.getBasePositionAndOrientation(
        world._base, physicsClientId=world._client
    )
    world.close()
    assert fallen < -BLOCK.height - 0.1


def test_what_naive_does_not_set_is_the_library_s_own():
    """Damping cannot be read back: two boxes that fly are slowed alike."""
    world = build(HERE["pybullet"], scene(MOTION, preset="naive"))
    bare = p.connect(p.DIRECT)
    half = (0.5 * BLOCK.width, 0.5 * BLOCK.width, 0.5 * BLOCK.height)
    box = p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=bare)
    body = p.createMultiBody(375.0, box, physicsClientId=bare)
    read = []
    for client, block in ((world._client, world._bodies[0]), (bare, body)):
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
