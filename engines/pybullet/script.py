"""A scene in PyBullet's own words, for a script that needs the library alone."""

import math
from textwrap import fill
from typing import Any

from engines.parts.script import Script
from engines.pybullet.calls import (
    Call,
    Constant,
    base_body,
    base_call,
    base_place,
    base_shape,
    block_body,
    block_call,
    block_shape,
    engine_call,
)
from engines.pybullet.settings import BulletSettings
from engines.scene import Scene

FLOOR, SHAPE, BASE, BLOCK = map(Constant, ("floor", "shape", "base", "block"))
"""Variables of the script."""


def script(scene: Scene, s: BulletSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of PyBullet; see `engines.parts.script`."""
    ground = base_place(scene, s)
    engine, bodies = engine_call(scene, s, dt_s), (block_call(scene, s, BLOCK), base_call(s, BASE))
    shape, body = block_shape(scene, s, dt_s), block_body(scene, s, SHAPE)
    settings = (engine, shape, body, *bodies)
    return Script(
        imports=("import pybullet as p",),
        settings=(f"p.setTimeStep({dt_s!r})", *map(written, settings)),
        build=(
            "p.connect(p.DIRECT)",
            written(engine),
            f"floor = {written(base_shape(scene, s))}",
            f"base = {written(base_body(FLOOR, ground))}",
            f"shape = {written(shape)}",
            f"block = {written(body)}",
            *map(written, bodies),
            *_beginning(scene),
            "p.setTimeStep(DT)",
        ),
        step=("p.setGravity(pull_x, 0.0, pull_z)", "p.stepSimulation()"),
        pose=(
            "q = p.getBasePositionAndOrientation(block)[1]",
            "theta = 2.0 * math.atan2(q[1], q[3])",
            "rate = p.getBaseVelocity(block)[1][1]",
        ),
    )


def _beginning(scene: Scene) -> tuple[str, ...]:
    """Return lines that let the block set out; it has its inertia only after a step, far aloft."""
    at, half = scene.beginning, 0.5 * scene.beginning.theta
    turned = (0.0, math.sin(half), 0.0, math.cos(half))
    velocities = (at.velocity_x, 0.0, at.velocity_z), (0.0, at.rate, 0.0)
    aloft = (0.0, 0.0, 2.0 * scene.block.height), (0.0, 0.0, 0.0, 1.0)
    return (
        f"p.resetBasePositionAndOrientation(block, {aloft[0]}, {aloft[1]})",
        "p.stepSimulation()",
        f"p.resetBasePositionAndOrientation(block, {(at.x, 0.0, at.z)}, {turned})",
        f"p.resetBaseVelocity(block, {velocities[0]}, {velocities[1]})",
    )


def written(call: Call) -> str:
    """Return a call as Python."""
    arguments = ", ".join(f"{name}={_value(value)}" for name, value in call.arguments.items())
    text = f"p.{call.name}({arguments})"
    return fill(text, 99, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def _value(value: Any) -> str:
    if isinstance(value, Constant):
        return str(value) if value.islower() else f"p.{value}"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return repr(value)
