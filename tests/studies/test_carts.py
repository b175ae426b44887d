"""A block on a cart: from the command line, from Python, in the study of scenes; its identity."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from commanding import refused

from analytic import CartBlock, RigidBlock, SinePulse, Still, cart_demands, simulate
from analytic.response import History, Impact, Outcome, Response
from engines import ENGINES
from engines.declaration import Stepping
from studies import respond
from studies.__main__ import run
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, summary
from studies.measures.carts import impact_ratio, place_error
from studies.scenes.carts import CARTS, OBSERVED, PULSES, carts
from studies.scenes.study import needed, reduce
from studies.scenes.summaries import tabulate

CART = CartBlock(width=0.5, height=1.5, mass_ratio=0.5)
PULSE = SinePulse.in_g(0.6, omega=20.0, half_cycles=2)
SIZE = ("--width", "0.5", "--height", "1.5", "--amplitude", "0.6", "--omega", "20")
OF_A_CART = ("--scene", "cart", "--mass-ratio", "0.5")


def test_a_cart_is_compared(capsys):
    asked = ["compare", *SIZE, *OF_A_CART, "--sources", "exact", "mujoco", "--json"]
    assert run(asked) == 0
    exact, found = map(json.loads, capsys.readouterr().out.splitlines())
    assert exact["peak_ratio"] == simulate(CART, PULSE).peak_ratio
    # where in a step an impact falls costs up to half a per cent
    assert found["peak_ratio"] == pytest.approx(exact["peak_ratio"], rel=5e-3)
    assert found["message"] == "as mujoco:fixed"
    assert found["momentum_error"] < 1e-8
    assert exact["place_error_m"] == 0.0 < found["place_error_m"] < 1e-3
    high, low = (
        simulate(CART, SinePulse.in_g(0.6 * part, omega=20.0, half_cycles=2)).peak_ratio
        for part in (1.001, 0.999)
    )
    assert exact["kappa"] == pytest.approx(math.log(high / low) / 0.002, rel=1e-2)


def test_a_cart_in_words(capsys):
    asked = ("--stiffness", "5", "--sources", "exact", "newton", "mujoco:landing")
    assert run(["compare", *SIZE, *OF_A_CART, *asked]) == 1
    said = capsys.readouterr().out
    assert said.startswith("cart    m/(m+M) = 0.5, k/(m+M) = 5 /s², block B = 0.5 m, H = 1.5 m: ")
    assert "valid   with friction of 0.44" in said
    words = "is not built here for a base that feels what stands on it"
    assert f"newton: not available: Newton {words}" in said
    assert f"mujoco:landing: not available: mujoco:landing {words}" in said


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--scene", "cart"), "--mass-ratio missing; a cart requires the block's mass over"),
        ((*OF_A_CART[:2], "--mass-ratio", "1"), "--mass-ratio is 1.0; it must be between 0 and 1"),
        ((*OF_A_CART[:2], "--mass-ratio", "0"), "--mass-ratio is '0'; it must be a positive"),
        ((*OF_A_CART[:2], "--mass-ratio", "nan"), "--mass-ratio is 'nan'; it must be a positive"),
        ((*OF_A_CART, "--stiffness", "-1"), "--stiffness is '-1'; it must be a finite number, 0"),
        (("--mass-ratio", "0.5"), "--mass-ratio is 0.5; it may be given only with --scene cart"),
        (("--stiffness", "2"), "--stiffness is 2.0; it may be given only with --scene cart"),
        ((*OF_A_CART, "--load", "2"), "--load is 2"),
        ((*OF_A_CART, "--estimate"), "--estimate is True; it may be given only on a base that"),
        ((*OF_A_CART, "--sources", "rk45"), "rk45 solves a base that moves as it is told"),
        ((*OF_A_CART, "--sources", "housner"), "housner solves a base that moves as it is told"),
    ],
)
def test_bad_input_is_one_line(options, problem, capsys):
    refused(capsys, ["compare", *SIZE, *options], problem)


def test_from_python():
    found = respond("pymunk", CART, PULSE, times=np.array([0.1, 0.3]))
    assert found.peak_ratio == pytest.approx(simulate(CART, PULSE).peak_ratio, rel=5e-3)
    assert found.history.base.shape == (2, 2)
    with pytest.raises(ValueError, match="option is 'nothing'"):
        respond("mujoco", CART, PULSE, nothing=1)


def test_a_cart_is_made_by_code_of_its_own_and_a_block_not_by_it():
    makers = Makers(ask, summary)
    for block, holds in ((CART, True), (RigidBlock(width=0.5, height=1.5), False)):
        job = Job(labels={}, block=block, motion=PULSE, source="mujoco:fixed")
        made = makers.of(job)
        assert ("engines/mujoco/cart.py" in made) == ("engines/cart.py" in made) == holds
        names = makers.reached(job).names
        assert (("engines.mujoco.cart", "MujocoCart") in names) == holds
        assert ("engines.pybullet.cart", "BulletCart") not in names
        assert job.key == Job(labels={}, block=block, motion=PULSE, source="mujoco:fixed").key


def test_what_is_held_against_the_exact_cart():
    times = np.array([0.0, 1.0, 2.0])
    still, moved = (
        History(times[:n], times[:n], times[:n], np.array([by * times[:n], times[:n]]))
        for n, by in ((3, 1.0), (2, 1.5))
    )
    whole, short = (Response(outcome=Outcome.ROCKED, peak_ratio=1.0, history=it)
                    for it in (still, moved))  # fmt: skip
    assert place_error(short, whole) == place_error(whole, short) == 0.5
    assert math.isnan(place_error(Response.failure("lost"), whole))
    slow, fast = Impact(2.0, 0.1, 0.0), (Impact(0.0, 1.0, 0.8), Impact(1.0, -0.6, -0.3))
    struck = Response(outcome=Outcome.ROCKED, peak_ratio=1.0, impacts=(*fast, slow))
    assert impact_ratio(struck) == pytest.approx(0.65)
    assert math.isnan(impact_ratio(whole))


def test_the_cases_ask_for_no_more_than_a_contact_can_bear():
    """Tuned presets have a friction of 1.3 at least; who falls, and who survives by how much."""
    fallen = 0
    for (ratio, stiffness), (amplitude_g, omega) in ((c, p) for c in CARTS for p in PULSES):
        cart = CartBlock(width=0.5, height=1.5, mass_ratio=ratio, stiffness=stiffness)
        pulse = SinePulse.in_g(amplitude_g, omega=omega, half_cycles=2)
        end = pulse.duration + OBSERVED / cart.p
        needs = cart_demands(cart, pulse, duration=end)
        assert needs.friction < 1.3 and needs.normal > 0.2
        fell = simulate(cart, pulse, duration=end).outcome is Outcome.OVERTURNED
        assert fell <= (omega == PULSES[-1][1])
        fallen += fell
    assert fallen == 4


def test_the_study_tells_carts_apart():
    sources = ["exact", "mujoco:naive", "pymunk:fixed", "newton:fixed"]
    rows = [
        {**job.labels, "source": job.source, **reduce(job, ask(job, job.asked))}
        for job in carts(sources, True)
    ]
    assert [row["source"] for row in needed(rows)].count("newton:fixed") == 0
    tables = tabulate(rows)
    lines = tables["cart-summary"].set_index("source")
    assert list(lines.index) == sources[:-1]
    assert lines.loc["exact", "largest_error"] == 0.0 == lines.loc["exact", "place_error_m"]
    assert lines.loc["pymunk:fixed", "largest_error"] < 5e-3
    assert lines.loc["pymunk:fixed", "median_eta_error"] < 5e-3
    assert lines.loc["mujoco:naive", "median_eta_error"] > 0.1
    assert "scene" not in tables["cart"]
    assert set(tables["cart-steps"]["refined"]) == {1.0}


def test_one_cart_is_asked_again_in_other_steps():
    """What takes no equal steps is asked once."""
    asked = list(carts(["exact", "box2d:fixed"], False))
    engine = pd.DataFrame([{**job.labels, **job.options} for job in asked if job.asked.engine])
    own = ENGINES["box2d"].preset("fixed").step
    assert ENGINES["box2d"].preset("fixed").stepping is Stepping.FIXED
    first = engine.groupby("refined")["step"].min()
    assert first.to_dict() == pytest.approx({part: part * own for part in (0.5, 1.0, 2.0, 4.0)})
    assert len([job for job in asked if job.source == "exact"]) == len(CARTS) * len(PULSES)
    assert len({job.key for job in asked}) == len(asked)


def test_a_cart_is_sampled_from_its_start_to_the_last_of_the_times():
    times = np.array([0.0, 2.0])
    asked = [("exact", m, t) for m, t in ((Still(), times[:1]), (Still(), times), (PULSE, times))]
    for source, motion, wanted in (*asked, ("mujoco", Still(), times[:1])):
        history = respond(source, CART, motion, times=wanted).history
        assert history.time.tolist() == wanted.tolist()
        assert history.base.shape == (2, len(wanted)) and history.base[0, 0] == 0.0


def test_nothing_moves_a_cart_at_rest():
    assert respond("mujoco", CART, Still(), duration=0.1).outcome is Outcome.AT_REST
