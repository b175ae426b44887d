"""A scene in MuJoCo's own words, for a script that needs the library alone."""

from collections.abc import Iterator

from engines.mujoco.model import coordinates, stepped_xml, welded
from engines.mujoco.settings import MujocoSettings, kept
from engines.mujoco.stacks import softened
from engines.parts.script import Script
from engines.scene import Scene
from engines.world import Moment

MODEL = "block.xml"
"""File of the model, beside the script."""

SAID = ("<option", "<geom", "<pair", "<weld")
"""Elements of a model that a preset sets, the joints apart."""

PLANAR_POSE = ("theta, rate = data.qpos[3 * number + 2], data.qvel[3 * number + 2]",)
FREE_POSE = (
    "theta = 2.0 * math.atan2(data.qpos[7 * number + 5], data.qpos[7 * number + 3])",
    "rate = data.qvel[6 * number + 4]",
)


def _beginning(scene: Scene, s: MujocoSettings) -> tuple[str, ...]:
    """Return lines that let the block set out; none where it is at rest."""
    if all(body.at.at_rest for body in scene.bodies):
        return ()
    place, velocity = coordinates(scene, s)
    return (f"data.qpos[:] = {place}", f"data.qvel[:] = {velocity}")


def _step(scene: Scene, s: MujocoSettings) -> Iterator[str]:
    """Yield lines that take a step; a base without a body of its own is moved after it."""
    move = ("data.mocap_pos[0, 0] = base_x",) * (scene.frame == "world")
    if move and s.floor == "surfacevel":
        yield "model.geom_surfacevel[0, 0] = base_velocity"
    if welded(scene, s):
        yield from move
    yield from ("model.opt.gravity[:] = pull_x, 0.0, pull_z", "mujoco.mj_step(model, data)")
    if not welded(scene, s):
        yield from move


def script(scene: Scene, s: MujocoSettings, dt_s: float) -> Script:
    """Return a scene as a model of MuJoCo; see `engines.parts.script`.

    Parameters
    ----------
    scene : Scene, whose frame says whether the base moves
    s : MujocoSettings, of which impratio is kept to what the friction allows
    dt_s : float, the step [s], which stands in the model
    """
    s = kept(scene, softened(scene, s) if scene.stacked else s)
    model = stepped_xml(scene, s, dt_s)
    lines = map(str.strip, model.splitlines())
    # the joint of a welded base is the last, a free one
    under = f" - {'data.qpos[-7]' if welded(scene, s) else 'base_x'}" * (scene.frame == "world")
    return Script(
        imports=("import mujoco",),
        settings=tuple(dict.fromkeys(line for line in lines if line.startswith(SAID))),
        build=(
            f'model = mujoco.MjModel.from_xml_path(str(HERE / "{MODEL}"))',
            "data = mujoco.MjData(model)",
            *_beginning(scene, s),
        ),
        step=tuple(_step(scene, s)),
        pose=PLANAR_POSE if s.planar else FREE_POSE,
        place=f"data.qpos[0]{under}",
        moment=Moment.END if s.integrator == "RK4" else Moment.MIDDLE,
        files={MODEL: model},
    )
