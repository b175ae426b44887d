"""Ground motions that are straight between samples, alone and through every source."""

import math
import pickle

import numpy as np
import pytest
from declared import Miss, equal_to, held_to
from given import BLOCK, ONSET, WANDERING, noise, onset_of
from independent import history_under_samples

from analytic import MODELS, Outcome, Record, RigidBlock, conditioning, integrate, simulate
from engines import ENGINES, installed_engines
from engines.declaration import UNTUNED
from studies import respond
from studies.sources.registry import SOURCES


def test_acceleration_is_numpys_interpolation():
    times = np.linspace(-0.5, 2.5, 401)
    expected = np.interp(times, 0.3 * np.arange(7), WANDERING.samples, left=0, right=0)
    assert WANDERING.acceleration(times) == pytest.approx(expected, abs=1e-14)
    assert WANDERING.acceleration(WANDERING.breakpoints) == pytest.approx(WANDERING.samples)


def test_a_trend_is_taken_away_by_least_squares():
    """What is left is orthogonal to the trend, and the trend is added back by hand."""
    draw = np.random.default_rng(2).normal(size=101)
    place = np.linspace(-1.0, 1.0, 101)
    record = Record(dt=0.05, samples=draw + 3.0 - 2.0 * place)
    for kind, order in (("constant", 0), ("linear", 1)):
        left = record.detrended(kind)
        across = [left.samples @ place**power for power in range(order + 1)]
        assert across == pytest.approx([0.0] * (order + 1), abs=1e-11)
        trend = np.polynomial.Polynomial.fit(place, record.samples, order)(place)
        assert left.samples + trend == pytest.approx(record.samples, abs=1e-12)
    assert record.final_velocity == pytest.approx(float(record.velocity(99.0)), rel=1e-14)


def test_a_record_is_a_value():
    assert WANDERING.peak == 3.0
    assert WANDERING.scaled_to(1.5) == WANDERING.scaled(0.5)
    assert WANDERING.scaled(-1.0).displacement(1.7) == -WANDERING.displacement(1.7)
    copy = pickle.loads(pickle.dumps(WANDERING))
    assert (copy, hash(copy)) == (WANDERING, hash(WANDERING))
    for other in (WANDERING.scaled(2.0), Record(dt=0.2, samples=copy.samples), "a record"):
        assert other != WANDERING
    with pytest.raises(ValueError, match="read-only"):
        WANDERING.samples[0] = 1.0


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(5))
def test_every_model_against_scipy(model, seed):
    """DOP853 at rtol 1e-12, restarted at every sample, its error grown by up to 12 impacts."""
    draw = np.random.default_rng(seed)
    block = RigidBlock(width=draw.uniform(0.2, 1), height=draw.uniform(2, 4))
    record = noise(seed, 60, 0.05, draw.uniform(1.5, 2.5) * onset_of(block))
    times = np.linspace(0, record.duration, 91)
    expected, impacts = history_under_samples(model, block, record.dt, record.samples, times)
    response = simulate(block, record, model, times=times)
    assert [impact.time for impact in response.impacts][: len(impacts)] == pytest.approx(
        impacts, rel=1e-8
    )
    if response.outcome is not Outcome.OVERTURNED and len(impacts) < 12:
        found = response.history.theta
        assert found == pytest.approx(expected, abs=1e-8 * np.abs(found).max())


def test_a_sample_at_the_onset_itself_lifts_nothing():
    for shape in ([0, 1, 0], [0, 1, 1, 1, 0], [1, 1], [0.5, 1, 0.5, -1, -1, 0.25], [1, -1, 1, -1]):
        record = Record(dt=0.1, samples=ONSET * np.array(shape))
        assert simulate(BLOCK, record).outcome is Outcome.AT_REST
        assert simulate(BLOCK, record.scaled(1 + 1e-9)).outcome is Outcome.ROCKED


@pytest.mark.parametrize("excess", [1e-14, 9e-13, 1e-9])
def test_what_exceeds_the_onset_for_long_overturns(excess):
    """A block held a part e beyond its onset turns by e cosh(p t): sixty e-folds are enough."""
    held = Record(dt=60.0 / BLOCK.p, samples=ONSET * (1.0 + excess) * np.ones(2))
    for model in ("exact", "modified"):
        assert simulate(BLOCK, held, model).outcome is Outcome.OVERTURNED
    assert integrate(BLOCK, held).outcome is Outcome.OVERTURNED


@pytest.mark.parametrize("seed", range(30))
def test_excursions_too_small_to_matter_do_not_matter(seed):
    """A part 1e-10 more or less of samples at the onset makes excursions down to 1e-30 of alpha;
    they may change no later peak by more than its conditioning times that part."""
    draw = np.random.default_rng(seed)
    block = RigidBlock(width=1.0, height=draw.uniform(1.1, 8))
    shape = draw.integers(-6, 7, size=14) / 4
    shape[-3:] = 0.0
    record = Record(dt=draw.choice([0.02, 0.1]), samples=onset_of(block) * shape)
    responses = [simulate(block, record.scaled(1.0 + part)) for part in (0.0, -1e-10, 1e-10)]
    assert len({response.outcome for response in responses} - {Outcome.AT_REST}) <= 1
    peaks = [response.peak_ratio for response in responses]
    if math.isfinite(peaks[0]):
        assert peaks == pytest.approx([peaks[0]] * 3, rel=1e-4, abs=1e-9)


