"""Sustained harmonic shaking: every attractor that is found, what is counted, and engines."""

import math

import numpy as np
import pandas as pd
import pytest
from given import BLOCK
from independent import swing

from analytic import RigidBlock
from studies.__main__ import run
from studies.harmonic.attractors import Shaking, attractors, settle
from studies.harmonic.study import branches, counts, engine_errors

START = (0.3 * BLOCK.alpha, 0.0)


def shaken(omega_over_p, onsets=1.5, block=BLOCK):
    return Shaking(block=block, onsets=onsets, omega_over_p=omega_over_p)


def test_orbits_beside_the_one_that_is_followed_are_found(tmp_path, capsys):
    """A motion of period 3 lives beside that of period 1, and beside overturning."""
    arguments = ["harmonic", "--quick", "--points", "2", "--low", "4.5", "--high", "5"]
    assert run([*arguments, "--out", str(tmp_path), "--jobs", "1"]) == 0
    table = pd.read_csv(tmp_path / "harmonic.csv")
    for _, rows in table.groupby("x"):
        assert set(rows.loc[rows["outcome"] == "rocked", "period"]) == {1, 3}
        assert rows["starts"].sum() == 25
        assert rows["start_share"].sum() == pytest.approx(1.0, rel=1e-12)
    assert "At all 2 frequencies a block has more than one" in capsys.readouterr().out


def carried(shaking, state, periods):
    """Return the state [rad, rad/s] after some periods, and the impacts, by SciPy's DOP853."""
    block, motion = shaking.block, shaking.motion(periods)

    def ground(time):
        return motion.amplitude * math.sin(motion.omega * time + motion.phase)

    t, s, impacts = 0.0, int(math.copysign(1, state[0] or state[1])), 0
    while t < motion.duration:
        span = (t, motion.duration)
        path = swing("exact", block, ground, s, span, state, max_step=0.05 / block.p)
        t, state = path.t[-1], path.y[:, -1]
        if path.t_events[0].size:
            s, state, impacts = -s, np.array([0.0, block.restitution * state[1]]), impacts + 1
    return state, impacts


def test_the_orbit_of_period_3_is_one_by_another_route():
    shaking = shaken(5.0)
    (found,) = attractors([shaking], 5, 100)
    (orbit,) = (one for one in found if one.period == 3)
    scale = np.array([BLOCK.alpha, BLOCK.alpha * BLOCK.p])
    begin = np.array(orbit.end) / scale
    after, impacts = carried(shaking, orbit.end, 3)
    assert after / scale == pytest.approx(begin, abs=1e-6)
    assert impacts == orbit.impacts == 2
    # it attracts: a start beside it comes nearer
    near, _ = carried(shaking, (orbit.end[0] + 1e-3 * BLOCK.alpha, orbit.end[1]), 60)
    assert np.abs(near / scale - begin).max() < 1e-4


@pytest.mark.parametrize(("tilt", "omega_over_p"), [(0.45, 5.0), (0.35, 5.8), (0.7, 5.8)])
def test_a_block_released_at_rest_reaches_it_by_another_route(tilt, omega_over_p):
    shaking = shaken(omega_over_p)
    late, _ = carried(shaking, (tilt * BLOCK.alpha, 0.0), 90)
    after, _ = carried(shaking, late, 3)
    sooner, _ = carried(shaking, late, 1)
    assert after / BLOCK.alpha == pytest.approx(late / BLOCK.alpha, abs=1e-4)
    assert np.abs(sooner - late).max() > 0.1 * BLOCK.alpha


def test_an_orbit_that_no_start_finds_is_found_from_the_point_beside_it():
    alone, beside = attractors([shaken(4.8), shaken(4.7)], 3, 100)
    assert [(one.period, one.starts) for one in alone][-1] == (3, 0)
    assert {one.period for one in beside if one.starts} == {0, 1, 3}
    assert 3 not in {one.period for one in attractors([shaken(4.8)], 3, 100)[0]}


def test_a_settled_state_goes_on_as_it_is():
    shaking = shaken(4.0)
    first = settle(shaking, START, 200)
    again = settle(shaking, first.end, 100)
    assert first.period == again.period == 1
    assert again.right == pytest.approx(first.right, rel=1e-9)


def test_a_block_that_overturns_is_followed_to_no_other_point():
    fallen, calm = attractors([shaken(1.0, onsets=8.0), shaken(4.0, onsets=0.5)], 3, 100)
    assert [(one.outcome, one.starts) for one in fallen] == [("overturned", 9)]
    assert math.isinf(fallen[0].right)
    assert {one.outcome for one in calm} == {"at rest", "rocked", "overturned"}


def test_similarity_holds_for_steady_states():
    large = RigidBlock(width=2.0, height=6.0)
    small, other = (
        settle(shaken(5.0, block=block), (0.3 * block.alpha, 0.0), 150) for block in (BLOCK, large)
    )
    assert other.right == pytest.approx(small.right, rel=1e-9)


def test_what_is_counted():
    """Three abscissae: two orbits and overturning; one orbit and overturning; overturning alone."""
    table = pd.DataFrame({"x": [1.0, 2.0, 2.0, 3.0, 3.0, 3.0], "period": [0, 1, 0, 1, 3, 0]})
    outcome = np.where(table["period"], "rocked", "overturned")
    table = table.assign(
        outcome=outcome, impacts=2, larger_ratio=table["x"] / 10.0, start_share=0.5
    )
    assert counts(table) == {"all": 3, "several": 1, "longer": 1, "both": 2, "fallen": 1}
    found = branches(table[(table["x"] != 2.0) | (table["period"] == 0)])
    kept = ["outcome", "period", "impacts", "x_min", "x_max", "larger_ratio_max"]
    assert found[kept].to_numpy().tolist() == [
        ["overturned", 0, 0, 1.0, 3.0, 0.3],
        ["rocked", 1, 2, 3.0, 3.0, 0.3],
        ["rocked", 3, 2, 3.0, 3.0, 0.3],
    ]
    apart = branches(table[(table["outcome"] == "rocked") | (table["x"] != 2.0)])
    assert apart.loc[apart["period"] == 0, "x_max"].to_list() == [1.0, 3.0]


def test_engines_stay_on_the_exact_orbit(tmp_path, capsys):
    arguments = ["harmonic", "--out", str(tmp_path), "--points", "4", "--low", "3", "--high", "6"]
    assert run([*arguments, "--quick", "--jobs", "1"]) == 0
    engines = pd.read_csv(tmp_path / "engines.csv")
    assert set(engines["source"]) == {"pybullet", "mujoco"}
    # the exact orbit attracts, so that an engine's error does not grow with the periods
    assert engines["larger_ratio"].to_numpy() == pytest.approx(
        engines["larger_exact"].to_numpy(), rel=1e-3
    )
    assert "Engines after some time on the exact orbit" in capsys.readouterr().out
    engines.loc[0, "larger_ratio"] = math.nan
    lost, whole = engine_errors(engines).to_dict("records")
    assert (lost["orbits"] - lost["kept"], whole["orbits"] - whole["kept"]) == (1, 0)
    assert whole["median_error"] <= whole["max_error"] < 1e-3
