"""A reader's own friction and step: in a comparison, an export, from Python."""

import re
import subprocess
import sys

import numpy as np
import pytest
from commanding import CASE, compared
from given import BLOCK, PULSE

from engines import ENGINES
from studies import respond
from studies.__main__ import run


def test_a_scene_is_exported_with_them(tmp_path, capsys):
    own = ("--friction", "0.8", "--dt", "0.002")
    _, rows = compared(capsys, *CASE, *own, "--sources", "mujoco:naive")
    scene = ["--engine", "mujoco:naive", "--out", str(tmp_path / "scene")]
    assert run(["export", *CASE, *own, *scene]) == 0
    told = float(re.search(r"to expect: (\S+)", capsys.readouterr().out)[1])
    assert told == pytest.approx(rows["mujoco:naive"]["peak_ratio"], rel=1e-11)
    script = tmp_path / "scene" / "block.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "DT = 0.002 " in script.read_text()
    assert 'friction="0.8 ' in (tmp_path / "scene" / "block.xml").read_text()


@pytest.mark.parametrize("source", ["mujoco:fixed", "drake:fixed"])
def test_a_setting_takes_a_number_of_any_type(source):
    if not ENGINES[source.partition(":")[0]].installed:
        pytest.skip("not installed")
    value = np.float32(0.83)
    told = [
        respond(source, BLOCK, PULSE, step=0.05, settings={"friction": number})
        for number in (value, np.float64(value), float(value))
    ]
    assert len({response.peak_ratio for response in told}) == 1
