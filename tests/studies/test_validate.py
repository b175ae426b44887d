"""Random cases: what is drawn, errors, estimates; and one count of what is wrong."""

import math
from itertools import islice

import numpy as np
import pandas as pd
import pytest
from given import BLOCK, PULSE

from analytic import Outcome, frame_demands, simulate
from engines.scene import BEAM_DEPTH, SPACING
from studies import respond, validate
from studies.cases.drawn import FRICTION, LEAST_NORMAL, draw
from studies.kit.jobs import Job, Question
from studies.kit.run import run
from studies.measures import halving
from studies.measures.differences import sensitivity_of, summarize, with_reference
from studies.measures.halving import Trust, estimate_of, factors, halved, step_of
from studies.measures.wrongness import FALL, KINDS, MEANINGS, NO_ANSWER, REST, kinds_of
from studies.sources.registry import core_sources
from studies.validate import STUDY, Options, beside_errors, finding, jobs


def test_cases_keep_their_ranges_and_their_reference_valid():
    first, again, other = (list(islice(draw(seed), 40)) for seed in (3, 3, 4))
    assert first == again != other
    for case in first:
        assert 1.2 <= case.aspect <= 12 and 0.02 <= case.width_m <= 10
        assert 1.02 <= case.amplitude_g * case.aspect <= 4 and 0.3 <= case.omega_over_p <= 12
        assert simulate(case.block, case.motion).min_normal > LEAST_NORMAL


def test_random_frames_neither_slide_nor_tip():
    kept = list(islice(draw(1, "frame"), 8))
    assert {2, 5} < {case.columns for case in kept} <= {2, 3, 4, 5}
    for case in kept:
        height = case.block.height
        sizes = {"spacing": SPACING * height, "depth": BEAM_DEPTH * height}
        needs = frame_demands(case.block, case.motion, **sizes)
        assert needs.spacing < sizes["spacing"] and needs.pressing > LEAST_NORMAL
        assert max(needs.base, needs.top) <= FRICTION


def table(rows, **columns):
    """Return rows of sources that survive, as errors.csv has them, with some other values."""
    names = ("aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p")
    ordinary = {
        **dict.fromkeys((*names, "kappa", "kappa_eta", "sensitivity"), 2.0),
        **dict.fromkeys(("outcome", "exact_outcome"), "rocked"),
        **{"agrees": True, "exact_peak": 0.3, "error": 0.0, "case": range(len(rows))},
    }
    return pd.DataFrame({"source": rows, **ordinary, **columns})


def test_the_finding_names_the_best_and_the_worst_source():
    errors = table(
        ["exact"] * 2 + ["mujoco"] * 3 + ["box2d"],
        error=[0.0, 0.0, 1e-6, -0.4, 1e-7, math.nan],
        sensitivity=[2.0, 1e4, 2.0, 1e4, 2.0, 2.0],
        agrees=[True] * 5 + [False],
    )
    words = finding({"errors": errors})
    assert "MuJoCo" in words and "all 3" in words and "0.0001 %" in words
    assert "Box2D" in words and "1 outcome" in words and "Exact" not in words


@pytest.mark.parametrize(
    ("whole", "half", "found"),
    [
        (("rocked", 0.303), ("rocked", 0.3), 0.01),
        (("rocked", 0.3), ("overturned", math.inf), math.inf),
        (("overturned", math.inf), ("overturned", math.inf), 0.0),
        (("at rest", 0.0), ("at rest", 0.0), 0.0),
        (("failed", math.nan), ("rocked", 0.3), math.nan),
        (("rocked", 0.3), ("failed", math.nan), math.nan),
    ],
)
def test_an_estimate_is_the_difference_of_two_runs(whole, half, found):
    rows = [dict(zip(("outcome", "peak_ratio"), pair, strict=True)) for pair in (whole, half)]
    assert estimate_of(*rows) == pytest.approx(found, nan_ok=True)


def job(source, **options):
    return Job(labels={}, case=Question(system=BLOCK, motion=PULSE), source=source, options=options)


