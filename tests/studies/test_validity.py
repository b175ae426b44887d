"""Where the reference is valid, and what engines do beyond."""

import itertools
import math

import numpy as np
import pandas as pd
import pytest

from analytic import Outcome, RigidBlock, SinePulse, simulate
from analytic.response import Reason, Response
from studies import respond
from studies.__main__ import run
from studies.old.jobs import Job
from studies.validity import study as validity
from studies.validity.study import LIFTED_WIDTHS, SLID_WIDTHS, _reduce, posed, reference_map

G = 9.81


@pytest.mark.parametrize(("aspect", "onsets", "omega"), [(1, 1.4, 4), (1.5, 2.4, 4), (3, 1.5, 6)])
def test_the_least_normal_force_is_newtons(aspect, onsets, omega):
    """The mass times the vertical acceleration of its centre, by differences of the history; the
    reference looks at 17 points in a step, the history at every thousandth of the pulse."""
    block, motion = posed(aspect, onsets, omega)
    exact = simulate(block, motion)
    times = np.linspace(0.0, motion.duration, 20_001)
    theta = simulate(block, motion, times=times).history.theta
    height = block.R * np.cos(block.alpha - np.abs(theta))
    h = times[1] - times[0]
    normal = 1.0 + np.diff(height, 2) / h**2 / G
    sway = np.sign(theta) * block.R * (np.sin(block.alpha) - np.sin(block.alpha - np.abs(theta)))
    push = np.diff(sway, 2) / h**2 / G + motion.acceleration(times[1:-1]) / G
    # across an impact or an uplift the differences hold a jump, and at rest they are no swing
    kinks = [*(i.time for i in exact.impacts), *exact.uplifts]
    clear = [all(abs(t - kink) > 2 * h for kink in kinks) for t in times[1:-1]]
    swinging = np.array(clear) & (np.abs(theta[1:-1]) > 0)
    least = normal[swinging].min()
    assert exact.min_normal == pytest.approx(least, abs=2e-3)
    if least > 0:
        friction = np.abs(push[swinging] / normal[swinging]).max()
        assert exact.friction_needed == pytest.approx(friction, rel=5e-3)
    else:
        assert exact.friction_needed == math.inf


def test_the_friction_needed_is_never_less_than_b_over_h():
    """The uplift itself needs |u_g''|/g = B/H; the impact, 1.5 t/(2 + t^2/2) with t = B/H, less."""
    table = reference_map(itertools.product((1.0, 2.0, 3.0), (1.05, 1.5, 3.0), (1.0, 4.0, 9.0)))
    steepness = 1.0 / table["aspect"]
    assert (table["friction_needed"] > steepness * (1 - 1e-12)).all()
    assert (1.5 * steepness / (2 + 0.5 * steepness**2) < steepness).all()


def test_the_map_is_similar_and_grows_worse_with_squatness():
    small = RigidBlock(width=0.05, height=0.05)
    same = simulate(small, SinePulse(amplitude=2.0 * G, omega=3.0 * small.p, half_cycles=2))
    here = simulate(*posed(1.0, 2.0, 3.0))
    assert here.min_normal == pytest.approx(same.min_normal, rel=1e-9)
    table = reference_map((aspect, 2.0, 3.0) for aspect in (1.0, 1.5, 2.0, 3.0))
    assert (np.diff(table["min_normal"]) > 0).all()
    assert table["min_normal"].iloc[0] < 0 < table["min_normal"].iloc[1]


@pytest.mark.parametrize("source", ["pybullet:fixed", "mujoco:fixed"])
def test_engines_lift_off_where_the_reference_would_have_to_pull(source):
    for valid, (aspect, onsets, omega) in (
        (True, (1.0, 1.2, 4.0)),
        (True, (3.0, 2.4, 8.0)),
        (False, (1.0, 2.0, 3.0)),
        (False, (1.5, 2.4, 1.0)),
    ):
        block, motion = posed(aspect, onsets, omega)
        assert (simulate(block, motion).min_normal > 0) is valid
        response = respond(source, block, motion)
        assert response.outcome is not Outcome.FAILED
        assert (response.hop_m < LIFTED_WIDTHS * block.width) is valid


