"""The moment at which velocities hold: of every engine, and of ones that declare another."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from given import BLOCK

from engines import installed_engines
from engines.declaration import Stepping
from engines.run.drive import build
from engines.run.monitor import Monitor
from engines.world import Moment
from studies.__main__ import run
from studies.score import study as score
from studies.score.moments import CLOSE, OFF, accusation, judged
from studies.score.release import UNFELT, problem_of, suspicion
from studies.sources.registry import announce, presets_of, resolve, scene_of


def moments_of(name):
    """Return the table of moments of an engine, of all its presets."""
    jobs = [job for job in score.score_jobs(name, True) if job.labels["table"] == score.MOMENTS]
    assert len(jobs) == len(presets_of(resolve(name)))
    rows = []
    for job in jobs:
        response = score.ask_of_table(job, job.asked, quick=True, time_limit_s=1.0)
        rows.append({"source": job.source, **score.reduce(job, response)})
    return pd.DataFrame(rows)


@pytest.mark.parametrize("name", installed_engines())
def test_no_engine_is_accused(name):
    table = moments_of(name)
    lag = (table["measured"] - table["declared"]).to_numpy()
    own = [resolve(source).used.stepping is Stepping.OWN for source in table["source"]]
    assert (np.isnan(lag) == own).all()
    # what takes n steps within a step has its velocity at 1 - 1/2n: Rapier's own settings take 4, 8
    substeps = {"rapier:naive": 4, "rapier:naive-base-at-rest": 4, "rapier:recommended": 8}
    expected = [0.5 - 0.5 / substeps.get(source, 1) for source in table["source"]]
    assert lag[~np.isnan(lag)] == pytest.approx(np.array(expected)[~np.isnan(lag)], abs=CLOSE)
    assert (accusation(table), suspicion(table)) == ("", "")
    told = judged(table).set_index("source")["velocity"]
    for source, count in substeps.items():
        assert source not in told or told[source].endswith(f"as by {count} steps within a step")


@pytest.mark.parametrize("right", ["Heavy", "Standard"])
def test_what_changes_no_motion_is_no_wrong_quantity(right, alone):
    pytest.importorskip("pymunk")
    table = moments_of(announce(f"wrong:{right}"))
    assert table["turn_error"].to_numpy() == pytest.approx(0.0, abs=1e-3)
    assert suspicion(table) == ""


TO_CORNER, OF_CORNER = 1.0 / 3.0, 4.0 / 3.0
"""Moments of inertia of a block about its centre and a corner, in units of m R^2."""
QUANTITIES = {
    "Inertia": OF_CORNER / (OF_CORNER + 0.03 * TO_CORNER) - 1.0,
    "Mass": 1.03 * OF_CORNER / (1.03 + TO_CORNER) - 1.0,
    "Gravity": 0.01,
}
"""Class -> by what part the block is turned too fast."""


@pytest.mark.parametrize("wrong", [*QUANTITIES, "Width"])
def test_an_error_that_does_not_shrink_with_the_step_is_a_wrong_quantity(wrong, alone):
    pytest.importorskip("pymunk")
    table = moments_of(announce(f"wrong:{wrong}"))
    errors = table[["turn_error", "turn_error_half"]].to_numpy()
    assert errors == pytest.approx(QUANTITIES.get(wrong, 0.0221), abs=5e-4)
    said = suspicion(table)
    assert said.startswith("Wrong quantity: wrong:fixed and wrong:landing.")
    assert f"{abs(errors[0, 0]):.2%}" in said
    assert "mass, inertia, size or gravity" in said


def test_an_error_that_shrinks_or_is_small_or_the_librarys_own_is_none():
    table = pd.DataFrame(
        [("mujoco:fixed", 4e-3, 2e-3), ("mujoco:landing", 9e-4, 9e-4), ("mujoco:naive", 0.1, 0.1)],
        columns=["source", "turn_error", "turn_error_half"],
    )
    assert suspicion(table) == ""
    assert "mujoco:fixed" in suspicion(table.assign(turn_error=-2e-3))


NO_WORLDS = {
    "NoStep": "has no method step; it must have state, fault, close, step",
    "NoState": "has no method state",
    "NoFault": "has no method fault",
    "NoClose": "has no method close",
    "NoMoment": "has no moment; it must be one of Moment.MIDDLE, END and NEXT",
    "Turned": "theta -0.0804 of a block put to 0.0804: the sign is wrong",
    "Backwards": "rate -0.0982 of a block put to 0.0982: the sign is wrong",
    "Mirrored": "pulled towards +x, its block turns to theta -0.0256: the sign is wrong",
}


@pytest.mark.parametrize("wrong", NO_WORLDS)
def test_what_is_no_world_is_told_in_a_line(wrong, alone):
    pytest.importorskip("pymunk")
    assert NO_WORLDS[wrong] in problem_of(announce(f"wrong:{wrong}"))


def test_a_world_is_nothing_to_complain_of(alone):
    pytest.importorskip("pymunk")
    assert problem_of(announce("my_engine:World")) == problem_of("moreau:landing") == ""


def test_what_is_no_world_is_refused_before_anything_runs(alone, tmp_path, capsys):
    pytest.importorskip("pymunk")
    asked = ("score", "wrong:NoFault", "--out", tmp_path / "out")
    refused(capsys, asked, "ENGINE is 'wrong:NoFault'", "no method fault")
    assert not (tmp_path / "out").exists()


WRONG = [
    ("staggered:Middle", 1.5, "0% moves it within that step, where MIDDLE means 100%", "NEXT"),
    ("staggered:End", 1.5, "0% moves it within that step, where END means 50%", "NEXT"),
    ("staggered:Moreau", 1.0, "50% moves it within that step, where MIDDLE means 100%", "END"),
]


@pytest.mark.parametrize(("place", "moment", "evidence", "name"), WRONG)
def test_a_wrong_moment_is_told(place, moment, evidence, name, alone):
    pytest.importorskip("pymunk")
    table = moments_of(announce(place))
    assert table["measured"].to_numpy() == pytest.approx(moment, abs=1e-6)
    said = accusation(table)
    assert said.startswith("Wrong moment: staggered:fixed and staggered:landing. ")
    assert evidence in said
    assert said.endswith(f"Declare Moment.{name}.")


def test_it_is_on_the_page_in_the_result_and_in_the_exit_code(
    alone, few, tmp_path, capsys, monkeypatch
):
    pytest.importorskip("pymunk")

    def brief(*asked):
        """With a wrong moment a pulse of 31/p takes 900 000 steps to land on."""
        return [job for job in few(*asked) if job.labels.get("omega_over_p") != 0.1]

    monkeypatch.setattr(score, "score_jobs", brief)
    kept = tmp_path / "kept.json"
    asked = ("--quick", "--out", str(tmp_path), "--require", "failed=9", "--json", str(kept))
    assert run(["score", "staggered:End", *asked]) == 1
    said = capsys.readouterr().out
    assert said.startswith("Wrong moment: staggered:fixed and staggered:landing.")
    assert "holds: landing:failed" in said
    assert "0.5 of a step off: NEXT, not END" in said
    (moment,) = {tuple(line.values()) for line in json.loads(kept.read_text())["moments"].values()}
    assert moment == pytest.approx((1.0, 1.5), abs=1e-6)


@pytest.mark.parametrize(
    ("measured", "said"),
    [
        (0.5 + OFF, "0.47 of a step off: END, not MIDDLE"),
        (1.0 - 1.0 / 32.0, "between two moments, as by 16 steps within a step"),
        (0.6, "between two moments"),
        (0.5 + CLOSE - 1e-3, "as declared"),
    ],
)
def test_from_half_a_step_on_it_is_another_moment(measured, said):
    table = pd.DataFrame({"source": ["a"], "declared": [0.5], "measured": [measured]})
    assert judged(table.assign(message=""))["velocity"].iloc[0] == said
    assert bool(accusation(table)) == ("off" in said)


def test_what_does_not_move_is_not_judged(alone):
    table = moments_of(announce("hostile:Calm"))
    assert table["measured"].isna().all()
    assert accusation(table) == ""
    assert "a pull for one step gave 0 of" in judged(table)["velocity"].iloc[0]


@pytest.mark.parametrize("source", ["my_engine:fixed", "mujoco:landing", "moreau:landing"])
def test_it_is_the_moment_by_which_the_angle_follows_the_rate(source, alone):
    """While a block falls back the rate is the slope of the angle, a part of a step away."""
    pytest.importorskip("pymunk")
    if source.startswith("my_engine"):
        announce("my_engine:World")
    asked = resolve(source)
    scene = scene_of(BLOCK, UNFELT, asked.preset, start=(0.5 * BLOCK.alpha, 0.0), frame="base")
    world = build(asked.declared, scene)
    monitor = Monitor(scene, asked.used.ordinary_step_s(scene), asked.used.stepping, world.moment)
    monitor.make_room(64)
    angles, rates, ends = [], [], []
    for _ in range(60):
        step = monitor.next(world.state())
        world.step(step)
        ends.append(step.end_s)
        angles.append(world.state()[0][2])
        rates.append(world.state()[0][3])
    world.close()
    dt_s = np.diff(ends[5:])
    assert dt_s == pytest.approx(dt_s[0], rel=1e-6)
    angle, rate = np.array(angles[5:]), np.array(rates[5:])
    slope = (angle[2:] - angle[:-2]) / (2.0 * dt_s[0])
    gained = (angle[2:] - 2.0 * angle[1:-1] + angle[:-2]) / dt_s[0]
    found = 1.0 + ((rate[1:-1] - slope) @ gained) / (gained @ gained)
    table = moments_of(source.partition(":")[0]).set_index("source")
    assert found == pytest.approx(table.loc[source, "measured"], abs=0.02)
    assert any(math.isclose(found, moment.value, abs_tol=0.02) for moment in Moment)