@pytest.mark.parametrize("source", [*core_sources("", "default"), "pymunk:tuned"])
def test_half_the_step_takes_about_twice_the_steps(source):
    asked = job(source) if source.endswith("default") else job(source, step=0.02)
    finer = halved(asked)
    assert finer.options["step"] == 0.5 * step_of(asked)
    whole, half = (respond(j.source, BLOCK, PULSE, **j.options).steps for j in (asked, finer))
    assert 1.4 < half / whole < 2.2  # landing steps spend some on impacts whatever the step is


def test_a_step_in_words_is_halved_as_a_number_and_a_model_has_none():
    finer = halved(job("mujoco", accuracy="tight"))
    assert step_of(job("mujoco", accuracy="tight")) == 1.0 / 800
    assert step_of(job("mujoco", accuracy="tight", step=0.01)) == 0.01
    assert finer.options == {"step": 1.0 / 1600}
    assert [halved(job(source)) for source in ("exact", "rk4", "dop853")] == [None] * 3


def estimated(errors, differences, use=halving.CALIBRATE):
    exact = respond("exact", BLOCK, PULSE).peak_ratio
    posed = {"aspect": 3.0, "half_cycles": 2, "amplitude_g": PULSE.amplitude / BLOCK.gravity}
    rows = [
        {"case": case, "source": "mujoco:default", **posed, "omega_over_p": PULSE.omega / BLOCK.p}
        | {"outcome": "rocked", "peak_ratio": ratio, "half": half, "set": use}
        for case, (error, difference) in enumerate(zip(errors, differences, strict=True))
        for half, ratio in enumerate(
            (exact * (1.0 + error), exact * (1.0 + error) / (1.0 + difference))
        )
    ]
    return beside_errors(pd.DataFrame(rows))


def test_a_factor_is_a_quantile_of_error_over_estimate_and_tried_on_other_cases():
    found = estimated([1e-3 * n for n in range(1, 101)], [1e-3] * 100)
    assert found["over"].to_numpy() == pytest.approx(range(1, 101), rel=1e-6)
    other = estimated([0.02, 0.2], [1e-3] * 2, use=halving.TEST)
    (line,) = factors(pd.concat([found, other])).to_dict("records")
    assert line["factor_95"] == pytest.approx(95.0, rel=1e-6)
    assert line["factor_95_low"] < 95.0 < line["factor_95_high"]
    assert (line["cases"], line["tested"], line["bounded"]) == (100, 2, 1)
    # an error that is none needs no estimate
    assert list(estimated([1e-11, 1e-3], [0.0, 0.0])["over"]) == [0.0, math.inf]


@pytest.mark.parametrize(
    ("count", "last"), [(0, math.inf), (71, math.inf), (72, 72.0), (300, 293.0)]
)
def test_the_upper_end_of_a_factor_is_one_of_the_values_or_there_is_none(count, last):
    """All of 71 values are below the 95 % quantile with 0.95^71 = 0.026 > 2.5 %."""
    assert halving.interval(np.arange(1.0, count + 1.0))[1] == last


def test_above_thirty_estimates_there_is_no_bound():
    assert not Trust(halving.MOST_TRUSTED, 300).warning() and Trust(31.0, 300).warning()
    known = pd.DataFrame({"source": ["mujoco", "dart"], "factor_95_high": [1.6, 48.0]})
    assert "1.6" in (words := finding({"factors": known})) and "1 of 2" in words
    published = pd.read_csv(halving.FACTORS).set_index("source")["factor_95_high"]
    assert halving.published_trust("mujoco:landing").factor == published["mujoco"]
    assert halving.published_trust("moreau") is None


def tables_of(*sources, **options):
    asked = jobs(sources, False, Options(**options))
    return STUDY.tabulate(pd.DataFrame(run(asked, STUDY.measure)))


