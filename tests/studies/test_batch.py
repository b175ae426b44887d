"""The paper's cases as one batch: what MuJoCo in C gives, and what two runs differ by."""

import math
from dataclasses import make_dataclass

import numpy as np
import pandas as pd
import pytest

from studies import batch, respond
from studies.kit.tables import unpacked
from studies.kit.workers import answers
from studies.measures import batches
from studies.measures.batches import MJX, PAPER, RANDOM, C, all_cases, found_of, spread


def test_a_quick_batch_in_c_is_off_by_what_single_runs_are():
    jobs = [job for job in batch.jobs((), True, batch.Options()) if job.labels["dt_ms"] in (0, 2)]
    rows = [{**job.labels, "source": job.source, **batches.measure(job)} for job in jobs]
    _, line = batch.tabulate(pd.DataFrame(rows))["batch"].to_dict("records")
    assert (line["fall_wrong"], line["rest_wrong"], line["no_answer"]) == (0, 0, 0)
    assert line["median_error"] == pytest.approx(0.0888, abs=5e-5)
    assert line["c_max_error"] == 0.0
    for number, peak in list(
        zip(batches.numbers_of(64, 960), unpacked(rows[1]["peaks"]), strict=True)
    )[::20]:
        case = all_cases()[number]
        single = respond(
            "mujoco:default", case.block, case.motion, frame="base", step=2e-3 * case.block.p
        )
        assert single.peak_ratio == peak


def test_bits_outcomes_and_peaks_that_differ_are_counted():
    first = np.array([0.5, math.inf, math.nan, 0.25])
    found = np.array([first, [0.5, 0.75, math.nan, 0.275]])
    assert spread(found, first) == {
        "bits_differ": 2,
        "outcomes_differ": 1,
        "largest_spread": pytest.approx(0.1),
    }


def test_memory_is_that_of_all_arrays_however_deep():
    inner = make_dataclass("Inner", ["row", "name"])(np.zeros(3), "none")
    outer = make_dataclass("Outer", ["inner", "column"])(inner, np.zeros(2, np.float32))
    assert batches.bytes_of(outer) == 3 * 8 + 2 * 4


def test_worlds_of_mjx_in_float64_are_those_of_c():
    pytest.importorskip("mujoco.mjx")
    asked = {"device": "cpu", "preset": "tuned, impratio 100", "dt_ms": 4, "worlds": 4, "runs": 1}
    asked["case_set"] = PAPER
    plain, batched = (found_of({**asked, "backend": way})["peaks"] for way in (C, MJX))
    assert np.isfinite(plain).sum() >= 2
    assert batched == pytest.approx(plain, rel=1e-8)


def models_of(cases):
    asked = {"frame": "base", "step": 2e-3, "settings": {}}
    for preset in ("recommended", "tuned"):
        batches.batch_of([(case.block, case.motion, preset, asked) for case in cases], 1e-3)


@pytest.mark.slow
def test_a_process_has_room_for_the_models_of_all_random_cases():
    assert dict(answers(models_of, [(all_cases(RANDOM),)], 1, 60.0)) == {0: None}


def test_random_cases_are_no_smaller_larger_or_longer_than_the_papers():
    drawn, paper = (
        [(case.block.p, case.motion.duration + 8.0 / case.block.p) for case in all_cases(kind)]
        for kind in (RANDOM, PAPER)
    )
    (least, _), (most, longest) = np.min(paper, axis=0), np.max(paper, axis=0)
    assert len(set(drawn)) == 500
    assert all(least <= size <= most and end <= longest for size, end in drawn)
