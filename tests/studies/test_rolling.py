"""A cylinder that rolls: from the command line, from Python, and in the study of the scenes."""

import json
import math

import numpy as np
import pytest
from commanding import refused

from analytic import RollingCylinder, SinePulse, Still
from analytic.response import RollingOutcome
from engines.space import Track
from studies import respond
from studies.__main__ import run
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, short
from studies.measures.rolling import reduced
from studies.scenes.rolling import cylinders
from studies.scenes.summaries import tabulate
from studies.sources.rolling import _outcome, seen, space_scene, steady_states

FLAT = RollingCylinder(radius=0.5, height=0.5, tilt=0.2)
SIZE = ("--scene", "cylinder", "--radius", "0.5", "--height", "0.5", "--tilt", "0.2")


def test_the_exact_one_is_seen_as_it_is():
    found = respond("exact", FLAT, Still(), times=[0.0, 0.5, 1.0], duration=1.0)
    assert found.outcome is RollingOutcome.ROLLED
    assert found.outcome.sentence == "the cylinder rolled on its rim"
    assert max(map(abs, found.observables.values())) < 1e-12
    assert found.history.theta == pytest.approx([0.2] * 3, abs=1e-12)
    assert found.history.velocity == pytest.approx([0.0] * 3, abs=1e-9)


def test_what_is_seen_has_its_sign():
    """A state that is put off on purpose: ahead by 0.1 rad, up by 1 mm, aside by 5 mm."""
    scene, times = space_scene(FLAT, Still()), np.linspace(0.0, 1.0, 101)
    states = steady_states(FLAT, times + 0.1 / FLAT.precession)
    states[:, :3] += (3e-3, 4e-3, 1e-3)
    _, found = seen(FLAT, scene, Track(times, states, 0, 0.0, 0.0, None, ""))
    assert found["phase_error_rad"] == pytest.approx(0.1, abs=1e-12)
    assert found["height_drift_m"] == pytest.approx(1e-3, abs=1e-12)
    assert found["aside_m"] == pytest.approx(5e-3, abs=1e-12)
    assert found["energy_change"] == pytest.approx(9.81e-3 / FLAT.energy, rel=1e-9)
    assert found["sink_m"] == 0.0
    steeper = RollingCylinder(radius=0.5, height=0.5, tilt=0.25)
    other = steady_states(steeper, times)
    tilts, found = seen(FLAT, scene, Track(times, other, 0, 0.0, 0.0, None, ""))
    assert found["tilt_error_rad"] == pytest.approx(0.05, abs=1e-12)
    late = (steeper.precession - FLAT.precession) * 1.0
    assert found["phase_error_rad"] == pytest.approx(late, abs=1e-9)
    assert _outcome(FLAT, tilts) is RollingOutcome.ROLLED
    assert _outcome(FLAT, np.array([0.2, 0.09])) is RollingOutcome.LAY_DOWN
    assert _outcome(FLAT, np.array([0.2, 1.0])) is RollingOutcome.FELL_OVER