def test_the_exact_solution_has_no_error():
    tables = tables_of("exact", "housner", cases=30, seed=5)
    errors = tables["errors"].set_index("source")
    assert len(errors) == 2 * 30
    assert errors.loc["exact", "error"].abs().max() < 1e-9 < errors.loc["housner", "error"].max()
    assert (errors["sensitivity"] >= 0.0).all()
    frames = tables_of("mujoco", scene="frame", cases=2)["errors"]
    assert frames["agrees"].all() and {"columns", "load"} <= {*frames}
    assert (frames["error"].abs() / sensitivity_of(frames)).max() < 1e-5


def test_cases_that_test_come_first_each_with_its_half(monkeypatch):
    monkeypatch.setattr(validate, "TESTS", (1, 1))
    tables = tables_of("mujoco", halves=True, cases=2, seed=3)
    rows = tables["estimate"]
    assert list(rows["half"]) == [0, 1] * 3
    assert list(rows["set"]) == [halving.TEST] * 2 + [halving.CALIBRATE] * 4
    # of second order: half the step has a fourth of the error, the difference is three fourths
    assert tables["estimates"]["over"].to_numpy() == pytest.approx([4.0 / 3.0] * 3, rel=0.1)


REST_WORD, ROCKED, OVER, _, FAILED = (outcome.value for outcome in Outcome)


@pytest.mark.parametrize(
    ("found", "peak", "right", "exact_peak", "kind"),
    [
        (OVER, math.inf, OVER, math.inf, ""),
        *((OVER, math.inf, right, peak, FALL) for right, peak in ((REST_WORD, 0.0), (ROCKED, 0.2))),
        *((found, peak, OVER, math.inf, FALL) for found, peak in ((REST_WORD, 0.0), (ROCKED, 0.2))),
        # a tenth of the exact peak tells rest from rocking, whatever a contact's depth says
        *((word, 0.00249, ROCKED, 0.0025, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.021, ROCKED, 0.2057, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.020, ROCKED, 0.2057, REST) for word in (REST_WORD, ROCKED)),
        # and a hundredth of the critical rotation, where there is no exact peak
        *((word, 0.009, REST_WORD, 0.0, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.011, REST_WORD, 0.0, REST) for word in (REST_WORD, ROCKED)),
        (ROCKED, 0.0, ROCKED, 0.0, ""),
        *((found, 0.2, ROCKED, 0.2, NO_ANSWER) for found in (FAILED, "slid", math.nan)),
        (FAILED, math.nan, OVER, math.inf, NO_ANSWER),
    ],
)
def test_each_answer_is_right_or_of_one_kind(found, peak, right, exact_peak, kind):
    assert list(kinds_of([found], [peak], [right], [exact_peak])) == [kind]


def test_nothing_is_wrong_beside_no_reference():
    with pytest.raises(ValueError, match="an exact outcome is none of"):
        kinds_of([ROCKED], [0.2], [FAILED], [math.nan])


def test_a_summary_has_a_column_for_each_kind():
    columns = ["outcome", "peak_ratio", "width_m", "omega_over_p"]
    found = [(ROCKED, 0.011, 0.5, 4.0), (REST_WORD, 0.0, 1.0, 4.0), (REST_WORD, 0.0, 0.5, 3.9)]
    found += [(FAILED, math.nan, 1.0, 3.9), (OVER, math.inf, 0.5, 3.8), (ROCKED, 0.5, 0.5, 0.1)]
    labels = {"figure": 6, "pulse": "half-sine", "excess_g": 0.05, "aspect": 2.0, "wall_s": 1e-3}
    compared = with_reference(pd.DataFrame(found, columns=columns).assign(source="it", **labels))
    assert list(compared["agrees"]) == [True, False, False, False, False, False]
    line, (error, *_) = summarize(compared).iloc[0], compared["error"]
    assert (line["survivors"], line["median_error"]) == (1, abs(error))
    assert line["max_difference"] == pytest.approx(abs(error) * compared["exact_peak"].iloc[0])
    assert {kind: line[kind] for kind in MEANINGS} == {FALL: 2, REST: 2, NO_ANSWER: 1}
    assert line["agree"] + sum(line[kind] for kind in KINDS) == line["cases"]
    assert (line["false_overturnings"], line["missed_overturnings"]) == (1, 1)
    assert line["wall_s"] == pytest.approx(6e-3)
