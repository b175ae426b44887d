"""A block that strikes with a corner: what comes out of a coefficient of restitution."""

import math
import re

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from scipy.integrate import solve_ivp

from engines import ENGINES
from studies.__main__ import run
from studies.contact.study import newton_e
from studies.measures.published import PUBLISHED
from studies.restitution import strikes, study
from studies.restitution.strike import Strike, strike
from studies.restitution.ways import WAYS, Way, damping_ratio, given_back

HERE = [name for name in WAYS if ENGINES[name].installed]


def striking(engine, name, wanted, **options):
    if engine not in HERE:
        pytest.skip(f"{engine} is not installed")
    way = next(way for way in WAYS[engine] if way.name == name)
    asked = Strike(restitution=wanted, **options)
    return asked, strike(ENGINES[engine], asked, way)


def found(engine, name, wanted, **options):
    return striking(engine, name, wanted, **options)[1].corner_ratio


@pytest.mark.parametrize("ratio", [0.02, 0.3, 0.9, 1.0, 1.5, 4.0])
def test_a_spring_that_only_pushes_gives_back_what_its_equation_says(ratio):
    def motion(_, state):
        return [state[1], -2.0 * ratio * state[1] - state[0]]

    def force(_, state):
        return motion(_, state)[1]

    force.terminal, force.direction = True, -1.0
    # x is the gap: it comes in with unit speed, and leaves where the base would have to pull
    end = solve_ivp(motion, (0.0, 60.0), [0.0, -1.0], events=force, rtol=1e-11, atol=1e-13)
    assert given_back(ratio) == pytest.approx(end.y[1, -1], rel=1e-6)


def test_the_damping_ratio_is_the_inverse():
    assert damping_ratio(1.0) == pytest.approx(0.0, abs=1e-15)
    for wanted in (0.05, math.exp(-2.0), 0.5, 0.99):
        assert given_back(damping_ratio(wanted)) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("wanted", [0.0, 0.4, 1.0])
def test_the_library_s_own_contact_gives_nothing_back_in_mujoco(wanted):
    # an impact in which the weight matters little
    quick = {"rate": 2.0, "step": 1e-4}
    assert found("mujoco", "the library's solref, whatever e", wanted, **quick) == 0.0


def test_a_contact_that_its_step_does_not_resolve_is_no_number():
    rows = pd.read_csv(PUBLISHED / "restitution" / "restitution.csv")
    mine = rows[rows["way"] == "the damping ratio for e alone"]
    broken = mine[~(mine["corner_ratio"] < strikes.BROKEN)].iloc[0]
    options = {name: broken[column] for name, column in strikes.COLUMNS.items()}
    phase = {"phase": broken["phase"]}
    again = found("mujoco", "the damping ratio for e alone", broken["wanted"], **phase, **options)
    assert not again < strikes.BROKEN


@pytest.mark.parametrize("wanted", [0.0, 0.4, 0.8, 1.0])
def test_pybullet_needs_five_settings(wanted):
    """With all of them a block keeps what its corner gives back, below."""
    *slow, thrown, _ = WAYS["pybullet"]
    for fewer in slow:
        assert found("pybullet", fewer.name, wanted) == pytest.approx(0.0, abs=0.05)
    assert found("pybullet", thrown.name, wanted, phase=0.9) > wanted + 0.1


@pytest.mark.parametrize("way", WAYS["newton"], ids=lambda way: way.name)
@pytest.mark.parametrize("wanted", [0.0, 0.8])
def test_newton_gives_back_what_is_asked_and_by_xpbd_slides(way, wanted):
    _, impact = striking("newton", way.name, wanted)
    assert impact.corner_ratio == pytest.approx(wanted, abs=0.05)
    slides = way.settings(wanted, 1e-3).get("solver") == "xpbd" and wanted > 0.0
    assert (abs(impact.slide_ratio) > 0.5) == slides


@pytest.mark.parametrize("engine", HERE)
def test_what_is_set_of_the_base_counts_as_the_library_says(engine):
    """A product with 0 is 0, a mean with 0 is a half; what has no coefficient has one way less."""
    alone = [way for way in WAYS[engine] if way.name == "e on the block alone"]
    part = 0.5 if engine == "rapier" else 0.0
    for way in alone:
        assert found(engine, way.name, 1.0, rate=2.0) == pytest.approx(part, abs=0.05)
    assert bool(alone) == ("base_restitution" in dir(ENGINES[engine].best.settings))


