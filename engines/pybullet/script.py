"""A scene in PyBullet's own words, for a script that needs the library alone."""

import math
from collections.abc import Iterator
from textwrap import fill
from typing import Any

from engines.parts.script import Script, moved
from engines.pybullet.calls import (
    UPRIGHT,
    Call,
    Constant,
    aloft,
    base_body,
    base_call,
    base_place,
    base_shape,
    body_call,
    body_of,
    body_shape,
    constrained,
    engine_call,
    hold_call,
    most_force,
)
from engines.pybullet.settings import BulletSettings
from engines.scene import Scene

FLOOR, BASE = map(Constant, ("floor", "base"))
"""Variables of the script; of the first body they are ``shape`` and ``block``."""


def script(scene: Scene, s: BulletSettings, dt_s: float) -> Script:
    """Return a scene as calls of PyBullet; see `engines.parts.script`."""
    moves, holds, hold = scene.frame == "world", constrained(scene, s), hold_call(scene, s, BASE)
    place = f"[{{x}}, 0.0, {base_place(scene, s)[2]!r}]"
    ways = {
        "constraint": (f"p.changeConstraint(held_by, {place}, maxForce={most_force(scene)!r})",),
        "velocity": ("p.resetBaseVelocity(base, linearVelocity=[{v}, 0.0, 0.0])",),
        "position": (f"p.resetBasePositionAndOrientation(base, {place}, {UPRIGHT})",),
    }
    engine, base, made, settings = engine_call(scene, s, dt_s), base_call(s, BASE), [], []
    at = "p.getBasePositionAndOrientation({})[0][0]"
    names = [f"block{number or ''}" for number in range(len(scene.bodies))]
    for number, (body, name) in enumerate(zip(scene.bodies, names, strict=True)):
        shape, called = body_shape(scene, number, s, dt_s), Constant(f"shape{number or ''}")
        it, tuned = body_of(body, s, called), body_call(scene, number, s, Constant(name))
        settings += [shape, it, tuned]
        made += [f"{called} = {written(shape)}", f"{name} = {written(it)}", written(tuned)]
    return Script(
        imports=("import pybullet as p",),
        settings=(f"p.setTimeStep({dt_s!r})", *map(written, (engine, *settings, base))),
        build=(
            "p.connect(p.DIRECT)",
            written(engine),
            f"floor = {written(base_shape(scene, s))}",
            f"base = {written(base_body(scene, s, FLOOR))}",
            *made,
            written(base),
            *(f"held_by = {written(hold)}",) * holds,
            *_beginning(scene, names),
            f"bodies = [{', '.join(names)}]",
            "p.setTimeStep(DT)",
        ),
        step=(
            *moved(scene, s.floor, 1.0, ways),
            *("p.setGravity(pull_x, 0.0, pull_z)", "p.stepSimulation()"),
        ),
        pose=(
            "q = p.getBasePositionAndOrientation(bodies[number])[1]",
            "theta = 2.0 * math.atan2(q[1], q[3])",
            "rate = p.getBaseVelocity(bodies[number])[1][1]",
        ),
        place=f"{at.format('block')}{(' - ' + at.format('base')) * moves}",
    )


def _beginning(scene: Scene, names: list[str]) -> Iterator[str]:
    """Yield lines that let bodies set out; each has its inertia only after a step, far aloft."""
    for place, name in zip(aloft(scene), names, strict=True):
        yield f"p.resetBasePositionAndOrientation({name}, {place}, {UPRIGHT})"
    yield "p.stepSimulation()"
    for body, name in zip(scene.bodies, names, strict=True):
        at, half = body.at, 0.5 * body.at.theta
        turned = (0.0, math.sin(half), 0.0, math.cos(half))
        velocities = (at.velocity_x, 0.0, at.velocity_z), (0.0, at.rate, 0.0)
        yield f"p.resetBasePositionAndOrientation({name}, {(at.x, 0.0, at.z)}, {turned})"
        yield f"p.resetBaseVelocity({name}, {velocities[0]}, {velocities[1]})"


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
