"""A floor that is welded to a mocap body lags behind.

The weld damps the floor against the mocap body's velocity, which is zero: b v = k r.

Kind: weak constraint
"""

import mujoco

V, T = 1.0, 2.0
TIME, RATIO = 0.02, 1.0  # solref; with d of solimp b = 2/(d TIME), k = 1/(d TIME RATIO)^2 * d
XML = """<mujoco><worldbody><body name="hand" mocap="true"/>
<body name="floor"><freejoint/><geom type="box" size="9 9 .5" mass="1e3"/></body></worldbody>
<equality><weld body1="hand" body2="floor"/></equality></mujoco>"""
print("mujoco", mujoco.__version__)
model = mujoco.MjModel.from_xml_string(XML)
data = mujoco.MjData(model)
for step in range(round(T / model.opt.timestep)):
    data.mocap_pos[0, 0] = V * (step + 1) * model.opt.timestep
    mujoco.mj_step(model, data)
found, lag = V * T - data.body("floor").xpos[0], 2 * TIME * RATIO**2 * V
print("expected 0.0000 m behind: it is welded")
print(f"found    {found:.4f} m; v b/k = 2 timeconst dampratio^2 v gives {lag:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(bool(abs(found - lag) > 1e-4))
