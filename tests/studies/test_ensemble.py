"""Ensembles: families of motions, fragility, agreement one by one and in distribution."""

import itertools
import math

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from scipy.stats import CensoredData, binomtest, lognorm, norm

from analytic import Outcome, Record, RigidBlock, simulate
from studies import respond
from studies.__main__ import run
from studies.ensemble import study
from studies.ensemble.agreement import (
    BOUNDS,
    DIGITS,
    LEAST_RESAMPLES,
    agreement,
    bounds,
    confusion,
    draws_of,
    fit_lognormal,
    fragilities,
    settled,
    share_bounds,
)
from studies.kit.arguments import BadInputError

LEVELS = np.array([1.5, 2.0, 2.5, 3.0, 4.0, 6.0])


@pytest.mark.parametrize("family", study.FAMILIES)
def test_a_family_is_reproducible_and_of_unit_peak(family):
    one, again, other = (study.FAMILIES[family](seed) for seed in (5, 5, 6))
    assert isinstance(one, Record)
    assert one == again
    assert one != other
    assert one.peak == pytest.approx(1.0, rel=1e-12)


def test_cases_are_scaled_to_their_intensity():
    jobs = list(study.ensemble_jobs("near-fault", study.drawn("near-fault", 3, 1), ["exact"]))
    assert len(jobs) == 2 * 3 * 3 * 6
    for job in jobs[::7]:
        onset = 9.81 * math.tan(job.block.alpha)
        peak = job.labels["strength"] * job.labels["intensity"] * onset
        assert job.motion.peak == pytest.approx(peak, rel=1e-12)
    assert [job.labels["strength"] for job in jobs[:4]] == [1.0, 1.01] * 2
    noise = study.drawn("noise", 1, 1)
    gentle = next(study.ensemble_jobs("noise", noise, ["exact"], intensities=[0.999]))
    assert simulate(gentle.block, gentle.motion).outcome is Outcome.AT_REST


def capacities(seed, count=40, median=2.6, beta=0.35):
    drawn = np.random.default_rng(seed).normal(math.log(median), beta, count)
    return np.exp(drawn)[:, None] <= LEVELS


@pytest.mark.parametrize("seed", range(6))
def test_the_fit_is_scipys_of_censored_capacities(seed):
    """An overturning says that the capacity lies below, a survival that it lies above."""
    overturned = capacities(seed)
    fit = fit_lognormal(LEVELS, overturned.sum(axis=0).astype(float), np.full(6, 40.0))
    levels = np.broadcast_to(LEVELS, overturned.shape)
    censored = CensoredData(left=levels[overturned], right=levels[~overturned])
    beta, _, median = lognorm.fit(censored, floc=0)
    assert fit.median == pytest.approx(median, rel=1e-4)
    assert fit.beta == pytest.approx(beta, rel=1e-3)
    expected = norm.cdf(np.log(LEVELS / fit.median) / fit.beta)
    assert fit.probability(LEVELS) == pytest.approx(expected, abs=1e-12)


def test_a_fit_recovers_what_was_put_in():
    """With 20 000 motions the median is known to 0.3 %."""
    overturned = capacities(1, 20_000)
    fit = fit_lognormal(LEVELS, overturned.sum(axis=0).astype(float), np.full(6, 2e4))
    assert fit.median == pytest.approx(2.6, rel=0.01)
    assert fit.beta == pytest.approx(0.35, rel=0.03)


@pytest.mark.parametrize(
    ("overturned", "median"),
    [
        ([0, 0, 0, 8, 8, 8], math.sqrt(2.5 * 3.0)),
        ([0, 0, 3, 8, 8, 8], 2.5),
        ([0] * 6, math.inf),
        ([8] * 6, 0.0),
    ],
)
def test_counts_that_hold_no_spread(overturned, median):
    fit = fit_lognormal(LEVELS, np.array(overturned, float), np.full(6, 8.0))
    assert (fit.median, fit.beta) == (pytest.approx(median), 0.0)
    steps = fit.probability(np.array([1e-3, 1e3]))
    assert steps.tolist() == [float(median == 0.0), float(median < math.inf)]


