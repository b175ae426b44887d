"""Contact models: which variants are asked, and what a table of them says."""

import math

import pandas as pd
import pytest

from engines import ENGINES, installed_engines
from engines.factors import AS_BEST, BEST, BY_DEFAULT, DEFAULT, OWN_STEPS
from studies import contact
from studies.cases.paper import chosen_cases
from studies.cases.variants import STILL, variants
from studies.kit.run import run

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
    """Rows of a small study of MuJoCo, whose errors and outcomes are known."""
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


def test_a_line_holds_the_errors_what_moved_and_what_broke(rows):
    own = rows[rows["preset"] == DEFAULT].assign(own_step=True)
    tables = contact.tabulate(pd.concat([rows, own]))
    assert len(tables["own-steps"]) == 3
    lines = tables["variants"].set_index(["preset", "factor"])
    assert lines.loc[(BEST, "cone"), "max_error"] == pytest.approx(0.30)
    assert lines.loc[(BEST, "cone"), "moved"] == pytest.approx(1.30 / 1.02 - 1.0)
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
