"""Random cases: the draw, the condition number, the report."""

import math
from dataclasses import replace
from itertools import islice

import pandas as pd
import pytest

from analytic import conditioning, frame_faults, simulate
from analytic.response import Outcome
from engines.layouts import BEAM_DEPTH, SPACING
from studies import respond
from studies.__main__ import run
from studies.cases.drawn import FRICTION, LEAST_NORMAL, SLIDES, TIPS, draw, everything, fate_of
from studies.old.journal import FolderError
from studies.old.options import EffortOptions, Running
from studies.old.plan import fill
from studies.measures.differences import (
    sensitivity_of,
    with_conditioning,
    with_reference,
    with_reference_of_frames,
)
from studies.measures.halving import ELSEWHERE, published_trust
from studies.validate import STUDY
from studies.validate.claims import (
    bands,
    bounded,
    finding,
    quantiles,
    worst,
)
from studies.validate.study import plan, report

ALONE = Running(jobs=1)


def test_cases_keep_their_ranges_and_their_reference_valid():
    first, again, other = (list(islice(draw(seed), 40)) for seed in (3, 3, 4))
    assert first == again != other
    for case in first:
        assert 1.2 <= case.aspect <= 12
        assert 0.02 <= case.width_m <= 10
        assert 1.02 <= case.amplitude_g * case.aspect <= 4
        assert 0.3 <= case.omega_over_p <= 12
        assert simulate(case.block, case.motion).min_normal > LEAST_NORMAL


def test_random_frames_keep_their_ranges_and_their_reference_valid():
    kept = list(islice(draw(1, "frame"), 100))
    assert {case.columns for case in kept} == {2, 3, 4, 5}
    assert all(0.1 <= case.load <= 10.0 for case in kept)
    assert [case.case for case in kept] == list(range(100))
    fates = {}
    for drawn, exact in islice(everything(1, "frame"), 100):
        frame, fate = drawn.block, fate_of(drawn, exact)
        sizes = {"spacing": SPACING * frame.height, "depth": BEAM_DEPTH * frame.height}
        faults = frame_faults(frame, drawn.motion, friction=FRICTION, **sizes)
        fates.setdefault(fate, []).append(faults)
    assert all(not faults for faults in fates["kept"])
    assert all("would slide" in faults[0] for faults in fates[SLIDES])
    assert all("the beam would tip" in faults[0] for faults in fates[TIPS])


@pytest.mark.slow
@pytest.mark.parametrize(("preset", "most"), [("landing", 1e-4), ("fixed", 1e-2)])
def test_forty_random_frames_in_mujoco(preset, most):
    """The first that survive by the exact solution, and whose peak moves by less than 10 times."""
    errors: list[float] = []
    for case in draw(1, "frame"):
        block, motion = case.block, case.motion
        exact, (kappa, _) = simulate(block, motion), conditioning(block, motion)
        if exact.outcome is Outcome.ROCKED and abs(kappa) < 10.0:
            found = respond(f"mujoco:{preset}", block, motion)
            errors.append(abs(found.peak_ratio / exact.peak_ratio - 1.0))
        if len(errors) == 40:
            break
    assert max(errors) < most


def test_frames_are_held_against_their_own_reference():
    """Row by row by the exact solution; κ by the peak of a pulse that is a millionth stronger."""
    cases = list(islice(draw(3, "frame"), 12))
    table = pd.DataFrame(
        {name: getattr(case, name) for name in (*PULSED, "columns", "load")} for case in cases
    )
    rows = with_reference_of_frames(table.assign(outcome="rocked", peak_ratio=0.5))
    rocked = rows["exact_outcome"] == "rocked"
    assert 2 <= rocked.sum() < len(rows)
    for case, row in zip(cases, rows.to_dict("records"), strict=True):
        exact = simulate(case.block, case.motion)
        assert row["exact_outcome"] == exact.outcome.value
        assert row["agrees"] == (exact.outcome.value == "rocked")
        if row["agrees"]:
            assert row["exact_peak"] == pytest.approx(exact.peak_ratio, rel=1e-9)
            assert row["error"] == pytest.approx(0.5 / exact.peak_ratio - 1.0, rel=1e-9)
            stronger = replace(case.motion, amplitude=(1.0 + 1e-6) * case.motion.amplitude)
            moved = simulate(case.block, stronger).peak_ratio / exact.peak_ratio - 1.0
            assert 1e6 * moved == pytest.approx(row["kappa"], rel=1e-3)
        else:
            assert math.isnan(row["error"])


