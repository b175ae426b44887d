"""A cube that is launched along the ground takes off.

Convex friction lets it slide at v only where it rises at mu v: the launch is an impact.

Kind: friction model
"""

import mujoco

V, MU, G, DT = 6.0, 0.5, 9.81, 1e-3
MODEL = f"""<mujoco><option cone="elliptic" timestep="{DT}" impratio="1e6" tolerance="1e-15"/>
<worldbody><geom name="ground" type="plane" size="9 9 1"/>
  <body pos="0 0 0.5"><freejoint/><geom name="cube" type="box" size="0.5 0.5 0.5"/></body>
</worldbody>
<contact><pair geom1="ground" geom2="cube" friction="{MU} {MU}" solimp="{{0}} {{0}}"
  solref="{-0.01 / DT**2} {{1}}" solreffriction="-1 {{2}}"/></contact></mujoco>"""


def lift(impedance: float, damping: float) -> float:
    """Return how high it is seen above the ground, launched after half a second at rest [m]."""
    reference = -damping / DT, -impedance / DT
    model = mujoco.MjModel.from_xml_string(MODEL.format(impedance, *reference))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=500)
    data.qvel[0], heights = V, []
    for _ in range(1500):
        mujoco.mj_step(model, data)
        heights.append(data.qpos[2] - 0.5)
    return max(heights)


flat, found, throw = lift(1e-4, 0.1), lift(0.999, 1.0), (MU * V / (1 + MU**2)) ** 2 / (2 * G)
print(f"mujoco {mujoco.__version__}: expected 0 m, as with solimp 1e-4 {flat:.4f}: it slides")
print(f"found    {found:.4f} m; a throw at mu v/(1 + mu^2) rises by {throw:.4f} m")
print(__doc__.splitlines()[2])
raise SystemExit(bool(abs(found - throw) > 0.05 * throw or flat > 1e-3))
