"""A box that leans on another box is held by one of its two corners three times over.

Of two boxes MJX returns four contacts whatever they touch in; those left over repeat one.

Kind: contact point
"""

from importlib.metadata import version

import jax
import mujoco
import numpy as np
from mujoco import mjx

LEAN, DEPTH = 1e-2, 1e-5
BOXES = (
    '<mujoco><worldbody><geom type="box" size="5 5 .5" pos="0 0 -.5"/><body><freejoint/>'
    '<geom type="box" size=".25 .25 .75"/></body></worldbody></mujoco>'
)
model = mujoco.MjModel.from_xml_string(BOXES)
data = mujoco.MjData(model)
data.qpos[2] = 0.75 * np.cos(LEAN) + 0.25 * np.sin(LEAN) - DEPTH
data.qpos[3], data.qpos[5] = np.cos(0.5 * LEAN), np.sin(0.5 * LEAN)
mujoco.mj_forward(model, data)
contact = jax.jit(mjx.forward)(mjx.put_model(model), mjx.put_data(model, data))._impl.contact
sides = np.round(np.asarray(contact.pos)[np.asarray(contact.dist) < 0.0, 1], 3)
expected = np.round([one.pos[1] for one in data.contact], 3)
print(f"mujoco-mjx {version('mujoco-mjx')}, beside MuJoCo's own {version('mujoco')}")
print(f"expected a contact at each y of {sorted(expected.tolist())} m")
print(f"found    contacts at y = {sorted(sides.tolist())} m\n{__doc__.splitlines()[2]}")
raise SystemExit(len(sides) == len(set(sides.tolist())))