@pytest.mark.parametrize(
    ("overturned", "level"),
    [
        # a stronger motion spares the block
        ([8, 7, 6, 5, 4, 3], 33 / 48),
        ([3, 3, 3, 3, 3, 3], 18 / 48),
        # it helps so little that even odds are 1e10 onsets away
        ([1, 1, 1, 1, 1, 2], None),
    ],
)
def test_counts_that_hold_no_median(overturned, level):
    fit = fit_lognormal(LEVELS, np.array(overturned, float), np.full(6, 8.0))
    assert math.isnan(fit.median)
    found = fit.probability(LEVELS)
    if level is None:
        assert fit.beta < math.inf
        # a line through the counts: their sum is that of the fit
        assert 8.0 * found.sum() == pytest.approx(sum(overturned), rel=0.02)
        assert found[0] < found[-1]
    else:
        assert fit.beta == math.inf
        assert found == pytest.approx([level] * 6, rel=1e-12)


def test_all_counts_have_a_fit():
    """Whatever two motions do at three intensities; no motion holds nothing."""
    nothing = fit_lognormal(LEVELS, np.zeros(6), np.zeros(6))
    assert math.isnan(nothing.median) and np.isnan(nothing.probability(LEVELS)).all()
    for counts in itertools.product(range(3), repeat=3):
        fit = fit_lognormal(LEVELS[:3], np.array(counts, float), np.full(3, 2.0))
        found = fit.probability(LEVELS)
        assert ((found >= 0.0) & (found <= 1.0)).all()
        assert (np.diff(found) >= 0.0).all()
        known = LEVELS[0] / 10 <= fit.median <= LEVELS[2] * 10
        assert known or fit.median in (0.0, math.inf) or math.isnan(fit.median)


@pytest.mark.parametrize(("unknown", "ends"), [(10, (0.0, math.inf)), (1, (2.0, 2.0))])
def test_what_is_not_determined_may_be_anything(unknown, ends):
    assert bounds(np.array([2.0] * (200 - unknown) + [math.nan] * unknown)) == ends


def test_overturning_that_falls_with_the_intensity_has_no_capacity(tmp_path):
    arguments = ["ensemble", "--quick", "--family", "near-fault", "--sources", "housner"]
    assert run([*arguments, "--out", str(tmp_path)]) == 0
    agreed = pd.read_csv(tmp_path / "agreement.csv").set_index("source")
    assert agreed[["capacity_at_edge", "ratio_at_edge"]].to_numpy().all()
    exact, housner = agreed.loc["exact"], agreed.loc["housner"]
    assert math.isnan(exact["capacity"]) and math.isnan(housner["capacity_ratio"])
    assert (round(exact["capacity_low"], DIGITS), exact["capacity_high"]) == (0.0, math.inf)


def test_bounds_hold_the_truth_as_often_as_they_say():
    """95 % bounds of 24 ensembles of 40 motions: fewer than 19 hits have a chance of 1e-3."""
    hits = 0
    for seed in range(24):
        overturned = capacities(seed).astype(float)
        draws = draws_of(40, 40)
        low, high = bounds(fit_lognormal(LEVELS, draws @ overturned, draws.sum(1)[:, None]).median)
        hits += low <= 2.6 <= high
    assert hits >= 19


def test_the_bounds_of_a_share_are_clopper_pearsons():
    low, high = share_bounds(3, 20)
    # the shares at which so many or more, so many or fewer, have the chance 2.5 %
    assert binomtest(3, 20, low, alternative="greater").pvalue == pytest.approx(0.025, rel=1e-6)
    assert binomtest(3, 20, high, alternative="less").pvalue == pytest.approx(0.025, rel=1e-6)
    assert share_bounds(0, 0) == (0.0, 1.0)


def made_up(change):
    """Return rows of 30 motions: exact, and a source that differs from it as `change` says."""
    draw = np.random.default_rng(3)
    rows = []
    for motion in range(30):
        capacity = math.exp(draw.normal(math.log(2.6), 0.4))
        for level in LEVELS:
            peaks = {"exact": level / capacity, "other": change(level / capacity, motion)}
            rows += [(motion, level, *answer) for answer in peaks.items()]
    table = pd.DataFrame(rows, columns=["motion", "intensity", "source", "peak_ratio"])
    fell = table["peak_ratio"] > 1
    table = table.assign(width_m=0.5, height_m=1.5, outcome=np.where(fell, "overturned", "rocked"))
    return table.assign(peak_ratio=table["peak_ratio"].mask(fell, math.inf))


