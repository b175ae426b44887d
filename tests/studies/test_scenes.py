"""Frames and slides: from the command line, from Python, and the study of both."""

import json
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from matplotlib.patches import Polygon

from analytic import RigidBlock, RockingFrame, SinePulse, SlidingBlock, simulate
from analytic.response import Outcome
from engines import ENGINES
from engines.layouts import layout_of
from studies import respond, side_by_side
from studies.__main__ import run
from studies.drawing.block import draw_scene
from studies.old.jobs import Job, ask
from studies.old.tables import read_table
from studies.measures.published import PUBLISHED
from studies.measures.wrongness import KINDS
from studies.scenes.cases import RIDE, floors, slides
from studies.scenes.figure import draw_times, pictures
from studies.scenes.frames import frames, usual
from studies.scenes.own_floor import exact_on_its_floor
from studies.scenes.places import placed
from studies.scenes.study import reduce
from studies.scenes.summaries import tabulate
from studies.scenes.told import (
    SCENES,
    ends,
    floor_sentence,
    kinds_in,
    lines_of,
    sentence,
)

FRAME = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
PULSE = SinePulse.in_g(0.5, omega=9.0, half_cycles=2)
SIZE = ("--width", "0.5", "--height", "1.5", "--amplitude", "0.5", "--omega", "9")
OF_A_FRAME = ("--scene", "frame", "--columns", "2", "--load", "2")


