"""A block that strikes with a corner: what comes out of a coefficient of restitution."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from analytic.response import Response
from engines import ENGINES
from studies import restitution
from studies.cases.ways import WAYS, damping_ratio, given_back
from studies.contact import newton_e
from studies.restitution import best_of, finding, job_of, measure

QUICK = {"rate_over_alpha_p": 2.0, "p_dt": 1e-4}
"""An impact in which the weight matters little."""


def struck(engine, way, wanted, **options):
    if not ENGINES[engine].installed:
        pytest.skip(f"{engine} is not installed")
    return measure(job_of(engine, way, wanted, **options))


@pytest.mark.parametrize("ratio", [0.02, 0.3, 0.9])
def test_a_spring_that_only_pushes_gives_back_what_its_equation_says(ratio):
    def motion(_, state):
        return [state[1], -2.0 * ratio * state[1] - state[0]]

    def force(_, state):
        return motion(_, state)[1]

    force.terminal, force.direction = True, -1.0
    # x is the gap: it comes in with unit speed, and leaves where the base would have to pull
    end = solve_ivp(motion, (0.0, 60.0), [0.0, -1.0], events=force, rtol=1e-11, atol=1e-13)
    assert given_back(ratio) == pytest.approx(end.y[1, -1], rel=1e-6)
    assert damping_ratio(given_back(ratio)) == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize("aspect", [1.5, 6.0])
@pytest.mark.parametrize("wanted", [0.0, 0.3, 1.0])
def test_what_a_block_keeps_is_what_impulses_on_its_corner_leave(aspect, wanted):
    """The closed form, against two impulses that are solved for."""
    asked = job_of("mujoco", "spring and damper over 20 steps", wanted, aspect=aspect)
    row = measure(replace(asked, lost=Response.failure("it ended")))
    half_width, half_height = 0.5 / aspect, 0.5
    radius_2 = (half_width**2 + half_height**2) / 3.0
    # along, up and turn after, and both impulses over the mass, for a unit rate before
    conditions = [
        [1.0, 0.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, radius_2, half_height, half_width],
        [1.0, 0.0, -half_height, 0.0, 0.0],
        [0.0, 1.0, -half_width, 0.0, 0.0],
    ]
    before = [half_height, -half_width, radius_2, 0.0, 2.0 * half_width * wanted]
    assert row["kept_ratio"] == pytest.approx(np.linalg.solve(conditions, before)[2], rel=1e-13)
    assert newton_e(row["kept_ratio"], asked.case.system.alpha) == pytest.approx(wanted, abs=1e-12)
    assert row["outcome"] == "failed" and math.isnan(row["corner_ratio"])


@pytest.mark.parametrize(
    ("engine", "way"),
    [
        ("pybullet", "1 on the base, no thresholds, no depth corrected"),
        ("pymunk", "e on the block, 1 on the base"),
        ("box2d", "e on the block, in the preset's units"),
        ("dart", "1 on the base, in tenths of a metre"),
        ("mujoco", "spring and damper over 20 steps"),
    ],
)
@pytest.mark.parametrize("wanted", [0.0, 0.6, 1.0])
def test_a_block_keeps_what_its_corner_gives_back(engine, way, wanted):
    row = struck(engine, way, wanted, **QUICK)
    assert row["rate_ratio"] == pytest.approx(row["kept_ratio"], abs=0.005)
    assert row["corner_ratio"] == pytest.approx(wanted, abs=0.01)
    assert row["slide_ratio"] == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize(
    ("engine", "way", "wanted", "given"),
    [
        ("mujoco", "the library's solref, whatever e", 0.4, 0.0),
        ("pybullet", "e on the block alone", 0.8, 0.0),
        ("pymunk", "e on the block alone", 1.0, 0.0),  # a product with 0
        ("rapier", "e on the block alone", 1.0, 0.5),  # a mean with 0
        ("physx", "e on both", 0.6, 0.0),  # below its threshold of 2 m/s
        ("physx", "at all speeds, by TGS", 0.6, 0.6),
    ],
)
def test_a_way_gives_back_what_its_library_makes_of_it(engine, way, wanted, given):
    assert struck(engine, way, wanted)["corner_ratio"] == pytest.approx(given, abs=0.05)


def test_a_library_that_says_it_went_wrong_leaves_no_number(monkeypatch):
    monkeypatch.setattr("engines.mujoco.build.MujocoWorld.fault", lambda _: "it went wrong")
    row = struck("mujoco", "spring and damper over 20 steps", 0.4)
    assert math.isnan(row["rate_ratio"]) and row["message"] == "it went wrong"
    assert row["outcome"] != "failed"  # it is known, and is not asked again


def test_a_line_holds_the_largest_deviations_and_counts_what_broke():
    rows = pd.DataFrame(
        {
            "engine": "pymunk", "way": ["e on the block alone"] * 2 + [[*WAYS["pymunk"]][1]] * 3,
            "varied": ["", "p_dt", "", "p_dt", "aspect"], "wanted": 0.5, "kept_ratio": 0.6,
            "rate_ratio": 0.6, "slide_ratio": [-0.2, 9.0, 0.0, 0.0, 0.0],
            "corner_ratio": [0.0, 0.5, 0.45, 20.0, math.nan],
        }
    )  # fmt: skip
    tables = restitution.tabulate(rows.assign(source="", outcome="struck", message=""))
    plain, other = tables["corners"].to_dict("records")
    assert (plain["off"], plain["off_over_all"]) == (0.5, 0.5)
    assert (plain["slide"], plain["broken"]) == (0.2, 0)
    assert other["off"] == pytest.approx(0.05)
    assert (other["off_over_all"], other["broken"]) == (math.inf, 2)
    assert "pymunk keeps" in finding(tables)


def test_the_best_way_does_not_slide_and_a_tie_goes_to_what_is_usually_closer():
    lines = [
        *(("mujoco", "a", 0.108, 0.2, 0.0), ("mujoco", "b", 0.179, 0.2, 0.0)),
        *(("newton", "a", 0.03, 0.2, 0.0), ("newton", "b", 0.01, 0.06, 1.64)),
        *(("rapier", "a", 0.51, 0.57, 1.06), ("rapier", "b", 0.02, 0.07, 1.44)),
    ]
    corners = pd.DataFrame(lines, columns=["engine", "way", "off", "off_over_all", "slide"])
    assert best_of(corners)["way"].tolist() == ["a", "a", "b"]
    words = finding({"corners": corners})
    assert "1 of 3" in words and "2 of 3" in words and "0.2," in words and "Rapier" in words
    assert "Rapier" in finding({"corners": corners[corners["engine"] == "rapier"]})
