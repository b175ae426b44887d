"""The lines on an installation: what is there, what fails, what to do about it."""

import re
from dataclasses import replace
from functools import partial

import pytest

from analytic import Response, simulate
from studies import doctor
from studies.__main__ import run
from studies.kit.identity import version_of
from studies.sources.registry import SOURCES, Source


def diagnosed(capsys, monkeypatch, *here):
    monkeypatch.setattr(doctor, "installed_engines", lambda: here)
    code, lines = run(["doctor"]), capsys.readouterr().out.splitlines()
    failing = [line for line in lines if line.startswith("FAIL  ")]
    assert all(line.startswith("ok    ") for line in lines if line not in failing)
    return code, "\n".join(line for line in lines if line not in failing), failing


def test_what_works_is_a_page_of_short_lines(capsys, monkeypatch):
    code, text, failing = diagnosed(capsys, monkeypatch, "mujoco")
    assert (code, failing, text.count("\n")) == (0, [], 5)
    for words in (f"numpy {version_of('numpy')}", "Python 3.", "cores, ", "GB free"):
        assert words in text
    assert re.search(r"mujoco:landing \(mujoco [\d.]+\): .* %, 0.01 % allowed", text)
    assert "box2d (pip install 'rocking[box2d]')" in text


@pytest.mark.parametrize(
    ("name", "value", "remedy"),
    [("kept_in", lambda _: None, "set NUMBA_CACHE_DIR"), ("LEAST_BYTES", 1e30, "free some")],
)
def test_what_fails_says_what_to_do(name, value, remedy, capsys, monkeypatch):
    monkeypatch.setattr(doctor, name, value)
    code, _, (line,) = diagnosed(capsys, monkeypatch)
    assert code == 1 and remedy in line


def errs(block, motion, *, duration, times, strength):
    if not strength:
        return Response.failure("it exploded")
    return simulate(block, replace(motion, amplitude=strength * motion.amplitude))


@pytest.mark.parametrize(
    ("strength", "answer"),
    [
        (0.0, "it exploded"),
        (0.1, "at rest, peak 0; exactly 0.3852; "),
        (1.001, "rocked, peak 0.3955; exactly"),
    ],
)
def test_an_engine_that_fails_or_is_wrong_is_a_line(strength, answer, capsys, monkeypatch):
    call = partial(errs, strength=strength)
    monkeypatch.setitem(SOURCES, "mujoco", Source("engine", call, "mujoco", "landing"))
    code, _, (line,) = diagnosed(capsys, monkeypatch, "mujoco")
    assert code == 1
    assert line.startswith(f"FAIL  mujoco:landing (mujoco {version_of('mujoco')}): {answer}")
    assert "pip install --force-reinstall 'rocking'" in line
