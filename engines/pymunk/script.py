"""A scene in pymunk's own words, for a script that needs the library alone."""

from engines.parts.script import Script
from engines.parts.settings import given
from engines.parts.shapes import FLOOR_HEIGHTS
from engines.pymunk.settings import LEVEL, PymunkSettings
from engines.scene import Scene
from engines.world import Moment


def script(scene: Scene, s: PymunkSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of pymunk; see `engines.parts.script`."""
    margin = s.margin_of(scene, dt_s)
    space = _space(scene, s, dt_s)
    shapes = _box(scene) if s.geometry == "box" else _corners(scene, margin)
    rough = f"shape.friction = math.sqrt({float(s.friction)!r})"
    held = _held(margin) if margin else ()
    return Script(
        imports=("import pymunk",),
        settings=(f"space.step({dt_s!r})", *space, *shapes, rough),
        build=(
            "space = pymunk.Space()",
            *space,
            "base = pymunk.Body(body_type=pymunk.Body.KINEMATIC)",
            f"block = pymunk.Body({scene.mass!r}, {scene.inertia[1]!r})",
            *_beginning(scene),
            *shapes,
            "for number, pair in enumerate(zip(corners, floors)):",
            "    for shape in pair:  # a corner meets its own floor alone",
            f"        {rough}  # the product counts",
            "        shape.filter = pymunk.ShapeFilter(categories=1 << number, mask=1 << number)",
            "space.add(base, block, *corners, *floors)",
        ),
        step=(*held, "space.gravity = pull_x, pull_z", "space.step(DT)"),
        pose=("theta, rate = -block.angle, -block.angular_velocity",),
        moment=Moment.MIDDLE if s.positions else Moment.NEXT,
    )


def _space(scene: Scene, s: PymunkSettings, dt_s: float) -> tuple[str, ...]:
    wanted = {
        "iterations": s.iterations_of(scene),
        "collision_slop": s.slop_of(scene, dt_s),
        "collision_bias": s.bias,
    }
    return tuple(f"space.{name} = {value!r}" for name, value in given(wanted).items())


def _beginning(scene: Scene) -> tuple[str, ...]:
    """Return lines that let the block set out; none where it is at rest."""
    at = scene.beginning
    place = f"block.position, block.angle = {(at.x, at.z)}, {-at.theta!r}"
    if at.at_rest:
        return (place,)
    velocity = at.velocity_x, at.velocity_z
    return (place, f"block.velocity, block.angular_velocity = {velocity}, {-at.rate!r}")


def _box(scene: Scene) -> tuple[str, ...]:
    x, z, far = _sizes(scene)
    return (
        f"corners = [pymunk.Poly(block, {[(-x, -z), (x, -z), (x, z), (-x, z)]})]",
        f"floors = [pymunk.Segment(base, {(-far, 0.0)}, {(far, 0.0)}, 0.0)]",
    )


def _corners(scene: Scene, margin: float) -> tuple[str, ...]:
    x, z, far = _sizes(scene)
    deep = [(-far, -far), (far, -far), (far, 0.0), (-far, 0.0)]
    return (
        f"corners = [pymunk.Circle(block, 0.0, (x, {-z!r})) for x in {(-x, x)}]",
        f"deep = {deep}",
        f"floors = [pymunk.Poly(base, deep, radius={margin!r}) for _ in corners]",
    )


def _held(margin: float) -> tuple[str, ...]:
    """Return lines that keep the corner about which the block turns in contact, before a step."""
    return (
        "for side, floor in zip((-1.0, 1.0), floors):  # hold the pivot by a skin",
        f"    floor.unsafe_set_radius({margin!r} if -side * block.angle >= {-LEVEL!r} else 0.0)",
    )


def _sizes(scene: Scene) -> tuple[float, float, float]:
    """Return half the width, half the height and half the extent of the base [m]."""
    block = scene.block
    return 0.5 * block.width, 0.5 * block.height, FLOOR_HEIGHTS * block.height
