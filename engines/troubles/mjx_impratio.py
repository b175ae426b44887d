"""A block that friction holds has a place that is no number, and no exception or warning says so.

The solver's matrix is M + J'DJ, D growing as impratio/(1 - d): near 2^24 float32 loses M beside it,
and its factor of Cholesky is no number.

Kind: single precision
"""

from importlib.metadata import version

import jax
import mujoco
import numpy as np
from mujoco import mjx

G, DT, D = 9.81, 1e-3, 0.9999
SOFT = f'priority="1" friction="10" solref="-1e4 -1e3" solimp="{D} {D} 0.001 0.5 2"'
step = jax.jit(mjx.step)


def end(impratio: float) -> float:
    """Return where [m] the block is after a second, gravity leaning by 0.2."""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option cone="elliptic" impratio="{impratio}" timestep="{DT}" gravity="{G / 5} 0'
        f' -{G}"/><worldbody><geom type="plane" size="9 9 1"/><body pos="0 0 0.75"><freejoint/>'
        f'<geom type="box" size=".25 .25 .75" mass="1" {SOFT}/></body></worldbody></mujoco>'
    )
    m, d = mjx.put_model(model), mjx.make_data(model)
    for _ in range(round(1.0 / DT)):
        d = step(m, d)
    return float(d.qpos[0])


low, high, found = 100.0, 1e4, end(1e4)
while np.isnan(found) and high > 1.1 * low:
    low, high = (low, at) if np.isnan(end(at := (low * high) ** 0.5)) else (at, high)
print(f"mujoco-mjx {version('mujoco-mjx')}: expected 0 m; at impratio {low:.0f} {end(low):.0e} m")
print(f"found    {found} m from impratio {high:.0f} on\n{__doc__.splitlines()[2]}")
raise SystemExit(not np.isnan(found))
