"""A scene written out as calls of Drake."""

from engines.drake.build import IN_PLANE, IN_SPACE, build, numbers, values
from engines.drake.settings import CENIC, DrakeSettings
from engines.parts.script import Script, filled, settings_of
from engines.scene import Scene

POSES = {
    True: ("theta = state[3 * number + 2]", "rate = state[3 * number + {planar}]"),
    False: (
        "theta = 2.0 * math.atan2(state[7 * number + 2], state[7 * number])",
        "rate = state[6 * number + {space}]",
    ),
}
"""Whether it is planar -> the lines of a script that read a pose."""


def script(scene: Scene, settings: DrakeSettings, dt_s: float) -> Script:
    """Return a scene as calls of Drake; see `engines.parts.script`."""
    n = numbers(scene, settings)
    lines = filled(build, n=n, s=values(scene, settings, dt_s))
    count, lines_of_pose = len(scene.bodies), POSES[settings.planar]
    across = IN_PLANE if settings.planar else IN_SPACE
    under = " - rail.get_translation(context)" * n.moving
    moved = "desired.FixValue(context, [base_x, base_velocity])"
    if settings.solver == CENIC:
        moved = "desired.FixValue(context, [base_x, -base_velocity])  # CENIC turns it round"
    return Script(
        imports=("import pydrake.all as drake",),
        settings=settings_of(lines),
        build=(
            *(line.text for line in lines),
            *("desired = plant.get_desired_state_input_port(floor.model_instance())",) * n.moving,
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            f"end = {'0.0' if settings.solver == CENIC else '-0.5 * DT'}",
        ),
        step=(
            "global end",
            "plant.mutable_gravity_field().set_gravity_vector((pull_x, 0.0, pull_z))",
            *(moved,) * n.moving,
            "end += DT",
            "simulator.AdvanceTo(end)",
        ),
        pose=(
            "state = plant.GetPositionsAndVelocities(context, blocks)",
            *(line.format(planar=3 * count + 2, space=7 * count + 1) for line in lines_of_pose),
        ),
        place=f"plant.GetPositions(context, blocks)[{across[0]}]{under}",
    )
