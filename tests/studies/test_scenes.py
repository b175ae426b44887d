"""Frames, slides and floors: what is asked, how far off an answer is, and the line of a source."""

import math
from dataclasses import replace
from itertools import islice

import numpy as np
import pandas as pd
import pytest

from analytic import conditioning, simulate
from analytic.response import Outcome, Reason, Response
from studies import scenes
from studies.cases.drawn import calm_frames, slides
from studies.kit.jobs import unanswered
from studies.kit.run import run
from studies.kit.tables import split
from studies.scenes import finding, jobs, measure, tabulate

FRAME_ROW = {
    **{"scene": "frame", "source": "pymunk:tuned", "columns": 2, "load": 2.0, "amplitude_g": 0.4},
    **{"omega_over_p": 2.0, "case": 0, "reason": "", "message": ""},
    **{"outcome": "rocked", "steps": 10, "wall_s": 1e-3, "exact": 0.2, "right": True},
    **{"error": 1e-3, "parting": 0.0, "tilt": 0.0, "drift_m": 0.0},
}
SLIDE_ROW = {
    **{"scene": "slide", "source": "pymunk:tuned", "case": 0, "reason": "", "wall_s": 1e-3},
    **{"outcome": "slid", "slips": 2, "exact_slips": 2, "slip_error_m": 2e-3, "lift_m": 0.0},
    **{"verdict": "right", "slip_error": 1e-3, "message": ""},
}


def of(rows, name):
    return tabulate(split(rows, "scene"))[name].to_dict("records")


def test_a_source_has_one_line_of_its_frames():
    wrong = {"source": "newton", "error": 0.03, "outcome": "overturned", "right": False}
    first, other = of([FRAME_ROW, {**FRAME_ROW, **wrong}], "frame-summary")
    assert (first["frames"], first["wrong"], first["max_error"]) == (1, 0, 1e-3)
    assert (other["source"], other["wrong"], other["max_error"]) == ("newton", 1, 0.03)


@pytest.mark.parametrize(("part", "right"), [(0.09, False), (0.11, True)])
def test_a_frame_that_hardly_moves_misses_the_rocking(part, right):
    job = jobs(["dart:default"], True)[0]
    peak = part * simulate(job.case.system, job.case.motion).peak_ratio
    row = measure(replace(job, lost=Response(outcome=Outcome.ROCKED, peak_ratio=peak)))
    assert (row["right"], row["error"] == pytest.approx(part - 1.0)) == (right, right)


def test_a_block_that_is_held_is_no_wrong_slide_and_what_is_not_built_counts_nowhere():
    held = {**SLIDE_ROW, "exact_slips": 0, "slip_error_m": math.nan, "outcome": "at rest"}
    held, crept = ({**held, "case": number} for number in (1, 2))
    crept |= {"outcome": "slid", "slip_error_m": 1e-4}
    fewer = {**SLIDE_ROW, "case": 3, "slip_error_m": math.nan, "verdict": "missed slip"}
    unbuilt = {**SLIDE_ROW, "source": "newton", "reason": Reason.UNAVAILABLE.name}
    thrown = {**SLIDE_ROW, "case": 4, "verdict": "thrown off"}
    (line,) = of([SLIDE_ROW, held, crept, fewer, unbuilt, thrown], "slide-summary")
    assert (line["slides"], line["wrong"], line["thrown_off"]) == (5, 2, 1)
    assert (line["largest_slip_error_m"], line["creep_m"]) == (2e-3, 1e-4)
    needed = scenes.STUDY.needed([SLIDE_ROW, unbuilt])
    assert needed == [SLIDE_ROW]


