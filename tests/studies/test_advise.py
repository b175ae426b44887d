"""Advice: lines to paste, what they are worth, and the cheapest setting that keeps an error."""

import math

import numpy as np
import pandas as pd
import pytest
from given import BLOCK

from analytic import GRAVITY, simulate
from engines import ENGINES
from engines.declaration import AT_REST, PASTED
from engines.registry import OWN
from studies.__main__ import run
from studies.advise import STUDY, cheapest, jobs, pasted_lines, steps_of, unadvised
from studies.kit.tables import table_in
from studies.measures.differences import WELL_CONDITIONED, sensitivity_of
from studies.measures.presets import pasted_of
from studies.measures.published import PUBLISHED, TARGETS, settings

CORE = [name for name, engine in ENGINES.items() if engine.core]
HERE = [name for name in OWN if ENGINES[name].installed]
QUOTED = {
    "mujoco": ('<default><geom solref="-2500.0 -500.0"', 'solimp="0.9999 0.9999 0.001"'),
    "pybullet": (
        "contactBreakingThreshold=0.001",
        "numSolverIterations=100",
        "lateralFriction=0.7",
    ),
    "physx": ("enable_tgs=False", "contact_offset=0.0001", "PhysxMaterial(0.7, 0.7, 0.0)"),
    "drake": ("='similar'", f"point_stiffness={8.0 * 375.0 / 0.002**2}", "CoulombFriction(0.7"),
    "dart": ("NsgsFrictionSolver()", "mEnabled = False"),
    "rapier": (
        "SpringCoefficients(1000.0, 1.0)",
        "prediction_distance = 0.001",
        "can_sleep(False)",
    ),
    "newton": ("dynamics_solver='dvi'", "gamma = 0.0"),
}
"""What must be quoted for a step of 2 ms, a friction of 0.7 and a block of 375 kg."""


@pytest.mark.parametrize("engine", [name for name in QUOTED if name in HERE])
def test_lines_quote_what_the_preset_sets_at_a_step_and_a_friction(engine):
    text = "\n".join(pasted_lines(engine, BLOCK, 0.002, 0.7))
    assert [words for words in QUOTED[engine] if words not in text] == []
    preset = ENGINES[engine].preset(pasted_of(engine))
    assert preset.name != PASTED or all(map(all, preset.documented))


@pytest.mark.parametrize("engine", HERE)
def test_advice_is_one_screen(engine, capsys):
    assert run(["advise", "--engine", engine, "--dt", "0.002", "--friction", "0.8"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert f"{engine}:{pasted_of(engine)}" in lines[0]


def test_the_published_advice_follows_from_its_boxes():
    boxes, advice = (table_in(PUBLISHED / "advice", name) for name in ("boxes", "advice"))
    assert set(advice["engine"]) == set(OWN) and set(advice["cases"]) == {60}
    calm = boxes[(sensitivity_of(boxes) < WELL_CONDITIONED) & (boxes["kind"] == "pulse")]
    for line in advice.to_dict("records"):
        same = [calm[name] == line[name] for name in ("engine", "dt_s", "preset")]
        errors = calm[same[0] & same[1] & same[2]]["error"].abs()
        assert line["median_error"] == pytest.approx(errors.median(), nan_ok=True)
        assert line["max_error"] == pytest.approx(errors.max(), nan_ok=True)
    assert "mujoco" not in unadvised(advice) and "pybullet" not in unadvised(advice)


@pytest.mark.parametrize(
    ("after", "why"),
    [
        ({}, ""),
        ({"median_error": 0.1}, "typical error goes from 1 % to 10 %"),
        ({"max_error": 0.02}, "largest error goes from 2 % to 2 %"),
        ({"max_error": math.nan}, "largest"),
        ({"fall_wrong": 2}, "from 1 to 2"),
    ],
)
def test_a_setting_is_advised_where_median_and_largest_error_fall_at_both_steps(after, why):
    before = {"engine": "mujoco", "median_error": 0.01, "max_error": 0.02, "fall_wrong": 1}
    before |= {"rest_wrong": 0, "no_answer": 0}
    better = {**before, "median_error": 1e-3, "max_error": 2e-3}
    steps = ((0.002, better), (0.001, {**better, **after}))
    lines = [{**it, "dt_s": dt_s} for dt_s, best in steps for it in (before, best)]
    found = unadvised(pd.DataFrame(lines))
    assert why in found["mujoco"] if why else not found


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.8, 1.2])
def test_ten_free_boxes_rock_right_with_pasted_lines(friction, monkeypatch):
    pytest.importorskip("pybullet")
    monkeypatch.setattr("studies.advise.FRICTION", friction)
    asked = [job for job in jobs(CORE, quick=True) if job.labels["kind"] == "pulse"]
    rows = [{**job.labels, "source": job.source, **STUDY.measure(job)} for job in asked]
    advice = STUDY.tabulate(pd.DataFrame(rows))["advice"]
    assert unadvised(advice) == {} and len(advice) == 8
    pasted = advice[advice["preset"] == PASTED]
    assert (pasted[["max_error", "yaw_deg", "slip_widths"]].max() < [5e-4, 1e-3, 2e-4]).all()
    assert advice.loc[advice["preset"] == AT_REST, "max_error"].min() > 1e-2
    steps = {job.labels["dt_s"] for job in asked if job.labels["engine"] == "mujoco"}
    assert steps == {*steps_of("mujoco")} == {2e-3, 1e-3}


def test_boxes_are_moved_by_pulses_by_a_record_and_from_a_lean():
    asked = jobs(["mujoco"], quick=True)[:14]
    assert [job.labels["kind"] for job in asked] == [*["pulse"] * 10, "record", *["lean"] * 3]
    assert {job.case.start for job in asked[:11]} == {(0.0, 0.0)}
    for job in asked[10:]:
        lean, least = job.labels["lean"], simulate(job.case.system, job.case.motion).peak_ratio
        assert job.case.start[0] == lean * job.case.system.alpha
        peak_g = abs(job.case.motion.acceleration(np.linspace(0.0, 20.0, 100_001))).max() / GRAVITY
        assert peak_g == pytest.approx(job.labels["amplitude_g"], rel=1e-4)
        assert least > 0.0 and (0.0 < abs(lean) < 0.6) == (job.labels["kind"] == "lean")


@pytest.mark.parametrize("target", [1.0, 1e-2, 1e-9])
def test_the_cheapest_setting_keeps_the_error_with_every_finer_step(target):
    known, lines = settings(PUBLISHED, CORE), cheapest(PUBLISHED, CORE, [target])
    found = {(row.engine, row.preset): row for row in lines.itertuples()}
    for use, mine in known.groupby(["engine", "preset"]):
        kept = []
        for line in list(mine.itertuples())[::-1]:  # from fine to coarse, to the first that misses
            if line.max_error > target:
                break
            kept.append(line.wall_s)
        assert (use in found) == bool(kept)
        if kept:
            assert found[use].wall_s == min(kept) and found[use].max_error <= target
            assert found[use].dt_s == pytest.approx(found[use].value / BLOCK.p)


def test_a_dial_is_no_step(capsys):
    assert run(["advise", "--engine", "drake", "--error", *map(str, TARGETS)]) == 0
    (dial, *_) = cheapest(PUBLISHED, ["drake"], [1e-2]).query("preset == 'error-controlled'").dt_s
    assert "error-controlled" in capsys.readouterr().out and math.isnan(dial)
