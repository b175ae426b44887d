"""A block that friction holds has a place that is no number, and no exception or warning says so.

The solver's matrix is M + J'DJ, D growing as impratio/(1 - d): near 2^24 float32 loses M beside it.

Kind: single precision
"""

from importlib.metadata import version

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

G, DT, D = 9.81, 1e-3, 0.9999
wp.config.log_level = wp.LOG_ERROR
SOFT = f'priority="1" friction="10" solref="-1e4 -1e3" solimp="{D} {D} 0.001 0.5 2"'


def end(impratio: float) -> float:
    """Return where [m] the block is after a second, gravity leaning by 0.2."""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option cone="elliptic" impratio="{impratio}" timestep="{DT}" gravity="{G / 5} 0'
        f' -{G}"/><worldbody><geom type="plane" size="9 9 1"/><body pos="0 0 0.75"><freejoint/>'
        f'<geom type="box" size=".25 .25 .75" mass="1" {SOFT}/></body></worldbody></mujoco>'
    )
    m, d = mjw.put_model(model), mjw.make_data(model)
    with wp.ScopedCapture() as step:
        mjw.step(m, d)
    for _ in range(round(1.0 / DT)):
        wp.capture_launch(step.graph)
    return float(d.qpos.numpy()[0, 0])


low, high, found = 100.0, 1e4, end(1e4)
while np.isnan(found) and high > 1.02 * low:
    low, high = (low, at) if np.isnan(end(at := (low * high) ** 0.5)) else (at, high)
print(f"mujoco-warp {version('mujoco-warp')}: expected 0 m; at impratio {low:.0f} {end(low):.0e} m")
print(f"found    {found} m at impratio {high:.0f} and 1e4\n{__doc__.splitlines()[2]}")
raise SystemExit(not np.isnan(found))
