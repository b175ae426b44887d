"""MuJoCo as it comes, on a floor welded to a mocap body: how far it lags, and what is set."""

import numpy as np
import pytest
from uses import HERE, pulse, scene

from analytic.response import Outcome
from engines.mujoco import model
from engines.run.drive import LAG, build, run

mj = pytest.importorskip("mujoco")

MOTION = pulse(1.3, 3.0, 2)
FASTEST = 2.0 * MOTION.amplitude / MOTION.omega

LAGS_S = 2.0 * 0.02 * 0.95
"""By how long a floor lags behind a steady velocity: damping over stiffness of its weld."""

BARE = """<mujoco><worldbody><body name="there" mocap="true"/><body name="here"><freejoint/>
<geom type="box" size="1 1 1"/></body></worldbody>
<equality><weld body1="there" body2="here"/></equality></mujoco>"""


def peak(masses, monkeypatch):
    monkeypatch.setattr(model, "FLOOR_MASSES", masses)
    return run("mujoco", scene(MOTION, preset="naive")).peak_ratio


def test_the_floor_lags_by_what_the_weld_yields():
    response = run("mujoco", scene(MOTION, preset="naive"))
    assert response.observables[LAG] == pytest.approx(LAGS_S * FASTEST, rel=5e-2)


@pytest.mark.parametrize("ratio", [0.8, -0.8])
def test_what_stands_on_a_floor_that_lags_is_at_rest(ratio):
    """A block is seen from where the floor is, not from where it should be."""
    response = run("mujoco", scene(pulse(ratio, 3.0, 2), preset="naive"))
    assert response.outcome is Outcome.AT_REST
    assert response.observables[LAG] > 1e-3


def test_the_mass_of_the_floor_hardly_matters(monkeypatch):
    """Until it is so large that the solver takes what is left of the block's forces for nothing."""
    found = peak(model.FLOOR_MASSES, monkeypatch)
    assert peak(1e2, monkeypatch) == pytest.approx(found, rel=3e-3)
    assert peak(1e4, monkeypatch) == pytest.approx(found, rel=3e-3)
    assert peak(2.4e7, monkeypatch) < 0.9 * found


def test_what_naive_does_not_set_is_the_library_s_own():
    world = build(HERE["mujoco"], scene(MOTION, preset="naive"))
    bare, read = mj.MjModel.from_xml_string(BARE), world._model
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