def judged(rows):
    """Return the line of the other source's agreement."""
    return agreement(rows, fragilities(rows, 200)).set_index("source").loc["other"]


def test_a_source_that_is_exact_agrees_in_all():
    rows = made_up(lambda peak, _: peak)
    row = judged(rows)
    assert (row["right"], row["false"], row["missed"], row["predicted"]) == (180, 0, 0, 1.0)
    assert (row["ks"], row["ks_p"], row["mcnemar_p"]) == (0.0, 1.0, 1.0)
    assert (row["capacity_ratio"], row["ratio_low"], row["ratio_high"]) == (1.0, 1.0, 1.0)
    diagonal = confusion(rows)
    assert (diagonal["outcome"] == diagonal["exact_outcome"]).all()


def test_a_source_that_scatters_is_wrong_one_by_one_and_right_in_distribution():
    """Peaks exchanged among motions: no single one is predicted, their distribution is exact."""
    rows = made_up(lambda peak, _: peak)
    other = rows["source"] == "other"
    for level in LEVELS:
        here = other & (rows["intensity"] == level)
        columns = ["outcome", "peak_ratio"]
        rows.loc[here, columns] = np.roll(rows.loc[here, columns].to_numpy(), 7, axis=0)
    row = judged(rows)
    assert row["predicted"] < 0.6
    assert row["median_error"] > 0.1
    assert row["ks"] == 0.0
    assert row["false"] == row["missed"] > 0
    assert row["mcnemar_p"] == pytest.approx(1.0)
    assert row["capacity_ratio"] == pytest.approx(1.0, rel=1e-6)


def test_a_source_that_is_biased_is_found_out():
    row = judged(made_up(lambda peak, _: 1.5 * peak))
    assert row["capacity_ratio"] == pytest.approx(1 / 1.5, abs=0.06)
    assert row["ratio_high"] < 0.9
    assert row["mcnemar_p"] < 1e-6
    assert row["ks_rejected"] >= 2
    assert row["missed"] == 0 < row["false"]


def test_failed_rows_count_as_failed_and_not_as_survivors():
    rows = made_up(lambda peak, _: peak)
    lost = rows.index[(rows["source"] == "other") & (rows["intensity"] == 4.0)][:5]
    rows.loc[lost, "outcome"], rows.loc[lost, "peak_ratio"] = "failed", math.nan
    row = judged(rows)
    assert (row["failed"], row["right"]) == (5, 175)
    # its capacity is held against the exact one of the same 175 cases
    assert (row["capacity_ratio"], row["ratio_low"], row["ratio_high"]) == (1.0, 1.0, 1.0)
    assert row["predicted"] == pytest.approx(175 / 180)
    table = study.stripes(rows).set_index(["source", "intensity"])
    assert table.loc[("other", 4.0), "cases"] == 25
    assert table["share_low"].le(table["share"]).all()
    assert table["share_high"].ge(table["share"]).all()


def test_twice_as_many_samples_move_no_printed_bound():
    rows = made_up(lambda peak, motion: peak * (1.1 if motion % 3 else 0.9))
    _, agreed = settled(rows)
    samples = agreed["resamples"].iloc[0]
    assert samples > LEAST_RESAMPLES
    twice = agreement(rows, fragilities(rows, 2 * samples))
    assert np.allclose(agreed[BOUNDS], twice[BOUNDS], rtol=0.0, atol=10.0**-DIGITS)
    assert not agreed["ratio_at_edge"].any()


def test_a_bound_beyond_the_intensities_is_marked():
    rows = made_up(lambda peak, _: peak)
    few = rows[rows["intensity"] < 2.6]
    _, agreed = settled(few)
    assert agreed["ratio_at_edge"].all()
    assert (agreed["capacity_high"] > 2.5).all()


def test_curves_rise_between_their_bounds():
    rows = made_up(lambda peak, _: peak)
    table = study.curves(rows, fragilities(rows, 200))
    for _, curve in table.groupby("source"):
        assert (np.diff(curve["probability"]) >= 0).all()
        assert (curve["low"] <= curve["probability"] + 1e-9).all()
        assert (curve["high"] >= curve["probability"] - 1e-9).all()


