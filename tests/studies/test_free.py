"""Free rocking of the sources against the closed forms."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from given import BLOCK

from analytic import MODELS, RigidBlock, Still
from analytic.criteria import free_amplitude, quarter_period
from analytic.response import Outcome
from engines import core_engines
from engines.scene import ACCURACIES
from studies.free import STUDY
from studies.free import errors as free
from studies.free.errors import crest, next_amplitude, reduce, swing_times
from studies.free.study import plan, released, report
from studies.kit.jobs import ask
from studies.kit.options import Running
from studies.kit.plan import fill
from studies.sources.registry import SOURCES, resolve


@pytest.mark.parametrize("source", [*MODELS, "rk4", "dop853", *core_engines()])
def test_the_block_is_released(source):
    """At rest, from the tilt, on ground that does not move: nothing lifts it, its start is its
    peak, and it begins to fall at once, to its impact in a quarter period."""
    job = released(3.0, 0.4, source)
    assert job.motion == Still()
    response = ask(job, resolve(source))
    tilt = 0.4 * job.block.alpha
    assert response.peak_ratio == pytest.approx(0.4, rel=1e-12)
    assert response.uplifts == ()
    assert response.history.theta[0] == pytest.approx(tilt, rel=1e-12)
    # a source of second order in steps of p dt = 1/200 or less
    fall = quarter_period(job.block, tilt, resolve(source).model)
    assert response.impacts[0].time == pytest.approx(fall, rel=200**-2)


@pytest.mark.parametrize("model", ["housner", "modified", "onset-matched"])
def test_next_amplitude_is_that_of_the_linear_energy(model):
    saddle = math.tan(BLOCK.alpha) if model == "modified" else BLOCK.alpha
    theta = 0.4 * BLOCK.alpha
    after = next_amplitude(BLOCK, theta, model)
    energy, later = (x * (2 * saddle - x) for x in (theta, after))
    assert later == pytest.approx(BLOCK.restitution**2 * energy, rel=1e-13)


def test_crest_of_a_parabola_between_samples():
    t = np.linspace(0, 1, 21)
    theta = 1.0 - (t - 0.513) ** 2
    assert crest(theta, np.arange(21)) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("source", [*MODELS, *core_engines()])
def test_sources_rock_as_the_closed_forms_of_their_models(source):
    job = released(3.0, 0.7, source)
    row = reduce(job, ask(job, job.asked))
    assert row["swings"] == free.SWINGS
    # of models that of a parabola through samples of a crest, of engines the band of the sweep
    band = 1e-9 if source in MODELS else 1e-4
    assert row["period_error"] < band
    assert row["decay_error"] < band


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize(("aspect", "tilt"), [(1.5, 0.1), (1.5, 0.9), (10.0, 0.9)])
def test_the_rotation_after_an_impact(engine, aspect, tilt):
    """What the contact leaves in the block at an impact is as small as a step's own error,
    (p dt)^2 / 2, wherever the impact's share of the energy is large."""
    job = released(aspect, tilt, engine)
    row = reduce(job, ask(job, resolve(engine)))
    assert row["swings"] == free.SWINGS
    assert row["decay_error"] < 0.5 / ACCURACIES["standard"] ** 2


def test_the_impacts_that_are_timed():
    slender, squat = (RigidBlock(width=1.0, height=aspect) for aspect in (4.0, 1.5))
    fall = 0.9 * slender.alpha
    times = swing_times(slender, fall, "exact")
    assert len(times) == free.IMPACTS - 1
    last = free_amplitude(slender, fall, free.IMPACTS - 1)
    assert times[-1] == pytest.approx(2.0 * quarter_period(slender, last), rel=1e-12)
    # a squat block loses its swings before
    count = len(swing_times(squat, 0.9 * squat.alpha, "exact"))
    least = free.LEAST_SWING * squat.alpha
    assert free_amplitude(squat, 0.9 * squat.alpha, count) >= least
    assert free_amplitude(squat, 0.9 * squat.alpha, count + 1) < least


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize("aspect", [1.5, 10.0])
def test_many_impacts_drift_no_further_than_their_errors_add_up(engine, aspect):
    """An error of (p dt)^2 / 2 an impact, over some twenty of them."""
    job = released(aspect, 0.9, engine)
    row = reduce(job, ask(job, resolve(engine)))
    error = 0.5 / ACCURACIES["standard"] ** 2
    assert row["timed_impacts"] > 5
    assert abs(row["drift_p"]) < error * row["timed_impacts"]


def test_a_late_impact_is_a_drift():
    job = released(4.0, 0.5, "exact")
    response = ask(job, resolve("exact"))
    late = response.impacts[: free.IMPACTS - 1] + tuple(
        impact._replace(time=impact.time + 1e-3 / job.block.p)
        for impact in response.impacts[free.IMPACTS - 1 :]
    )
    assert abs(reduce(job, response)["drift_p"]) < 1e-9
    row = reduce(job, replace(response, impacts=late))
    assert row["drift_p"] == pytest.approx(1e-3, abs=1e-9)
    missed = reduce(job, replace(response, impacts=late[: free.IMPACTS - 1]))
    assert math.isnan(missed["drift_p"])


def test_a_failed_source_has_no_errors(tmp_path, monkeypatch, capsys):
    def fails(*_, **__):
        raise RuntimeError("no")

    source = resolve("exact")
    monkeypatch.setitem(SOURCES, "fails", type(source)("model", fails))
    rows = fill(STUDY, plan(["exact", "fails"], quick=True), tmp_path, Running(jobs=1))
    assert len(rows) == 2 * 2 * 2
    assert {row["outcome"] for row in rows if row["source"] == "fails"} == {Outcome.FAILED.value}
    assert re.search(r"^fails .* - +- +-$", report(tmp_path), re.MULTILINE)
