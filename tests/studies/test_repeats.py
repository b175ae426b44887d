"""How often a run is repeated until its time is known: by counts, not by the clock."""

from dataclasses import replace

import pytest

from analytic.response import Response
from studies.measures.costs import cost_text
from studies.precision import repeats
from studies.precision.repeats import LEAST_S, enough

MOST_S = 4.0 * LEAST_S


@pytest.mark.parametrize(
    ("times", "spent_s", "known"),
    [
        ([1.0] * 5, LEAST_S, True),
        ([1.0] * 4, LEAST_S, False),  # too few
        ([1.0] * 5, 0.9 * LEAST_S, False),  # too cold
        ([1.3, 1.0, 1.03, 1.3, 1.3], LEAST_S, False),  # the shortest came once
        ([1.3, 1.0, 1.03, 1.3, 1.01], LEAST_S, True),
        ([1.3], MOST_S, True),  # nothing more may be spent
    ],
)
def test_a_minimum_is_known_once_it_came_twice(times, spent_s, known):
    assert enough(times, spent_s, MOST_S) is known


def test_the_best_run_is_kept_with_the_least_set_up(monkeypatch):
    monkeypatch.setattr(repeats, "enough", lambda times, spent_s, most_s: len(times) == 3)
    runs = iter([(3.0, 0.1), (1.0, 0.3), (2.0, 0.2)])

    def action():
        wall_s, setup_s = next(runs)
        return replace(Response.failure("timed", wall_s=wall_s), setup_s=setup_s)

    response = repeats.best_of(action, MOST_S)
    assert (response.wall_s, response.setup_s, response.runs) == (1.0, 0.1, 3)


def test_what_takes_longer_than_may_be_spent_runs_once():
    responses = iter([Response.failure("timed")])
    assert repeats.best_of(lambda: next(responses), 0.0).runs == 1
    assert not list(responses)


def test_a_time_of_few_runs_is_marked():
    assert cost_text(0.0124, 5) == "12.4 ms"
    assert cost_text(0.0124, 4) == "12.4 ms (4 runs)"
    assert cost_text(0.0124, 1) == "12.4 ms (1 run)"
