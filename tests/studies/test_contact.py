"""Contact: variants and their tables; one impact, and what becomes of its restitution."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from analytic.response import Response
from engines import ENGINES, installed_engines
from engines.declaration import PASTED
from engines.factors import AS_BEST, BEST, BY_DEFAULT, DEFAULT, OWN_STEPS
from studies import contact, restitution
from studies.cases.paper import chosen_cases
from studies.cases.ways import WAYS, damping_ratio, given_back
from studies.contact import STILL, newton_e, variants
from studies.kit.run import run
from studies.restitution import best_of, finding, job_of, measure

CASES = chosen_cases(True)["typical"][:2]
SETTINGS = [
    # preset, factor, level, peaks over the exact ones of two cases
    (BEST, "", "tuned", (1.01, 1.02)),
    (BEST, "cone", BY_DEFAULT, (1.03, 1.30)),
    (BEST, "friction", BY_DEFAULT, (1.01, 1.02)),
    (DEFAULT, "", "documented", (1.5, 1.5)),
    (DEFAULT, "cone", AS_BEST, (1.5, math.nan)),
    (DEFAULT, "friction", AS_BEST, (1.5, math.inf)),
]


@pytest.fixture
def rows():
    found = [
        {
            **{"engine": "mujoco", "preset": preset, "factor": factor, "level": level},
            **{"trap": "", "own_step": False, "set": "typical", "figure": case.figure},
            **{"pulse": case.pulse, "excess_g": case.excess_g, "aspect": case.aspect},
            **{"omega_over_p": case.omega_over_p, "source": f"mujoco:{preset}"},
            **{"outcome": "rocked", "peak_ratio": ratio, "wall_s": 1.0, "steps": 100},
            **{"ratio_over_eta": 1.0, "newton_e": 0.0, "slip_widths": 0.0, "sink_widths": 0.0},
            **{"energy_growth": 0.0, "message": ""},
        }
        for preset, factor, level, ratios in SETTINGS
        for case, ratio in zip(CASES, ratios, strict=True)
    ]
    table = pd.DataFrame(found)
    exact = contact.with_reference(table)["exact_peak"]
    outcome = table["peak_ratio"].map(
        lambda ratio: {math.inf: "overturned"}.get(ratio, "failed" if ratio != ratio else "rocked")
    )
    return table.assign(outcome=outcome, peak_ratio=table["peak_ratio"] * exact)


def test_a_line_holds_the_errors_and_what_broke(rows):
    own = rows[rows["preset"] == DEFAULT].assign(own_step=True)
    tables = contact.tabulate(pd.concat([rows, own]))
    assert len(tables["own-steps"]) == 3
    lines = tables["variants"].set_index(["preset", "factor"])
    assert lines.loc[(BEST, "cone"), "max_error"] == pytest.approx(0.30)
    assert lines.loc[(BEST, "cone"), "step_s"] == pytest.approx(0.01)
    assert lines["failed"].tolist() == [0, 0, 0, 0, 1, 0]
    assert lines["wrong"].tolist() == [0, 0, 0, 0, 0, 1]
    assert lines["worse"].tolist() == [False, False, False, False, True, True]


def test_the_finding_names_the_setting_that_errs_most_at_its_default(rows):
    tables = contact.tabulate(rows)
    for part in ("MuJoCo", "cone", "30 %"):
        assert part in contact.finding(tables)
    table = contact.left_at_default(tables["variants"])
    assert table["factor"].tolist() == ["cone", "friction"]
    assert table["as_tuned"].tolist() == pytest.approx([0.02, 0.02])
    calm = {"variants": tables["variants"].query("factor != 'cone'")}  # errs as much as tuned
    assert "MuJoCo" not in contact.finding(calm)
    assert contact.finding(contact.tabulate(rows[rows["factor"] == ""])).endswith(".")


@pytest.mark.parametrize("engine", installed_engines())
def test_what_changes_the_defaults_is_asked_at_the_library_s_own_step_too(engine):
    jobs = contact.jobs((), True, contact.Options(engines=(engine,)))
    own = [job for job in jobs if job.labels["own_step"]]
    asked = {(job.labels["factor"], job.labels["level"]) for job in own}
    mine = [v for v in variants(engine) if v.preset == DEFAULT]
    assert asked == {(v.factor, v.level) for v in mine if v.factor != OWN_STEPS}
    still = [job for job in jobs if job.labels["level"] == STILL]
    assert {job.options["frame"] for job in still} <= {"base"}
    assert not any("step" in job.options for job in (*own, *still))
    assert len({job.key for job in jobs}) == len(jobs)


def test_what_is_pasted_is_tried_whole_and_without_each_of_its_settings():
    tried = [(v.level, v.settings) for v in variants("mujoco") if v.preset == PASTED][1:]
    assert tried == [
        ("impedance", {"impedance": None}),
        ("geom reference", {"geom_reference": None}),
    ]


@pytest.mark.parametrize("engine", [name for name in installed_engines() if ENGINES[name].stacks])
def test_of_frames_every_preset_is_asked_that_holds_one(engine):
    jobs = contact.jobs((), True, contact.Options(engines=(engine,), scene="frame"))
    built = {use.name for use in ENGINES[engine].presets if use.stacked is not None}
    assert {job.labels["preset"] for job in jobs} == built & {v.preset for v in variants(engine)}


def test_one_variant_of_a_block_and_of_a_frame():
    asked = [contact.Options(engines=("mujoco",), scene=scene) for scene in ("block", "frame")]
    jobs = [contact.jobs((), True, options)[0] for options in asked]
    block, frame = run(jobs, contact.measure)
    assert block["ratio_over_eta"] == pytest.approx(1.0, rel=0.1)
    assert block["newton_e"] == pytest.approx(
        contact.newton_e(block["velocity_ratio"], jobs[0].case.system.alpha)
    )
    assert frame["outcome"] == "rocked" and math.isnan(frame["newton_e"])


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
