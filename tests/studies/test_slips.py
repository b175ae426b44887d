"""Slips of a unit: a question where a value cannot be meant."""

import re

import pytest
from commanding import BLOCK, PULSE, refused

from studies.__main__ import run

EXACT = ["--sources", "exact"]


@pytest.mark.parametrize("name", ["width", "height"])
@pytest.mark.parametrize("millimetres", [300, 200.001])
@pytest.mark.parametrize("command", ["compare", "export", "animate", "advise"])
def test_a_size_in_millimetres_is_asked_about(name, millimetres, command, tmp_path, capsys):
    more = {
        "compare": PULSE,
        "export": [*PULSE, "--engine", "pymunk", "--out", str(tmp_path / "a")],
        "animate": [*PULSE, "--out", str(tmp_path / "a.gif")],
    }
    sizes = {"width": "0.5", "height": "1.5", name: str(millimetres)}
    given = [word for size, value in sizes.items() for word in (f"--{size}", value)]
    words = f"--{name} is {millimetres:g}; it must be at most 200 m"
    line = refused(capsys, [command, *given, *more.get(command, [])], words)
    meant = re.search(rf"In metres: --{name} (\S+) for (\S+) mm$", line)
    assert float(meant[1]) == pytest.approx(1e-3 * float(meant[2]), rel=1e-12)
    assert not list(tmp_path.iterdir())


def test_the_answer_to_the_question_works(capsys):
    line = refused(capsys, ["compare", "--width", "500", "--height", "1.5", *PULSE, *EXACT])
    meant = re.search(r"--width \S+ for", line)[0].split()[:2]
    assert run(["compare", *meant, "--height", "1.5", *PULSE, *EXACT]) == 0
    assert "0.385153" in capsys.readouterr().out


def test_a_tilt_in_degrees_is_asked_about(capsys):
    line = refused(capsys, ["compare", *BLOCK, "--tilt", "10", *EXACT])
    assert line.endswith("the side of the block lies on the ground; 10°? --tilt 10 --degrees")
    assert run(["compare", *BLOCK, *re.search("--tilt.*", line[-24:])[0].split(), *EXACT]) == 0
    capsys.readouterr()
    for given in (["--tilt", "100"], ["--tilt", "91", "--degrees"]):
        assert "?" not in refused(capsys, ["compare", *BLOCK, *given, *EXACT])
