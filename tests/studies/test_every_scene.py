"""Every command that takes --scene, with every scene: it does that one, or refuses it."""

import json
import re
from ast import literal_eval

import pytest
from commanding import refused
from test_any_arguments import OPTIONS as KNOWN

from analytic import RigidBlock, RockingFrame, SinePulse, SlidingBlock, simulate
from studies.__main__ import run

SIZES = {"width": 0.5, "height": 1.5}
PULSE = SinePulse.in_g(0.5, omega=12.0, half_cycles=2)
SHAKEN = ["--width", "0.5", "--height", "1.5", "--amplitude", "0.5", "--omega", "12"]
SCENES = {
    "block": ([], RigidBlock(**SIZES)),
    "frame": (["--load", "2"], RockingFrame(**SIZES, columns=2, load=2.0)),
    "slide": (["--friction", "0.2"], SlidingBlock(**SIZES, friction=0.2)),
}
"""Scene -> its options, and what it is."""
OPTIONS = {
    "compare": ["--sources", "exact", "--json"],
    "export": ["--engine", "mujoco:fixed", "--step", "0.01", "--out", "OUT"],
    "animate": ["--sources", "exact", "--out", "OUT.gif"],
}
"""Command -> what else it is asked."""


def asked(command, scene, own, folder):
    options = [str(folder / word) if word.startswith("OUT") else word for word in OPTIONS[command]]
    return [command, *SHAKEN, "--scene", scene, *own, *options]


def test_these_are_the_commands_that_take_a_scene():
    assert {name for name, options in KNOWN.items() if "--load" in options} == {*OPTIONS}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("command", OPTIONS)
def test_a_command_does_the_scene(command, scene, tmp_path, capsys, monkeypatch):
    own, system = SCENES[scene]
    filmed = []
    monkeypatch.setattr("studies.drawing.film.write_film", lambda *given: filmed.append(given[1]))
    assert run(asked(command, scene, own, tmp_path)) == 0
    exact, told = simulate(system, PULSE), capsys.readouterr().out
    if command == "compare":
        (row,) = map(json.loads, told.splitlines())
        assert row["outcome"] == exact.outcome.value
        assert row["peak_ratio"] == pytest.approx(exact.peak_ratio, rel=1e-9)
    elif command == "export":
        script = (tmp_path / "OUT" / "block.py").read_text()
        (said,) = re.findall(r"^EXACT = (.*?)  #", script, flags=re.MULTILINE)
        assert literal_eval(said) == pytest.approx(exact.slips or exact.peak_ratio, rel=1e-9)
    else:
        assert filmed == [system]


@pytest.mark.parametrize("command", OPTIONS)
def test_or_refuses_it(command, tmp_path, capsys):
    refused(capsys, asked(command, "moon", [], tmp_path))
    assert not list(tmp_path.iterdir())
