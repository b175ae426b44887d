"""Frames and slides, from the command line and from Python."""

import json

import pytest
from commanding import refused

from analytic import RockingFrame, SinePulse, SlidingBlock, simulate
from studies import respond, side_by_side
from studies.__main__ import run

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
