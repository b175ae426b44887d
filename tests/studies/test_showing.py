"""A recorded response as a table and as a picture."""

import numpy as np
import pytest
from given import BLOCK, PULSE

from analytic import simulate
from studies import plot, respond, table

TIMES = np.linspace(0.0, 2.0, 501)


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