@pytest.mark.parametrize("wrong", [{"restitution": 1.5}, {"restitution": 0.5, "step": 0.0}])
def test_a_strike_refuses_what_is_not_allowed(wrong):
    with pytest.raises(ValueError, match="it must be"):
        Strike(**wrong)


def test_the_study_says_what_is_off_and_what_broke(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(strikes, "PHASES", (0.5,))
    assert run(["restitution", "--engines", "mujoco", "--out", str(tmp_path)]) == 0
    said = study.STUDY.finding(tmp_path)
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith(said)
    assert "asked in the first way that comes to mind, mujoco miss it" in said
    assert len(said) < 500
    over = "steps of 0.0001 to 0.004/p, rates of 0.1 to 2 α p, heights of 0.1 to 10 m and H/B of 2"
    assert f"over {over} to 4;" in text and "at 0.001/p, 0.5 α p, 1 m and H/B 2," in text
    for name in study.STUDY.pictures(tmp_path):
        assert (tmp_path / f"{name}.png").stat().st_size > 7_000
    lines = study.STUDY.read(tmp_path, "corners").set_index("way")
    assert lines.loc["the damping ratio for e alone", "off_over_all"] == math.inf


def test_what_is_said_over_all_that_is_varied_is_the_largest_of_all_strikes():
    folder = PUBLISHED / "restitution"
    rows, lines = (study.STUDY.read(folder, name) for name in ("restitution", "corners"))
    for line in lines[~np.isinf(lines["off_over_all"])].to_dict("records"):
        mine = rows[(rows["engine"] == line["engine"]) & (rows["way"] == line["way"])]
        assert line["off_over_all"] == (mine["corner_ratio"] - mine["wanted"]).abs().max()
        assert line["off_over_all"] >= line["off"]
    best = lines.groupby("engine")["off_over_all"].min()
    ends = [f"{best[name]:.3f} in {name}" for name in (best.idxmin(), best.idxmax())]
    assert f"within {ends[0]} to {ends[1]} in all strikes" in study.STUDY.finding(folder)


@pytest.mark.parametrize("way", WAYS["mujoco"], ids=lambda way: way.name)
def test_the_attributes_that_are_quoted_are_those_of_the_model_that_is_run(way):
    asked = Strike(restitution=0.6)
    script = ENGINES["mujoco"].script
    fixed = ENGINES["mujoco"].preset("fixed").settings
    scene = asked.scene(way)
    model = "\n".join(script(scene, scene.choose(fixed), asked.dt_s).settings)
    said = re.search(r'solref="(\S+) (\S+)"', way.literal(0.6, asked.dt_s))
    run = re.search(r'solref="(\S+) (\S+)"', model)
    if run is None:
        assert way.literal(0.6, asked.dt_s) == 'solref="0.02 1"'  # what the library does by itself
    else:
        numbers = [[float(number) for number in each.groups()] for each in (said, run)]
        assert numbers[0] == pytest.approx(numbers[1], rel=3e-4)  # over the impedance, 0.9999


def test_an_engine_that_was_not_asked_is_refused(tmp_path, capsys):
    words = "--engines is 'moreau'; it must be one that was asked: pybullet, mujoco"
    refused(capsys, ["restitution", "--engines", "moreau", "--out", tmp_path / "a"], words)


@pytest.mark.parametrize("aspect", [1.5, 2.0, 6.0])
@pytest.mark.parametrize("wanted", [0.0, 0.3, 1.0])
def test_what_a_block_keeps_is_what_impulses_on_its_corner_leave(aspect, wanted):
    """The closed form, against two impulses that are solved for."""
    asked = Strike(restitution=wanted, aspect=aspect)
    half_width, half_height = 0.5 / aspect, 0.5
    radius_2 = (half_width**2 + half_height**2) / 3.0
    # along, up and turn after, and both impulses over the mass, for a unit rate before
    conditions = [
        [1.0, 0.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, radius_2, half_height, half_width],
        [1.0, 0.0, -half_height, 0.0, 0.0],
        [0.0, 1.0, -half_width, 0.0, 0.0],
    ]
    before = [half_height, -half_width, radius_2, 0.0, 2.0 * half_width * wanted]
    assert asked.kept == pytest.approx(np.linalg.solve(conditions, before)[2], rel=1e-13)
    assert newton_e(asked.kept, asked.block.alpha) == pytest.approx(wanted, abs=1e-12)
    if not wanted:
        assert asked.kept == pytest.approx(asked.block.restitution, rel=1e-13)


@pytest.mark.parametrize(
    ("engine", "name"),
    [
        ("pybullet", "and no depth is corrected"),
        ("pymunk", "e on the block, 1 on the base"),
        ("box2d", "e on the block, in the preset's units"),
        ("dart", "and in tenths of a metre"),
        ("mujoco", "spring and damper over 20 steps"),
    ],
)
@pytest.mark.parametrize("wanted", [0.0, 0.5, 1.0])
def test_a_block_keeps_what_its_corner_gives_back(engine, name, wanted):
    # steps in which the weight matters little
    asked, found = striking(engine, name, wanted, rate=2.0, step=1e-4)
    assert found.rate_ratio == pytest.approx(asked.kept, abs=0.005)
    assert found.corner_ratio == pytest.approx(wanted, abs=0.01)
    assert found.slide_ratio == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize(("name", "kept"), [("e on both", 0.0), ("and at all speeds", 0.6)])
def test_physx_gives_back_nothing_below_its_threshold(name, kept):
    """That is 2 m/s; the corner comes in at half of alpha p times its 0.5 m, 0.4 m/s."""
    assert found("physx", name, 0.6) == pytest.approx(kept, abs=0.02)


@pytest.mark.skipif(not ENGINES["rapier"].installed, reason="rapier3d is not installed")
def test_a_corner_that_bounces_slides_in_rapier():
    """Its bounce is a normal impulse that comes after friction's: 6 e sin^2/(1 + 3 sin^2) less."""
    own = {"stabilization": 10, "substeps": 4, "restitution": 0.6}
    asked = Strike(restitution=0.6)
    found = strike(ENGINES["rapier"], asked, Way("", lambda *_: own, ""))
    sine_2 = math.sin(asked.block.alpha) ** 2
    without_friction = asked.block.restitution - 6.0 * 0.6 * sine_2 / (1.0 + 3.0 * sine_2)
    assert found.corner_ratio == pytest.approx(0.6, abs=0.02)
    assert found.rate_ratio == pytest.approx(without_friction, abs=0.005)
    assert found.slide_ratio > 0.4


def test_a_strike_that_gravity_would_not_let_begin_is_refused():
    with pytest.raises(ValueError, match=r"rate is 0\.01; it must be larger at a step of 0\.01"):
        Strike(restitution=0.5, rate=0.01, step=0.01)


def test_a_block_whose_library_says_that_it_went_wrong_keeps_no_number(monkeypatch):
    monkeypatch.setattr("engines.mujoco.build.MujocoWorld.fault", lambda _: "it went wrong")
    _, found = striking("mujoco", "spring and damper over 5 steps", 0.5)
    assert all(map(math.isnan, found))


@pytest.mark.slow
def test_the_published_lines_follow_from_the_published_strikes():
    folder = PUBLISHED / "restitution"
    rows = study.STUDY.read(folder, "restitution")
    for name, measure in (("corners", strikes.CORNER), ("rates", strikes.RATE)):
        lines = study.STUDY.read(folder, name)
        again = strikes.lines(rows, measure)
        pd.testing.assert_frame_equal(again, lines, check_dtype=False, rtol=1e-12)
    usual = rows[rows["engine"].isin(HERE) & (rows["corner_ratio"] < strikes.BROKEN)]
    for row in usual.sample(24, random_state=7).to_dict("records"):
        options = {name: row[column] for name, column in strikes.COLUMNS.items()}
        _, found = striking(row["engine"], row["way"], row["wanted"], phase=row["phase"], **options)
        again = [found.rate_ratio, found.corner_ratio, found.slide_ratio]
        kept = [row[name] for name in found._fields]
        assert again == pytest.approx(kept, rel=1e-6, abs=1e-6)