@pytest.mark.parametrize("source", ["pybullet:fixed", "mujoco:fixed"])
def test_engines_slide_where_the_reference_needs_more_friction(source):
    block, motion = posed(2.0, 1.2, 4.0)
    needed = simulate(block, motion).friction_needed
    enough, short = (respond(source, block, motion, friction=k * needed) for k in (1.2, 0.8))
    assert enough.slip_m < SLID_WIDTHS * block.width < short.slip_m


def rocked(slip_m, hop_m):
    return Response(outcome=Outcome.ROCKED, peak_ratio=0.5, slip_m=slip_m, hop_m=hop_m)


@pytest.mark.parametrize(
    ("response", "verdict", "outcome"),
    [
        (rocked(0, 0), "held", "rocked"),
        (rocked(0, 1), "lifted off", "rocked"),
        (rocked(1, 0), "slid", "rocked"),
        (rocked(1, 1), "slid and lifted off", "rocked"),
        (Response.failure("no more words", reason=Reason.SLID), "slid away", "left"),
        (Response.failure("no more words", reason=Reason.THROWN), "flew off", "left"),
        (Response.failure("thrown and slid, it says", reason=Reason.DIVERGED), "failed", "failed"),
    ],
)
def test_verdicts(response, verdict, outcome):
    block, motion = posed(1.0, 2.0, 3.0)
    row = _reduce(Job(labels={}, block=block, motion=motion, source="mujoco:fixed"), response)
    assert (row["verdict"], row["outcome"]) == (verdict, outcome)


def test_what_the_reference_needs_is_told_of_survivors():
    table = pd.DataFrame(
        {
            "aspect": [1.0] * 4 + [3.0],
            "onsets": [1.2, 1.5, 2.0, 8.0, 4.0],
            "outcome": ["rocked", "rocked", "rocked", "overturned", "rocked"],
            "min_normal": [0.1, -0.2, -0.3, -0.4, 0.3],
            "friction_needed": [1.1, math.inf, math.inf, math.inf, 0.4],
        }
    )
    squat, slender = validity.needs(table).to_dict("records")
    assert (squat["cases"], squat["lifted"], squat["survivors_lifted"]) == (4, 3, 2)
    assert (squat["from_onsets"], squat["least_friction"]) == (1.5, 1.1)
    assert math.isnan(slender["from_onsets"]) and slender["median_friction"] == 0.4


def test_verdicts_are_counted_by_source_and_class():
    rows = pd.DataFrame(
        {
            "source": "mujoco:fixed",
            "verdict": ["held", "held", "slid"],
            "agrees": [True, False, True],
            "error": [-0.3, math.nan, 0.1],
            "slip_widths": [0.0, 1e-6, 0.2],
            "hop_widths": 0.0,
        }
    )
    first, last = validity.verdicts(rows, pd.Series([0.8, 1.2, 0.8], name="factor")).to_dict(
        "records"
    )
    assert (first["factor"], first["held"], first["slid"], first["agrees"]) == (0.8, 1, 1, 2)
    assert first["median_error"] == pytest.approx(0.2) and first["slip_widths"] == 0.2
    assert (last["held"], last["slid"], last["agrees"]) == (1, 0, 0)


def test_engines_hold_where_they_have_friction_enough(tmp_path, monkeypatch):
    monkeypatch.setattr(validity, "ONSETS", (1.2,))
    monkeypatch.setattr(validity, "OMEGAS", (8.0,))
    monkeypatch.setattr(validity, "MAP_ONSETS", (1.1, 2.0, 4.0))
    monkeypatch.setattr(validity, "MAP_OMEGAS", (1.0, 3.0, 9.0))
    arguments = ["validity", "--out", str(tmp_path), "--quick", "--jobs", "1"]
    assert run([*arguments, "--sources", "pybullet:fixed"]) == 0
    rows = pd.read_csv(tmp_path / "validity.csv")
    assert len(rows) == 4 * 3
    assert set(rows.loc[~(rows["friction_factor"] < 1), "verdict"]) == {"held"}
    beside = pd.read_csv(tmp_path / "compared.csv")
    assert math.isfinite(beside["error"].iloc[0])
