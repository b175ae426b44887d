"""Slips of a unit: a question where a value cannot be meant, a note where it is unusual."""

import math
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


UNUSUAL = [
    (["--width", "30", "--height", "150", *PULSE], ["--width is 30 m, large", "--height 0.15 for"]),
    (["--width", "0.002", "--height", "0.006", *PULSE], ["--width is 0.002 m, small for a block"]),
    ([*BLOCK, "--amplitude", "3.924", "--omega", "6"], ["--amplitude 0.4 for as many m/s²"]),
    ([*BLOCK, "--amplitude", "0.4", "--omega", "0.9"], ["0.9 rad/s, slow", "5.655 for as many Hz"]),
    ([*BLOCK, "--tilt", "2", *PULSE], ["--tilt is 2 α, from where a block falls; --degrees"]),
    ([*BLOCK, "--record", "RECORD"], ["--record has 40 g at most", "--units"]),
]


@pytest.mark.parametrize(("given", "words"), UNUSUAL)
def test_what_is_only_unusual_runs_with_a_note(given, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    samples = [40.0 * math.sin(0.6 * n) for n in range(60)]
    lines = [f"{0.01 * n},{a}" for n, a in enumerate(samples)]
    (tmp_path / "RECORD").write_text("time_s,acceleration_g\n" + "\n".join(lines))
    assert run(["compare", *given, *EXACT, "--json"]) == 0
    said = capsys.readouterr()
    assert said.out.count("\n") == 1 and said.out.startswith("{")
    for part in words:
        assert part in said.err
    assert all(line.startswith("note: ") for line in said.err.splitlines())


def test_what_is_usual_runs_without_a_note(capsys):
    assert run(["compare", *BLOCK, *PULSE, "--tilt", "0.5", *EXACT]) == 0
    assert capsys.readouterr().err == ""