def test_the_finding_takes_the_worst_engine_of_the_best_presets():
    frames = pd.DataFrame({
        "source": ["exact", "mujoco:default", "mujoco:landing", "box2d:default"],
        "max_error": [0.0, 0.5, 1e-5, 0.2], "wrong": [0, 3, 0, 1],
    })  # fmt: skip
    none = dict.fromkeys(("frame-summary", "slide-summary"), pd.DataFrame())
    words = finding(none | {"frame-summary": frames})
    assert "20 %" in words and "1 wrong" in words and "50 %" not in words
    slides = pd.DataFrame({
        "source": ["exact", "drake:default"], "max_error": 0.0, "wrong": [0, 1],
        "thrown_off": [0, 1],
    })  # fmt: skip
    words = finding(none | {"slide-summary": slides})
    assert "1 wrong" in words and "Drake" in words
    assert "None" in finding(none | {"slide-summary": slides[:1]})


def test_frames_are_summed_up_beside_the_critical_rotation():
    errors = enumerate((1e-3, -1e-3, 2e-3, -0.5))
    rows = [{**FRAME_ROW, "case": case, "error": error} for case, error in errors]
    lost = {"case": 4, "error": math.nan, "outcome": "failed", "right": False, "reason": "PARTED"}
    instead = {**rows[0], "source": "pymunk", "message": "as pymunk:tuned; it slid"}  # twice one
    (line,) = of([*rows, {**FRAME_ROW, **lost}, instead], "frame-summary")
    (other,) = of(
        [{**row, "columns": 3} for row in (rows[3], {**FRAME_ROW, **lost})], "frame-summary"
    )
    assert [other[name] for name in ("frames", "more", "more_wrong", "more_parted")] == [0, 2, 1, 1]
    assert other["more_median_error"] == 0.5
    assert (line["frames"], line["wrong"], line["more"]) == (5, 1, 0)
    assert (line["median_error"], line["max_error"]) == pytest.approx((1.5e-3, 0.5))
    assert line["p90_difference"] == pytest.approx(0.2 * np.quantile([1e-3, 1e-3, 2e-3, 0.5], 0.9))


def test_random_cases_are_calm_or_slide_as_far_as_can_be_seen():
    for frame in islice(calm_frames(3), 4):
        assert frame.columns <= 4 and 0.2 <= frame.load <= 6.0
        assert 0.0 < max(map(abs, conditioning(frame.block, frame.motion))) < 10.0
    drawn = [*islice(slides(3), 20)]
    assert drawn == [*islice(slides(3), 20)]
    for box, pulse in drawn:
        ways = [abs(slip) / box.width for slip in simulate(box, pulse).slips]
        assert min(ways) > 1e-3 and sum(ways) < 10.0


def test_landing_steps_are_asked_about_frames_alone_and_every_source_about_the_same_cases():
    asked = jobs(["pymunk:tuned", "mujoco"], False)
    of_whom = [(job.labels["scene"], job.source) for job in asked]
    counts = {kind: of_whom.count(kind) for kind in of_whom}
    frames = {("frame", "pymunk:tuned"): 60, ("frame", "mujoco"): 60}
    assert counts == {**frames, ("slide", "pymunk:tuned"): 61}
    for one, other in zip(asked[:120:2], asked[1:120:2], strict=True):
        assert one.case == other.case and one.labels == other.labels


def test_rows_are_measured_and_a_process_that_ended_is_a_row():
    found = jobs(["exact", "pymunk:default"], True)
    tables = tabulate(split(run(found, measure), "scene"))
    frame = tables["frame-summary"].set_index("source")
    assert frame.loc["exact", "max_error"] == 0.0 < frame.loc["pymunk:default", "max_error"]
    slide = tables["slide-summary"].set_index("source")
    assert slide.loc["exact", "largest_slip_error_m"] == 0.0
    assert slide.loc["pymunk:default", "creep_m"] > 0.0
    floor = tables["floor-summary"].set_index("floor")["carried"]
    assert abs(floor["position"]) < 1e-2 < 0.99 < floor["velocity"] < 1.01
    lost = Response.failure("the process ended")
    for job in found:
        row = measure(type(job)(labels=job.labels, case=job.case, source=job.source, lost=lost))
        assert row["outcome"] == Outcome.FAILED.value and row.keys() > unanswered("").keys()