def compared(capsys, *options):
    code = run(["compare", *SIZE, *options, "--json"])
    return code, [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_a_frame_is_compared(capsys):
    code, (exact, found) = compared(capsys, *OF_A_FRAME, "--sources", "exact", "mujoco:fixed")
    assert code == 0
    assert exact["peak_ratio"] == pytest.approx(simulate(FRAME, PULSE).peak_ratio, rel=1e-12)
    # where in a step an impact falls costs up to half a per cent
    assert found["peak_ratio"] == pytest.approx(exact["peak_ratio"], rel=5e-3)
    assert max(found["peak_1"], found["peak_2"]) == found["peak_ratio"]
    assert found["parting"] < 1e-6
    assert found["kappa"] == exact["kappa"] > 0.0


def test_a_frame_in_words(capsys):
    assert run(["compare", *SIZE, *OF_A_FRAME, "--sources", "exact", "rapier:landing"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("frame   2 columns of B = 0.5 m, H = 1.5 m, load 2: ")
    assert "valid   with friction of " in said
    assert "rapier:landing: not available: rapier:landing is not built here for bodies" in said


def test_a_beam_that_would_tip_is_named(capsys):
    tall = ("--width", "3", "--height", "0.7", "--amplitude", "5", "--omega", "20")
    run(["compare", *tall, "--scene", "frame", "--load", "1", "--sources", "exact"])
    assert "not here: the beam would tip: L = 1.4 m, needs " in capsys.readouterr().out


def test_a_frame_that_would_slide_is_named(capsys):
    asked = (*OF_A_FRAME, "--friction", "0.38", "--sources", "exact", "pymunk:fixed", "--duration")
    code, (exact, found) = compared(capsys, *asked, "1.5")
    assert exact["message"] == "the beam would slide: mu = 0.38, needs 0.436"
    code, (exact, found) = compared(capsys, *(w.replace("0.38", "0.2") for w in asked), "1.5")
    assert code == 1
    assert exact["message"].startswith("the feet would slide: mu = 0.2, needs 0.351; the beam")
    assert "the pivot slid" in found["message"]


def test_a_slide_is_compared(capsys):
    asked = ("--scene", "slide", "--friction", "0.2", "--sources", "exact", "pymunk")
    code, (exact, found) = compared(capsys, *asked)
    box = SlidingBlock(width=0.5, height=1.5, friction=0.2)
    assert code == 0
    assert exact["slips"] == list(simulate(box, PULSE).slips)
    assert exact["outcome"] == found["outcome"] == "slid"
    # a step of 1e-4 s gives up g mu dt^2 of a slip, where it starts and where it stops
    assert found["slips"] == pytest.approx(exact["slips"], abs=1e-4)
    assert found["message"] == "as pymunk:fixed"


def test_a_floor_that_lags_has_a_column_of_its_own(capsys):
    sources = ("--sources", "exact", "pybullet:naive", "rapier:naive")
    run(["compare", *SIZE, *sources])
    said = capsys.readouterr().out
    assert "lag [m]" in said and "1.8e-02" in said
    run(["compare", *SIZE, "--sources", "exact", "rapier:naive"])  # its numbers' rounding is none
    assert "lag [m]" not in capsys.readouterr().out
    code, (_, found, other) = compared(capsys, *sources)
    assert code == 0
    assert found["floor_lag_m"] > 1e-3 > other["floor_lag_m"] > 0.0


def test_from_python():
    found = respond("mujoco", FRAME, PULSE)
    assert found.peak_ratio == pytest.approx(simulate(FRAME, PULSE).peak_ratio, rel=2e-5)
    table = side_by_side(FRAME, PULSE, ["exact", "mujoco"])
    assert list(table["outcome"]) == ["rocked", "rocked"]
    assert table["parting"].iloc[1] < 1e-6


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--scene", "frame"), "--load missing; a frame requires the mass of its beam"),
        ((*OF_A_FRAME[:2], "--load", "0"), "--load is '0'; it must be a positive finite number"),
        ((*OF_A_FRAME[:2], "--load", "-1"), "--load is '-1'; it must be a positive"),
        ((*OF_A_FRAME[:2], "--load", "nan"), "--load is 'nan'; it must be a positive"),
        (("--columns", "2"), "--columns is 2; it may be given only with --scene frame"),
        (("--load", "2"), "--load is 2"),
        ((*OF_A_FRAME[:2], "--load", "1", "--columns", "1"), "--columns is 1; it must be a whole"),
        ((*OF_A_FRAME[:2], "--load", "1", "--columns", "2.5"), "--columns is '2.5'; it must be"),
        (("--scene", "slide"), "--friction missing; a block that slides requires one below B/H"),
        (("--scene", "slide", "--friction", "0.34"), "--friction is 0.34; it must be below"),
        (("--scene", "slide", "--friction", "0"), "--friction is 0"),
        (("--scene", "slide", "--friction", "0.2", "--tilt", "0.3"), "--tilt is 0.3; it may be"),
        (("--scene", "slide", "--friction", "0.2", "--plot", "x.png"), "--plot is x.png; it may"),
        (
            ("--scene", "slide", "--friction", "0.2", "--sources", "dop853"),
            "source 'dop853' cannot be asked so: dop853 solves what rocks, and this block slides",
        ),
        (("--scene", "bridge"), "--scene is 'bridge'; it must be among block, frame, slide"),
    ],
)
def test_bad_input_is_one_line(options, problem, capsys):
    refused(capsys, ["compare", *SIZE, *options], problem)


def test_kinds_of_a_frame_and_of_a_slide_are_counted():
    frames = pd.DataFrame({
        "outcome": ["overturned", "rocked", "at rest", "failed", "overturned"],
        "exact": [0.5, math.inf, 0.5, 0.5, math.inf],
    })  # fmt: skip
    found = [*kinds_in(frames, "error")]
    assert found == ["fall_wrong", "fall_wrong", "rest_wrong", "no_answer", ""]
    slides = pd.DataFrame({
        "outcome": ["failed", "overturned", "at rest", "slid", "slid"],
        "slip_error_m": [math.nan, math.nan, math.nan, 0.1, math.nan],
    })  # fmt: skip
    found = [*kinds_in(slides, "slip_error_m")]
    assert found == ["no_answer", "fall_wrong", "rest_wrong", "", "rest_wrong"]


def test_the_published_scenes_are_told_as_their_summaries_are():
    """By a second way: the kinds together are the wrong of the summary, errors and times too."""
    for name, told in (
        ("frame", {"median_error": "median_error", "ms": "ms_a_frame"}),
        ("slide", {"ms": "ms_a_slide"}),
    ):
        lines = lines_of(PUBLISHED / "scenes" / f"{name}.csv", name).set_index("source")
        summary = read_table(PUBLISHED / "scenes" / f"{name}-summary.csv").set_index("source")
        assert list(lines.index) == list(summary.index)
        assert (lines[[*KINDS]].sum(axis=1) == summary["wrong"]).all()
        assert (lines["cases"] == summary[f"{name}s"]).all()
        for ours, its in told.items():
            assert lines[ours].to_numpy() == pytest.approx(summary[its].to_numpy())


def test_a_block_that_is_held_is_no_wrong_slide():
    held = {"source": "exact", "exact_slips": 0, "slip_error_m": math.nan, "lift_m": 0.0}
    kept = {**held, "scene": "slide", "outcome": "at rest", "reason": "", "wall_s": 0.1}
    failed = {**kept, "source": "pymunk", "outcome": "failed"}
    lines = tabulate([kept, failed])["slide-summary"]
    assert dict(zip(lines["source"], lines["wrong"], strict=True)) == {"exact": 0, "pymunk": 1}


def test_each_scene_has_its_pictures():
    drawn = pictures(PUBLISHED / "scenes").keys()
    assert drawn == {"floor", *(f"{name}-{what}" for name in SCENES for what in ("scene", "time"))}


@pytest.mark.skipif(not ENGINES["newton"].installed, reason="Newton is not installed")
def test_newton_alone_has_its_report(tmp_path, capsys):
    asked = ["scenes", "--quick", "--sources", "newton:fixed", "--jobs", "1"]
    assert run([*asked, "--out", str(tmp_path)]) == 0
    assert "newton:fixed" in capsys.readouterr().out


def test_a_scene_is_drawn_with_all_its_bodies():
    for told in SCENES.values():
        bodies = len(layout_of(told.system, 1.0, None, (0.0, 0.0)).bodies)
        axes = draw_scene(told.system, told.at).axes[0]
        shapes = [patch for patch in axes.patches if isinstance(patch, Polygon)]
        assert len(shapes) == 2 * bodies
        (low, high), (_, top) = axes.get_xlim(), axes.get_ylim()
        corners = np.concatenate([shape.get_xy() for shape in shapes])
        assert low < corners[:, 0].min() < corners[:, 0].max() < high
        assert corners[:, 1].max() < top


def test_errors_are_drawn_at_their_times_where_there_are_some():
    lines = lines_of(PUBLISHED / "scenes" / "frame.csv", "frame")
    axes = draw_times(lines, "title", "error").axes[0]
    points = {tuple(line.get_xydata()[0]) for line in axes.lines if line.get_marker() == "o"}
    assert points == {*zip(lines["ms"], lines["median_error"], strict=True)}


def test_equal_steps_are_shifted_by_parts_of_a_step():
    """The first impact falls a quarter of a step later in each: step (1 + k step / 4 t), t its
    time."""
    asked = Job(labels={}, block=FRAME, motion=PULSE, source="pymunk:fixed")
    jobs = list(placed(asked, 4, 1.0))
    impact = simulate(FRAME, PULSE).impacts[0].time * FRAME.p
    places = [impact / job.options["step"] % 1.0 for job in jobs]
    shifts = [(places[0] - place) % 1.0 for place in places]
    assert shifts == pytest.approx([0.0, 0.25, 0.5, 0.75], abs=1e-3)
    assert [job.labels["phase"] for job in jobs] == [0, 1, 2, 3]
    for source in ("mujoco:landing", "exact"):
        (once,) = placed(replace(asked, source=source), 4, 1.0)
        assert once.options == {} and not list(placed(replace(asked, source=source), 4, 2.0))


def test_extreme_frames_and_one_in_other_steps_are_asked_beside_the_usual_ones():
    of = [*frames(["mujoco:fixed", "mujoco"], False)]
    beside = [job for job in of if job.labels["refined"] != 1.0 or job.labels["extreme"]]
    assert len(of) - len(beside) == len([*usual(["mujoco:fixed", "mujoco"], False)]) == 90
    loads = {(job.block.columns, job.block.load) for job in beside if job.labels["extreme"]}
    assert loads == {(2, 1e-3), (2, 0.1), (2, 10.0), (2, 1e3), (5, 2.0)}
    # what chooses its own steps has no others
    assert {job.labels["refined"] for job in of if job.source == "mujoco"} == {1.0}
    steps_of = {
        refined: [job.options["step"] for job in beside if job.labels["refined"] == refined]
        for refined in (4.0, 0.5)
    }
    assert steps_of[4.0] == pytest.approx([8.0 * step for step in steps_of[0.5]], rel=1e-12)


def test_frames_are_told_apart_by_load_and_by_step():
    usual_one = {"scene": "frame", "source": "pymunk:fixed", "reason": "", "outcome": "rocked"}
    usual_one |= {"exact": 0.2, "right": True, "error": 1e-3, "wall_s": 1e-3}
    usual_one |= {"columns": 2, "load": 2.0, "amplitude_g": 0.4, "refined": 1.0, "extreme": False}
    usual_one |= {"parting": 0.0, "tilt": 0.0, "drift_m": 0.0, "steps": 10}
    heavy = {**usual_one, "load": 1e3, "extreme": True, "error": -0.3}
    lost = {**heavy, "outcome": "failed", "error": math.nan, "right": False}
    finer = {**usual_one, "refined": 0.5, "error": 5e-4, "steps": 20}
    tables = tabulate([usual_one, heavy, lost, finer])
    (summed,) = tables["frame-summary"].to_dict("records")
    assert (summed["frames"], summed["wrong"], summed["largest_error"]) == (1, 0, 1e-3)
    (told,) = tables["frame-extremes"].to_dict("records")
    assert (told["frames"], told["no_answer"], told["fall_wrong"]) == (2, 1, 0)
    assert (told["load"], told["largest_error"]) == (1e3, 0.3)
    half, whole = tables["frame-steps"].to_dict("records")
    assert (half["refined"], half["median_error"], half["us_a_step"]) == (0.5, 5e-4, 50.0)
    assert (whole["refined"], whole["frames"], whole["us_a_step"]) == (1.0, 1, 100.0)


def test_rows_are_reduced_and_summarized():
    sources = ["exact", "pymunk:naive", "pymunk:fixed", "newton:fixed"]
    jobs = [*frames(sources, True), *slides(sources, True)]
    rows = [
        {**job.labels, "source": job.source, **reduce(job, ask(job, job.asked))} for job in jobs
    ]
    tables = tabulate(rows)
    frame = tables["frame-summary"].set_index("source")
    here = sources if ENGINES["newton"].installed else sources[:3]
    assert list(frame.index) == here
    assert frame.loc["exact", "largest_error"] == 0.0
    assert frame.loc["pymunk:fixed", "largest_error"] < 5e-3
    assert (frame.loc[["exact", "pymunk:fixed"], "beyond_2_percent"] == 0).all()
    off = [abs(row["error"]) for row in rows if row["source"] == "pymunk:naive" and "error" in row]
    assert frame.loc["pymunk:naive", "beyond_2_percent"] == sum(error > 0.02 for error in off) > 0
    slide = tables["slide-summary"].set_index("source")
    assert slide.loc["exact", "largest_slip_error_m"] == 0.0
    assert slide.loc["pymunk:fixed", "creep_m"] < 1e-9
    # as it comes pymunk's block creeps where the exact one is held
    held = {
        row["source"]: row["outcome"] for row in rows if str(row.get("case", "")).startswith("held")
    }
    assert held.pop("pymunk:naive") == Outcome.SLID.value
    if not ENGINES["newton"].installed:
        assert held.pop("newton:fixed") == Outcome.FAILED.value
    assert set(held.values()) == {Outcome.AT_REST.value}


def test_a_floor_carries_by_its_velocity_and_not_by_its_position():
    sources = ["exact", "pymunk:naive", "dart:naive", "dart:fixed"]
    jobs = list(floors(sources))
    assert {job.source for job in jobs} == {"pymunk:naive", "dart:naive"}
    rows = [
        {**job.labels, "source": job.source, **reduce(job, ask(job, job.asked))} for job in jobs
    ]
    lines = tabulate(rows)["floor-summary"].set_index(["engine", "floor"])
    travel = float(RIDE.displacement(RIDE.duration))
    assert travel == pytest.approx(1.0 / (2.0 * math.pi) ** 2 * 4.0 * math.pi, rel=1e-12)
    for engine in ("pymunk", "dart"):
        assert abs(lines.loc[(engine, "position"), "carried"]) < 1e-2
        assert lines.loc[(engine, "velocity"), "carried"] == pytest.approx(1.0, abs=1e-2)
        assert lines.loc[(engine, "velocity"), "floor_lag_m"] < 1e-9
    # what sleeps is not woken by a joint that is driven by its velocity, and is by a servo
    assert lines.loc[("pymunk", "velocity"), "carried_after_rest"] > 0.99
    assert abs(lines.loc[("dart", "velocity"), "carried_after_rest"]) < 1e-2
    assert lines.loc[("dart", "servo"), "carried_after_rest"] > 0.99
    said = floor_sentence(lines.reset_index())
    assert said.endswith("after a second of rest it sleeps on in DART.")
    awake = lines.loc[["pymunk"]].reset_index()
    assert "sleeps" not in floor_sentence(awake)
    assert floor_sentence(awake.iloc[:0]) == ""


def test_a_preset_is_as_far_off_as_its_worst_engine():
    errors = {"box2d:naive": 0.2, "mujoco:naive": 0.5, "mujoco:landing": 1e-5}
    lines = pd.DataFrame({"source": list(errors), "largest_error": list(errors.values())})
    lines[["cases", *KINDS]] = 3, 1, 0, 0
    lines.loc[2, "fall_wrong"] = 0
    assert sentence("frame", lines) == (
        "The peak of a rocking frame is off by up to 50 % (2 of 6 wrong) as their documentation "
        "shows them and 10⁻⁵ with steps that land on impacts."
    )
    assert ends("frame", lines) == "50 % → 20 %"  # the best that Box2D was asked in
    assert ends("frame", lines.iloc[:1]) == "20 %"
    assert sentence("frame", lines.iloc[:0]) == ""


def test_an_engine_is_held_against_the_floor_that_it_made():
    """MuJoCo's welded floor lags: its peak is right of the floor as it moved, not as it should."""
    block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse.in_g(0.5, omega=9.0, half_cycles=1)
    exact = simulate(block, pulse).peak_ratio
    found = respond("mujoco:recommended", block, pulse)
    own = exact_on_its_floor("mujoco", "recommended", block, pulse).peak_ratio
    assert found.observables["floor_lag_m"] > 0.03
    assert abs(found.peak_ratio / exact - 1.0) > 0.1
    assert found.peak_ratio == pytest.approx(own, rel=1e-2)
    # one that is where it should be changes nothing, but for its steps
    assert exact_on_its_floor("rapier", "naive", block, pulse).peak_ratio == exact
    row = {"scene": "block", "reason": "", "own_error": 0.01}
    lines = tabulate([
        {**row, "source": name, "error": error, "floor_lag_m": lag}
        for name, error, lag in (("mujoco:naive", 0.2, 0.04), ("rapier:naive", 0.3, 1e-8))
    ])["block-summary"]  # fmt: skip
    assert lines.to_numpy().tolist() == [
        ["mujoco:naive", 1, 0.2, 0.01, 0.04],
        ["rapier:naive", 1, 0.3, 0.01, 1e-8],
    ]


def test_the_study_leaves_its_tables_and_goes_on(tmp_path, capsys):
    asked = ["scenes", "--quick", "--out", str(tmp_path), "--sources", "exact", "mujoco:fixed"]
    assert run(asked) == 0
    first = capsys.readouterr()
    assert "a rocking frame 0." in first.out
    lines = read_table(tmp_path / "frame-summary.csv")
    assert list(lines["source"]) == ["exact", "mujoco:fixed"]
    assert (tmp_path / "frame-time.png").stat().st_size > 4_000
    before = pd.read_csv(tmp_path / "frame.csv")
    assert run(asked) == 0
    assert pd.read_csv(tmp_path / "frame.csv").equals(before)
    assert not math.isnan(lines["largest_error"].max())