def test_records_of_the_users_own(tmp_path, capsys):
    paths = []
    for seed in (1, 2):
        motion = study.FAMILIES["ricker"](seed)
        table = np.column_stack([motion.breakpoints, motion.samples])
        paths.append(str(tmp_path / f"{seed}.csv"))
        np.savetxt(paths[-1], table, header="units: m/s2", fmt="%.12g")
    arguments = ["ensemble", "--quick", "--sources", "housner", "--out", str(tmp_path / "out")]
    assert run([*arguments, "--records", *paths]) == 0
    assert "2 motions of 'records'" in " ".join(capsys.readouterr().out.split())
    other = [*arguments, "--records", *paths, "--baseline", "constant"]
    refused(capsys, other, "must be new, or hold results of the same")
    rows = pd.read_csv(tmp_path / "out" / "ensemble.csv")
    block = RigidBlock(width=0.5, height=1.5)
    first = rows[(rows["source"] == "exact") & (rows["strength"] == 1)].iloc[0]
    motion = study.FAMILIES["ricker"](1).scaled_to(first["intensity"] * 9.81 / 3)
    # the file holds twelve digits
    assert first["peak_ratio"] == pytest.approx(simulate(block, motion).peak_ratio, rel=1e-6)


def test_records_are_corrected_by_a_named_method(tmp_path):
    path = tmp_path / "motion.csv"
    path.write_text("t (s),a (m/s2)\n0,1\n0.1,3\n0.2,2\n0.3,4\n")
    assert study.recorded([path], None)[0].samples.tolist() == [1.0, 3.0, 2.0, 4.0]
    assert study.recorded([path], None, "constant")[0].samples.tolist() == [-1.5, 0.5, -0.5, 1.5]
    path.write_text("t (s),a (m/s2)\n0,1\n0.1,1\n0.2,1\n")
    with pytest.raises(BadInputError, match=r"--records is .* its own constant trend"):
        study.recorded([path], None, "constant")


def test_the_help_names_no_empty_default(capsys):
    assert run(["ensemble", "--help"]) == 0
    assert "[default: ]" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--motions", "1000000000"], "GB"),
        (["--records", "FILE", "--seed", "2"], "--seed is 2; it may be given only without --rec"),
        (["--records", "FILE", "--family", "noise"], "--family is noise"),
        (["--records", "FILE", "FILE"], "twice"),
        (["--records", "FILE"], "it is zero throughout"),
        (["--records", "/nowhere"], "--records is '/nowhere'; it must be a file"),
        (["--records"], "--records requires at least 1 element"),
        (["--units", "g"], "--units is g; it may be given only with --records"),
        (["--baseline", "linear"], "--baseline is linear; it may be given only with --records"),
        (["--family", "wind"], "--family"),
    ],
)
def test_bad_input_is_one_clear_line(options, words, tmp_path, capsys):
    path = tmp_path / "still.csv"
    path.write_text("# units: g\n0 0\n0.1 0\n0.2 0\n")
    given = [str(path) if option == "FILE" else option for option in options]
    refused(capsys, ["ensemble", "--out", tmp_path / "out", *given], words)
    assert not (tmp_path / "out").exists()


def test_a_block_that_leans_in_a_soft_contact_comes_to_rest():
    """It lay with both corners 1e-8 m deep in MuJoCo's base, taken for a swing: 500 000 steps.
    A record of 1201 samples should take some steps of 1/200 p each, and some tens an impact."""
    (motion,) = study.drawn("noise", 17, 1)[16:]
    (job, *_) = study.ensemble_jobs("noise", [motion], ["mujoco"], [(1.0, 2.0)], [1.5])
    response = respond("mujoco", job.block, job.motion)
    exact = simulate(job.block, job.motion)
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-4)
    assert response.steps < 10 * (motion.samples.size + 200 * job.block.p * motion.duration)


def test_whose_statistics_are_told_from_the_exact_ones_where_all_or_none_are():
    agreed = pd.DataFrame(
        {
            **{"source": ["housner", "modified"], "cases": 240, "predicted": 0.5},
            **{"mcnemar_p": 1.0, "ks_rejected": 0, "ks_tests": 6},
            **{"ratio_low": 0.9, "ratio_high": 1.1},
        }
    )
    none = "no test tells the statistics of housner and modified from the exact ones."
    assert study.finding(agreed).endswith(none)
    off = agreed.assign(ratio_low=1.1, ratio_high=1.3)
    assert study.finding(off).endswith("the exact statistics those of housner and modified.")
