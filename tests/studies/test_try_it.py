"""The equations in the page, run by an interpreter, beside the reference."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from given import BLOCK, PULSE

from analytic import RigidBlock, SinePulse, simulate
from engines.scene import free_rocking_window
from studies import respond
from studies.__main__ import run
from studies.page import page

quickjs = pytest.importorskip("quickjs")  # it has no wheel for Python 3.13
SCRIPT = Path(page.__file__).with_name("rocking.js").read_text(encoding="utf-8")
# the truncation of 400 classical Runge-Kutta steps in a time 1/p, through a few impacts
TOLERANCE = 1e-7

# (B, H, amplitude in g, rad/s, half cycles), and what the exact solution says
CASES = [
    (0.5, 1.5, 0.4, 6.2832, 2, "rocked"),
    (0.5, 3.0, 0.2, 6.2832, 1, "rocked"),
    (0.5, 1.0, 0.6, 6.2832, 2, "rocked"),
    (0.5, 1.5, 0.45, 4.0, 2, "overturned"),
    (0.5, 1.5, 0.32, 5.0, 2, "at rest"),
    (0.5, 1.5, 0.34, 5.0, 2, "rocked"),
    (2.0, 4.0, 4.0, 12.0, 1, "overturned"),
    (1.0, 1.0, 1.3, 9.0, 3, "rocked"),
    (0.3, 0.24, 1.5, 9.0, 2, "rocked"),
    (1.0, 4.0, 0.9, 8.0, 7, "overturned"),
    (1.0, 4.0, 2.2, 20.0, 2, "rocked"),
]


def by_the_page(block, motion, times):
    call = (
        f"rock({block.alpha!r}, {block.restitution!r}, pulse({motion.amplitude / block.gravity!r},"
        f" {motion.omega / block.p!r}, {motion.half_cycles}), {float(times[-1]) * block.p!r},"
        f" {(times * block.p).tolist()})"
    )
    engine = quickjs.Context()
    engine.eval(SCRIPT)
    found = json.loads(engine.eval(f"JSON.stringify({call})"))
    return found | {"peak": math.inf if found["peak"] is None else found["peak"]}


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, case[:5])))
def test_the_page_solves_the_exact_equations(case):
    width, height, amplitude_g, omega, half_cycles, outcome = case
    block = RigidBlock(width=width, height=height)
    motion = SinePulse(amplitude=amplitude_g * block.gravity, omega=omega, half_cycles=half_cycles)
    times = np.linspace(0.0, free_rocking_window(block, motion), 301)
    right = simulate(block, motion, duration=float(times[-1]), times=times)
    assert right.outcome.value == outcome
    found = by_the_page(block, motion, times)
    assert found["outcome"] == outcome
    assert found["peak"] / block.alpha == pytest.approx(right.peak_ratio, abs=TOLERANCE)
    if outcome != "overturned":
        assert found["impacts"] == len(right.impacts)
    shown = np.array(found["samples"])
    assert len(shown) == len(right.history.theta)
    assert shown / block.alpha == pytest.approx(right.history.theta / block.alpha, abs=TOLERANCE)


@pytest.mark.parametrize("source", ["exact", "mujoco:default"])
def test_the_commands_of_the_page_ask_what_it_shows(source, capsys, tmp_path):
    engine, write = quickjs.Context(), str(source != "exact").lower()
    engine.eval(SCRIPT)
    values = f"0.5, 3, 2, 0.4, 6.2832, '{source}', {write}"
    compare, *export = json.loads(engine.eval(f"JSON.stringify(commands({values}))"))
    assert run([*compare.split()[1:], "--json", "--jobs", "1"]) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    peak = respond(source, BLOCK, PULSE).peak_ratio
    assert (found["source"], found["peak_ratio"]) == (source, pytest.approx(peak, rel=1e-9))
    for line in export:
        assert run(line.replace("DIR", str(tmp_path)).split()[1:]) == 0
        assert f"{peak:.12g}" in capsys.readouterr().out