def test_it_is_compared(capsys):
    asked = [*SIZE, "--duration", "0.3", "--sources", "exact", "mujoco", "pymunk"]
    assert run(["compare", *asked, "--json"]) == 1
    exact, found, flat = map(json.loads, capsys.readouterr().out.splitlines())
    assert exact["turns"] == pytest.approx(0.3 / FLAT.turn)
    assert exact["tilt_error_rad"] == pytest.approx(0.0, abs=1e-14)
    assert exact["tilt_growth"] == found["tilt_growth"] > 0.0
    assert found["message"] == "as mujoco:fixed" and found["steps"] > 1000
    assert 0.0 < found["tilt_error_rad"] < 1e-3
    assert flat["outcome"] == "failed" and flat["tilt_error_rad"] is None
    assert "needs space" in flat["message"]
    run(["compare", *asked])
    said = capsys.readouterr().out
    assert said.startswith("cylinder a = 0.5 m, H = 0.5 m, β = 0.2 rad: Ω = 17.7194 rad/s")
    assert "a small change of the tilt swings at 16.03 rad/s" in said


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--amplitude", "0.3", "--omega", "5"), "--amplitude is 0.3 and --omega is 5.0; it may"),
        (("--rate", "1"), "--rate is 1.0; it may be given only where no cylinder rolls"),
        (("--width", "1"), "--width is 1.0; it may be given only where no cylinder rolls"),
        (("--estimate",), "--estimate is True; it may be given only where no cylinder rolls"),
        (("--load", "2"), "--load is 2.0; it may be given only with --scene frame"),
        (("--tilt", "2"), "--tilt is 2.0; it must be below pi/2"),
        (("--height", "2", "--tilt", "0.8"), "none rolls steadily between"),
        (("--radius", "-1"), "--radius is '-1'; it must be a positive finite number"),
        (("--sources", "housner"), "housner solves what rocks, and this cylinder rolls"),
        (("--sources", "mujoco:fixed", "--dt", "1e-3", "--step", "1e-3"), "give one or the other"),
    ],
)
def test_bad_input_is_one_line(options, problem, capsys):
    kept = [
        word
        for name, value in zip(SIZE[::2], SIZE[1::2], strict=True)
        if name not in options
        for word in (name, value)
    ]
    refused(capsys, ["compare", *kept, *options], problem)


def test_what_is_missing_or_of_another_scene_is_named(capsys):
    refused(capsys, ["compare", *SIZE[:4]], "--height and --tilt missing; a cylinder")
    asked = ["compare", "--radius", "1", "--width", "1", "--height", "3", "--tilt", "0.5"]
    refused(capsys, asked, "--radius is 1.0; it may be given only with --scene")
    with pytest.raises(ValueError, match=r"motion is a SinePulse; .* it must be Still\(\)"):
        respond("exact", FLAT, SinePulse.in_g(0.3, omega=5.0))
    with pytest.raises(ValueError, match="option is 'start'"):
        respond("exact", FLAT, start=(0.1, 0.0))


def test_a_row_depends_on_its_engines_cylinder_and_no_other():
    job = Job(labels={"turns": 5.0}, block=FLAT, motion=Still(), source="mujoco:fixed")
    made = Makers(ask, reduced).of(job)
    assert {"engines/mujoco/cylinder.py", "engines/space.py", "analytic/cylinder.py"} <= set(made)
    assert not any(name.startswith("engines/drake") for name in made)
    assert short(job).duration < 0.1 * FLAT.turn


def test_rows_are_summarized():
    jobs = list(cylinders(["exact", "mujoco:naive", "mujoco:landing", "box2d:naive"], True))
    assert [(job.source, job.labels["step_part"]) for job in jobs] == [
        *(("exact", 1.0), ("mujoco:naive", 1.0), ("mujoco:naive", 0.5)),
        *(("box2d:naive", 1.0), ("box2d:naive", 0.5)),
    ]
    rows = [
        {
            **{**job.labels, "source": job.source},
            **reduced(job, answer),
            "reason": answer.reason.name if answer.reason else "",
        }
        for job in jobs
        for answer in [ask(job, job.asked)]
    ]
    tables = tabulate(rows)
    assert "became" in tables["cylinder"] and "scene" not in tables["cylinder"]
    lines = tables["cylinder-summary"].set_index("source")
    assert list(lines.index) == ["exact", "mujoco:naive"]
    naive = [abs(row["tilt_error_rad"]) for row in rows if row["source"] == "mujoco:naive"]
    found = lines.loc["mujoco:naive"]
    assert [found["tilt_error_rad"], found["half_step_tilt_error_rad"]] == naive
    taken = [row["steps"] for row in rows if row["source"] == "mujoco:naive"]
    assert taken[1] == pytest.approx(2 * taken[0], abs=2)
    # its contact is soft by itself: half the step is no better
    assert naive[1] > 0.9 * naive[0] > 0.1
    assert lines.loc["exact", "tilt_error_rad"] < 1e-14
    assert math.isnan(lines.loc["exact", "half_step_tilt_error_rad"])
    assert tabulate([])["cylinder-summary"].empty
