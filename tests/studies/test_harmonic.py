"""Sustained harmonic shaking: branches up and down, and engines on them."""

import math

import pandas as pd
import pytest

from analytic import RigidBlock
from studies.__main__ import run
from studies.harmonic.report import coexisting
from studies.harmonic.sweeps import Shaking, settle, sweep

BLOCK = RigidBlock(width=0.5, height=1.5)
START = (0.3 * BLOCK.alpha, 0.0)


def test_a_settled_state_goes_on_as_it_is():
    shaking = Shaking(block=BLOCK, onsets=1.5, omega_over_p=4.0)
    first = settle(shaking, START, 200)
    again = settle(shaking, first.start, 100)
    assert first.period == again.period == 1
    assert again.right == pytest.approx(first.right, rel=1e-9)


def test_a_block_that_overturns_starts_again():
    violent = Shaking(block=BLOCK, onsets=8.0, omega_over_p=1.0)
    calm = Shaking(block=BLOCK, onsets=1.5, omega_over_p=4.0)
    fallen, after = (state for _, state in sweep([violent, calm], START, 100))
    assert fallen.outcome == "overturned"
    assert math.isinf(fallen.right)
    assert after.right == pytest.approx(settle(calm, START, 100).right, rel=1e-12)


def test_similarity_holds_for_steady_states():
    large = RigidBlock(width=2.0, height=6.0)
    small, other = (
        settle(Shaking(block=block, onsets=1.5, omega_over_p=5.0), (0.3 * block.alpha, 0.0), 150)
        for block in (BLOCK, large)
    )
    assert other.right == pytest.approx(small.right, rel=1e-9)


def test_branches_that_differ_are_told():
    table = pd.DataFrame(
        {
            "direction": ["up", "up", "down", "down"],
            "x": [1.0, 2.0, 1.0, 2.0],
            "larger_ratio": [0.3, 0.4, 0.3, 0.5],
        }
    )
    assert coexisting(table).tolist() == [False, True]


def test_engines_stay_on_the_exact_orbit(tmp_path, capsys):
    arguments = ["harmonic", "--out", str(tmp_path), "--points", "4", "--low", "3", "--high", "6"]
    assert run([*arguments, "--quick", "--jobs", "1"]) == 0
    engines = pd.read_csv(tmp_path / "engines.csv")
    assert set(engines["source"]) == {"pybullet", "mujoco"}
    # the exact orbit attracts, so that an engine's error does not grow with the periods
    assert engines["larger_ratio"].to_numpy() == pytest.approx(
        engines["larger_exact"].to_numpy(), rel=1e-3
    )
    assert "Engines on the exact orbit" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--tilt", "1"), "--tilt"),
        (("--onsets", "2", "--over", "amplitude"), "--onsets"),
        (("--omega-over-p", "2"), "--omega-over-p"),
        (("--low", "5", "--high", "4"), "--low"),
        (("--sources", "exact"), "--sources"),
    ],
)
def test_bad_input_is_one_line(arguments, word, tmp_path, capsys):
    assert run(["harmonic", "--out", str(tmp_path / "out"), *arguments]) == 2
    error = capsys.readouterr().err
    assert word in error
    assert error.count("\n") == 1
