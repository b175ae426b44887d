"""MuJoCo Warp and MJX: what they take of MuJoCo's settings, and its answers in their numbers."""

import pytest
from uses import HERE, rocked

from analytic.response import Outcome, Reason
from engines import ENGINES

PORTS = ("warp", "mjx")


@pytest.mark.parametrize("name", PORTS)
def test_where_it_is_missing_a_row_says_how_to_install_it(name):
    if name in HERE:
        pytest.skip("it is installed")
    response = rocked(name)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert f"pip install 'rocking[{name}]'" in response.message


@pytest.mark.parametrize("name", PORTS)
@pytest.mark.parametrize("setting", [{"carry": 1e-4}, {"reflection": True}, {"solver": "PGS"}])
def test_what_it_would_refuse_or_not_heed_is_bad_input(name, setting):
    assert not ENGINES[name].best.takes(**setting)


def test_a_tolerance_that_warp_raises_is_bad_input():
    assert ENGINES["warp"].best.takes(tolerance=1e-6)
    assert not ENGINES["warp"].best.takes(tolerance=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in PORTS if name in HERE])
def test_the_defaults_are_mujoco_s_in_other_numbers(name):
    port, mujoco = (rocked(engine, preset="naive") for engine in (name, "mujoco"))
    assert port.outcome is mujoco.outcome
    assert port.peak_ratio == pytest.approx(mujoco.peak_ratio, rel=1e-3)
    assert port.steps == mujoco.steps