RECORD = noise(3, 140, 0.02, 1.5 * ONSET)
KAPPA = 6.0
BANDS = dict.fromkeys(UNTUNED, 0.6)
BANDS |= {"tuned": 0.1, "error-controlled": 0.02, "landing": 2e-4, "": 1e-3}
"""Largest error of a history over its peak, with κ = 6: defaults lose impacts, fixed steps are of
first order in five, error control keeps 4e-4 at κ = 1, landing is of second order or rounds."""


EACH = [name for name, source in SOURCES.items() if source.kind != "engine"]
EACH += [f"{name}:{use.name}" for name in installed_engines() for use in ENGINES[name].presets]
DEAR = ("pymunk:tuned", "newton:tuned", "drake:error-controlled")
"""They take as long as all the others together; their engines' other presets stand for them."""
DRAGGED = "pybullet:default"
"""Its damping of 0.04, in the world's frame, drags a block on a floor of 9 m/s."""
SUNK = "pymunk:default"
"""Its block sinks in by 12 mm as it rests, never lifts by as much, and is called at rest."""


def missing(name):
    """Return the marks of a source that is declared to miss a record."""
    engine, _, preset = name.partition(":")
    return held_to(Miss.RECORD, engine, preset) if preset else []


def band(name):
    source, _, preset = name.partition(":")
    return max(BANDS[preset], KAPPA * equal_to(source)) if source in ENGINES else BANDS[preset]


def followed(name, record, **options):
    """Return the exact response of a source's own model, and what the source makes of a record."""
    exact = simulate(BLOCK, record, name if name in MODELS else "exact", **options)
    response = respond(name, BLOCK, record, **options)
    assert response.outcome is exact.outcome is Outcome.ROCKED, response.message
    return exact, response


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[*missing(name), *[pytest.mark.slow] * (name in DEAR)])
        for name in EACH
    ],
)
def test_every_source_takes_a_record(name):
    """Each source against the exact solution of its own model, while the ground moves and after."""
    times = np.linspace(0.0, RECORD.duration + 1.0, 120)
    exact, response = followed(name, RECORD, times=times, duration=times[-1])
    assert len(exact.impacts) >= 5
    worst = np.abs(response.history.theta - exact.history.theta).max()
    assert worst < band(name) * np.abs(exact.history.theta).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.xfail(strict=True)] * (name in (DRAGGED, SUNK)))
        for name in EACH
        if not missing(name) and name not in DEAR
    ],
)
def test_a_long_record_through_every_source(name):
    """40 s at 0.005 s, 192 impacts, three times at rest and lifted again twice, κ = 9."""
    exact, response = followed(name, noise(5, 8001, 0.005, 1.3 * ONSET))
    assert len(exact.rests) >= 2
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=2.0 * band(name))


SQUAT = RigidBlock(width=1.0, height=2.0)
BURSTS, SAMPLES, DT = 40, 500, 0.01

ERROR_OVER_CONDITION = {"dop853": 1e-9, "rk45": 1e-9, "mujoco": 1e-5, "pybullet": 1e-5}
"""Largest error of a peak over the condition number of its case: the peers' relative tolerance; for
the engines, whose landing steps of p dt = 1/200 are of second order, less than half of (p dt)^2.
Measured: 2e-15 to 7e-12, and 6e-8 to 7e-7."""


def bursts(seed, width):
    """Return bursts of noise, correlated over `width` [s], each followed by as long a silence."""
    draw = np.random.default_rng(seed)
    parts = []
    for _ in range(BURSTS):
        burst = noise(draw, SAMPLES // 2, DT, 1.0, width)
        parts += [
            burst.scaled_to(draw.uniform(1.1, 1.5) * onset_of(SQUAT)).samples,
            np.zeros(SAMPLES // 2),
        ]
    return Record(dt=DT, samples=np.concatenate(parts))


CASES = {"well conditioned": bursts(2, 0.05), "less well": bursts(1, 0.08)}


@pytest.mark.parametrize("case", CASES)
def test_a_block_that_rests_and_rises_dozens_of_times(case):
    record = CASES[case]
    exact = simulate(SQUAT, record)
    assert record.samples.size == 20_000
    assert exact.outcome is Outcome.ROCKED
    assert len(exact.uplifts) == len(exact.rests) >= 48
    assert all(up < down for up, down in zip(exact.uplifts, exact.rests, strict=True))
    assert exact.min_normal > 0.5
    assert exact.friction_needed < 0.6
    assert np.abs(record.acceleration(exact.uplifts)) == pytest.approx(onset_of(SQUAT), rel=1e-9)
    mirrored = simulate(SQUAT, record.scaled(-1.0))
    assert (mirrored.peak_ratio, mirrored.rests) == (exact.peak_ratio, exact.rests)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("source", ERROR_OVER_CONDITION)
def test_unlike_sources_give_the_same_outcome_and_peak(source, case):
    record = CASES[case]
    exact, found = simulate(SQUAT, record), respond(source, SQUAT, record)
    assert found.outcome is exact.outcome is Outcome.ROCKED, found.message
    band = ERROR_OVER_CONDITION[source] * abs(conditioning(SQUAT, record)[0])
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=band)
    if found.uplifts:
        # a block at rest rises where the record passes the onset, and an engine sees it within a
        # step; where the record passes slowly, a corner that bears next to nothing may be off
        late = np.subtract(found.uplifts, exact.uplifts)
        loads = np.abs(record.acceleration(np.array(found.uplifts))) / onset_of(SQUAT)
        assert np.all((np.abs(late) < 1.0 / (200.0 * SQUAT.p)) | (np.abs(loads - 1.0) < 3e-3))
        assert np.all((np.abs(late) < DT) & (np.abs(loads - 1.0) < 1e-2))