PULSED = ("case", "aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p")


@pytest.mark.slow
def test_the_command_asks_random_frames(tmp_path, capsys):
    asked = ["validate", "--scene", "frame", "--cases", "5", "--sources", "mujoco:landing"]
    assert run([*asked, "--out", str(tmp_path), "--jobs", "1"]) == 0
    assert "2 to 5 columns" in capsys.readouterr().out
    errors = pd.read_csv(tmp_path / "errors.csv")
    assert errors["agrees"].all()
    judged = errors["error"].abs() / sensitivity_of(errors)
    assert judged.max() < 1e-5
    drawn = pd.read_csv(tmp_path / "drawn.csv").set_index("set")["cases"]
    assert drawn["kept"] == 5
    assert drawn["drawn"] == drawn[["kept", "near", "lifted", SLIDES, TIPS]].sum()


def test_a_report_counts_the_cases_that_were_drawn(tmp_path):
    fill(STUDY, plan(60, 5, ["exact"]), tmp_path, ALONE)
    report(tmp_path)
    table = pd.read_csv(tmp_path / "drawn.csv", keep_default_na=False).set_index("set")
    errors = pd.read_csv(tmp_path / "errors.csv")
    assert table.loc["kept", "cases"] == len(errors) == 60
    assert table.loc["kept", "overturned"] == (errors["exact_outcome"] == "overturned").sum()
    assert table.loc["drawn", "cases"] == table.loc["kept":, "cases"].sum()


def test_condition_number_of_a_block_that_overturns_is_no_number():
    case = pd.DataFrame(
        {"aspect": [4.0], "amplitude_g": [2.0], "omega_over_p": [0.5], "half_cycles": [1]}
    )
    assert with_conditioning(case)[["kappa", "kappa_eta"]].isna().all(axis=None)


NEAR_ONSET = {
    "aspect": 9.174363250019729 / 1.5256313519414122,
    "amplitude_g": 0.17396032278997067,
    "omega_over_p": 1.6703236997469597,
    "half_cycles": 2,
}
"""An uplift that comes with a ten thousandth less of the pulse: the peak is 68 % larger."""


def test_errors_are_judged_against_what_finite_errors_do():
    table = pd.DataFrame([NEAR_ONSET]).assign(source="box2d", outcome="rocked", peak_ratio=0.016)
    case = with_reference(table)
    assert abs(case["kappa"][0]) < 100 and abs(case["kappa_eta"][0]) < 100
    assert sensitivity_of(case)[0] == case["sensitivity"][0] == pytest.approx(6775, abs=1)
    assert with_reference(case).equals(case)  # a table has the columns added that it lacks
    kappas = case.assign(kappa=1e5, kappa_eta=-2e5)
    assert sensitivity_of(kappas)[0] == 2e5


def test_the_headline_says_the_largest_errors_as_they_are():
    rows = pd.DataFrame(
        {
            "source": ["mujoco", "mujoco", "box2d", "box2d"],
            "error": [1e-6, 0.47, -0.02, 0.95],
            **dict.fromkeys(["kappa", "kappa_eta"], 2.0),
            "sensitivity": [2.0, 1e4, 2.0, 1e4],
            "agrees": True,
            **dict.fromkeys(["outcome", "exact_outcome"], "rocked"),
            **dict.fromkeys(["aspect", "width_m", "half_cycles", "omega_over_p"], 2.0),
            "amplitude_g": 0.6,
        }
    )
    claim = finding(rows)
    assert "off by up to 47 % and 95 %; where neither" in claim
    assert "reaches 10, by 10⁻⁶ and 2 %." in claim


def test_errors_are_shown_as_they_are_in_bands_of_peak_and_kappa():
    rows = pd.DataFrame(
        {
            "source": ["mujoco"] * 5,
            "exact_peak": [0.005, 0.05, 0.1, 0.7, math.inf],
            "exact_outcome": ["rocked"] * 4 + ["overturned"],
            "agrees": [True, True, True, False, True],
            "error": [3.66, -0.2, 1e-3, math.nan, math.nan],
            "kappa": [76.0, 2.0, 10.0, -300.0, math.nan],
            "kappa_eta": [1.0, 3.0, 1.0, 1.0, math.nan],
        }
    )
    table = bands(rows)
    found = table.set_index(["by", "band"])
    assert list(found["cases"]) == [1, 1, 1, 1, 1, 2, 1]
    assert found.loc[("peak", "from 0.1 to 0.5"), "max_error"] == 1e-3
    assert found.loc[("peak", "above 0.5"), "right"] == 0
    assert found.loc[("κ", "from 10 to 100"), "max_error"] == 3.66
    assert math.isnan(found.loc[("κ", "above 100"), "max_error"])
    assert list(found.loc["peak", "median_error"].dropna()) == [3.66, 0.2, 1e-3]
    (line,) = quantiles(rows.assign(outcome="rocked")).to_dict("records")
    assert (line["cases"], line["agree"], line["fall_wrong"]) == (5, 4, 1)
    assert (line["median_error"], line["max_error"]) == (0.2, 3.66)


