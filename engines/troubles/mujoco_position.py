"""A mocap body that is put from place to place carries nothing.

Friction acts by the floor's velocity, and that of a mocap body is always zero.

Kind: teleport
"""

import mujoco

V, T, MU, G = 0.5, 1.0, 1.0, 9.81
MOCAP = '<body name="floor" mocap="true"><geom type="box" size="9 9 .5"/></body>'
WELDED = """<body name="hand" mocap="true"/>
<body name="floor"><freejoint/><geom type="box" size="9 9 .5" mass="1e3"/></body>"""
WELD = '<equality><weld body1="hand" body2="floor"/></equality>'
BLOCK = '<body name="block" pos="0 0 1"><freejoint/><geom type="box" size=".5 .5 .5"/></body>'
print("mujoco", mujoco.__version__)


def carried(floor, tie):
    """Return how far [m] a floor that moves V T carries a block."""
    text = f"<mujoco><worldbody>{floor}{BLOCK}</worldbody>{tie}</mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for step in range(round(T / model.opt.timestep)):
        data.mocap_pos[0, 0] = V * (step + 1) * model.opt.timestep
        mujoco.mj_step(model, data)
    return data.body("block").xpos[0]


expected, found = V * T - V**2 / (2 * MU * G), carried(MOCAP, "")
print(f"expected {expected:.4f} m = v t - v^2/(2 mu g); welded to it: {carried(WELDED, WELD):.4f}")
print(f"found    {found:.4f} m by positions")
print(__doc__.splitlines()[2])
raise SystemExit(bool(abs(found) > 1e-3))
