"""A response in a notebook, as a table and as a picture."""

import math
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from given import BLOCK, PULSE

from analytic import SinePulse, simulate
from analytic.response import Reason, Response
from studies import plot, respond, table

TIMES = np.linspace(0.0, 2.0, 501)


def shown(response):
    """Return the cells of what a notebook shows, and the points of its curve."""
    page = ET.fromstring(f"<div>{response._repr_html_()}</div>")
    cells = {row[0].text: row[1].text for row in page.iter("tr")}
    curves = [line.get("points").split() for line in page.iter("polyline")]
    return cells, [np.array([point.split(",") for point in curve], float) for curve in curves]


def test_a_notebook_shows_values_and_the_curve():
    response = simulate(BLOCK, PULSE, times=TIMES)
    cells, (curve,) = shown(response)
    assert cells["outcome"].startswith("rocked")
    assert float(cells["largest θ/θcr"]) == pytest.approx(response.peak_ratio, rel=1e-5)
    assert int(cells["impacts"]) == len(response.impacts)
    theta = response.history.theta
    # the curve hangs down where θ is positive, and its places are printed to a tenth of a pixel
    down = 60.0 - curve[:, 1]
    np.testing.assert_allclose(down / np.abs(down).max(), theta / np.abs(theta).max(), atol=2e-3)
    assert (np.diff(curve[:, 0]) >= 0.0).all() and curve[-1, 0] == 480.0


def test_a_response_without_a_history_or_a_result_shows_what_it_has():
    cells, curves = shown(simulate(BLOCK, PULSE))
    assert not curves and "message" not in cells
    cells, curves = shown(Response.failure("a < b & 'c'", reason=Reason.SLID))
    assert cells["message"] == "a < b & 'c'" and not curves
    assert "largest θ/θcr" not in cells
    cells, _ = shown(simulate(BLOCK, SinePulse.in_g(3.0, omega=6.0, half_cycles=2)))
    assert cells["largest θ/θcr"] == "inf"


@pytest.mark.parametrize("source", ["exact", "rk4", "mujoco:naive"])
def test_a_history_is_a_table_and_a_picture(source):
    response = respond(source, BLOCK, PULSE, duration=2.0, times=TIMES)
    kept = table(response)
    assert list(kept.columns) == ["time_s", "theta_rad", "velocity_rad_s"]
    np.testing.assert_array_equal(kept["theta_rad"], response.history.theta)
    assert kept["theta_rad"].abs().max() <= response.peak_ratio * BLOCK.alpha * (1.0 + 1e-12)
    axes = plot(response)
    assert axes._repr_png_().startswith(b"\x89PNG")
    line, _, ticks = axes.lines
    np.testing.assert_array_equal(line.get_ydata(), kept["theta_rad"])
    assert len(ticks.get_xdata()) == sum(i.time <= 2.0 for i in response.impacts)
    assert f"{response.peak_ratio:.4g} θcr" in axes.get_title()
    assert plot(response, axes) is axes


@pytest.mark.parametrize("show", [table, plot])
def test_what_has_no_history_is_refused(show):
    with pytest.raises(ValueError, match="no history; ask for one with times="):
        show(simulate(BLOCK, PULSE))


def test_a_long_history_is_thinned_for_a_notebook_alone():
    times = np.linspace(0.0, 2.0, 20_001)
    response = simulate(BLOCK, PULSE, times=times)
    _, (curve,) = shown(response)
    assert len(curve) == 1000 and len(table(response)) == response.history.time.size > 5000
    assert len(re.findall("<svg", response._repr_html_())) == 1
    assert math.isfinite(curve.sum())


def test_showing_loads_neither_a_table_nor_a_plot():
    code = (
        "import sys; from analytic import *\n"
        "r = simulate(RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=4.0, omega=6.0),"
        " times=[0.0, 0.1, 0.2])\n"
        "r._repr_html_()\n"
        "print(*[name for name in ('pandas', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