def test_the_worst_case_is_one_that_is_wrong():
    columns = ["aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p", "exact_peak"]
    rows = pd.DataFrame(
        {
            "source": ["mujoco"] * 4 + ["box2d"],
            "case": [0, 1, 2, 3, 0],
            "error": [0.1, -0.4, math.nan, 0.2, 0.9],
            "agrees": [True, True, False, True, True],
            **dict.fromkeys(["outcome", "exact_outcome"], "rocked"),
            **dict.fromkeys([*columns, "kappa", "kappa_eta", "sensitivity"], 2.0),
        }
    )
    shown = worst(rows, 2)
    assert list(zip(shown["source"], shown["case"], strict=True)) == [
        ("box2d", 0),
        ("mujoco", 2),
        ("mujoco", 1),
    ]


def test_a_folder_grows_and_its_report_says_what_is_exact(tmp_path):
    fill(STUDY, plan(4, 5, ["exact"]), tmp_path, ALONE)
    kept = (tmp_path / "journal.jsonl").read_text().splitlines()
    rows = fill(STUDY, plan(9, 5, ["exact", "housner"]), tmp_path, ALONE)
    assert len(rows) == 18
    assert (tmp_path / "journal.jsonl").read_text().splitlines()[: len(kept)] == kept
    report(tmp_path)
    errors = pd.read_csv(tmp_path / "errors.csv").set_index("source")
    assert errors.loc["exact", "agrees"].all()
    assert (errors.loc["exact", "error"].dropna().abs() < 1e-9).all()
    assert set(pd.read_csv(tmp_path / "bands.csv")["source"]) == {"exact", "housner"}
    assert (errors["sensitivity"] >= 0.0).all()
    assert errors.loc["housner", "error"].abs().max() > 1e-3


def test_random_cases_carry_estimates_and_what_these_bound(tmp_path):
    asked = plan(4, 5, ["exact", "mujoco", "moreau"], EffortOptions(step=0.02), estimate=True)
    rows = fill(STUDY, asked, tmp_path, ALONE)
    halves = [row for row in rows if row["table"] == "halves"]
    assert [(row["case"], row["source"]) for row in halves] == [
        (case, source) for case in range(4) for source in ("mujoco", "moreau")
    ]
    text = report(tmp_path)
    errors = pd.read_csv(tmp_path / "errors.csv").set_index(["source", "case"])
    finer = {row["case"]: row["peak_ratio"] for row in halves if row["source"] == "mujoco"}
    assert errors.loc["exact", ["estimate", "bound"]].isna().all(axis=None)
    mine = errors.loc["mujoco"]
    known = mine[mine["outcome"] == "rocked"]
    assert len(known)
    for case, row in known.iterrows():
        assert row["estimate"] == pytest.approx(abs(row["peak_ratio"] / finer[case] - 1), rel=1e-12)
        bound = row["estimate"] * published_trust("mujoco").factor
        assert row["bound"] == pytest.approx(bound, rel=1e-12)
    line, other = bounded(errors.reset_index()).to_dict("records")
    assert line["factor"] == published_trust("mujoco").factor
    assert line["survivors"] == len(known)
    assert line["bounded"] == (known["error"].abs() <= known["bound"]).sum()
    assert other["source"] == "moreau" and math.isnan(other["factor"]) and not other["bounded"]
    assert errors.loc["moreau", "bound"].isna().all()
    assert f"({ELSEWHERE})" in text


def test_a_model_has_no_half_steps_and_another_seed_is_refused(tmp_path):
    fill(STUDY, plan(2, 5, ["exact"], estimate=True), tmp_path, ALONE)
    text = report(tmp_path)
    assert "half the step" not in text
    assert not (tmp_path / "halves.csv").exists()
    with pytest.raises(FolderError, match="settings"):
        fill(STUDY, plan(2, 2, ["exact"]), tmp_path, ALONE)
