"""What the contract promises: what is missing, what is coarse, and who chooses the steps."""

import importlib
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from known import Bare
from scipy.integrate import solve_ivp
from uses import (
    BLOCK,
    HERE,
    SHAKEN,
    WITH_BULLET,
    error,
    every_use,
    held_frames,
    pulse,
    rocked,
    scene,
)

from analytic import RigidBlock, SinePulse, simulate
from analytic.response import Outcome, Reason
from engines import ENGINES
from engines.declaration import UNTUNED, Precision, Preset, Stepping
from engines.parts.quiet import imported
from engines.pybullet.build import BulletWorld
from engines.run.drive import build, run
from engines.world import Pose
from studies.cases.variants import variants


def use(monkeypatch, engine):
    """Let `run` find an engine under any name."""
    monkeypatch.setattr("engines.run.drive.find", lambda name: engine)


def test_a_library_that_is_missing_is_a_row_that_says_so(monkeypatch):
    def missing(*_):
        raise ModuleNotFoundError("No module named 'nothing'")

    use(monkeypatch, replace(ENGINES["pybullet"], build=missing, install="rocking[nothing]"))
    response = rocked("any")
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert "'nothing'; pip install 'rocking[nothing]'" in response.message


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"frames": ("base",)}, "'world'"),
        ({"geometries": ("box",)}, "'hull'"),
        ({"spatial": False}, "plane"),
    ],
)
def test_what_an_engine_cannot_do_is_a_row_that_says_so(change, named, monkeypatch):
    use(monkeypatch, replace(ENGINES["pybullet"], **change))
    settings = {"planar": False, "geometry": "hull"}
    response = rocked("any", frame="world", settings=settings)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert named in response.message


@pytest.mark.parametrize("name", ENGINES)
def test_a_declaration_is_whole(name):
    engine = ENGINES[name]
    assert engine.name == name
    assert engine.presets[0].name == "naive"
    assert "step" in [source.setting for source in engine.presets[0].documented]
    assert not engine.presets[0].helped_by
    naive, bare = engine.presets[0], type(engine.presets[0].settings)()
    assert all(getattr(naive.settings, name) != value for name, value in naive.own.items())
    assert replace(bare, **{name: getattr(naive.settings, name) for name in naive.own}) == (
        naive.settings
    )
    assert not any(use.deviations for use in engine.presets if use.name not in UNTUNED)
    for preset in engine.presets:
        assert isinstance(preset.settings.friction, float)
        for left_out in filter(None, preset.helped_by.values()):
            assert replace(preset.settings, **left_out) != preset.settings
    for item in engine.factors:
        assert all(hasattr(engine.best.settings, setting) for setting in item.settings)
    tried = {(it.preset, it.factor, it.level) for it in variants(name)}
    assert {(rule.preset, rule.factor, rule.level) for rule in engine.rules} <= tried


def takes(engine, **options):
    """Build a scene, and go some steps: the library has refused no setting, then or before."""
    posed = scene(pulse(1.3, 1.0), **options)
    world = build(HERE[engine], posed)
    assert world.fault() == "", options
    world.close()
    assert run(engine, replace(posed, max_steps=20)).reason is not Reason.FAULT


@every_use
def test_what_a_preset_sets_is_taken_and_what_helps_it_can_be_left_out(engine, preset):
    """One at a time: what a preset is helped by is a setting, so that its price can be measured."""
    for frame in held_frames(engine, preset):
        takes(engine, preset=preset, frame=frame)
    for left_out in filter(None, HERE[engine].preset(preset).helped_by.values()):
        takes(engine, preset=preset, settings=left_out)


@pytest.mark.parametrize("engine", HERE)
def test_what_a_variant_sets_is_taken(engine):
    tried = list(variants(engine))
    assert {variant.factor for variant in tried} >= {it.name for it in HERE[engine].factors}
    for variant in tried:
        takes(engine, preset=variant.preset, settings=variant.settings, **variant.scene)


def bullet_box(library):
    client = library.connect(library.DIRECT)
    size = {"halfExtents": (1, 1, 1), "physicsClientId": client}
    box = library.createCollisionShape(library.GEOM_BOX, **size)
    body = library.createMultiBody(1.0, box, physicsClientId=client)
    friction = library.getDynamicsInfo(body, -1, physicsClientId=client)[1]
    library.disconnect(client)
    return friction


def box2d_box(library):
    shape = library.b2FixtureDef(shape=library.b2PolygonShape(box=(1, 1)))
    world = library.b2World()  # a body does not outlive it
    return world.CreateDynamicBody(fixtures=shape).fixtures[0].friction


def rapier_box(library):
    world, box = library.PhysicsWorld(), library.Collider.cuboid(1.0, 1.0, 1.0)
    body = world.rigid_bodies[world.add_body(library.RigidBody.dynamic(), [box])]
    return world.colliders[body.colliders[0]].friction


def drake_box(_):
    config = importlib.import_module("pydrake.geometry").SceneGraphConfig()
    return config.default_proximity_properties.dynamic_friction


BARE = {
    "pybullet": bullet_box,
    "box2d": box2d_box,
    "rapier": rapier_box,
    "drake": drake_box,
    "pymunk": lambda library: library.Poly.create_box(library.Body(1.0, 1.0)).friction,
    "physx": lambda library: library.physx.get_default_material().static_friction,
}
"""The friction of a box of which nothing is said, in each library."""


@pytest.mark.parametrize("engine", [name for name in HERE if HERE[name].preset("naive").own])
def test_what_is_called_a_library_s_own_is_what_it_makes_by_itself(engine):
    """And a squat block slides at it."""
    own = BARE[engine](imported(HERE[engine].library))
    assert HERE[engine].preset("naive").own == {"friction": pytest.approx(own, rel=1e-7)}
    cube, sine = RigidBlock(width=0.5, height=0.5), SinePulse.in_g(1.5, omega=8.0, half_cycles=2)
    assert simulate(cube, sine).friction_needed > own
    response = rocked(engine, sine, system=cube, preset="naive", settings={"friction": own})
    assert response.reason is Reason.SLID


@WITH_BULLET
def test_faults_are_asked_while_a_run_goes_on(monkeypatch):
    """A setting that was not taken ends a run long before its hour of rest is over."""
    monkeypatch.setattr(BulletWorld, "fault", lambda self: "the moon is full")
    response = rocked("pybullet", pulse(0.5, 1.0), preset="fixed", duration=3600.0)
    assert response.message == "the moon is full"
    assert response.steps < 1000


class RoundedWorld(BulletWorld):
    """PyBullet, told in the numbers of single precision."""

    drive = None

    def state(self):
        return np.array(super().state(), dtype=np.float32).astype(np.float64)


class TremblingWorld(BulletWorld):
    """PyBullet, with a height that single precision rounds otherwise at every look."""

    drive, looks = None, 0

    def state(self):
        ((x, z, theta, rate),) = super().state().tolist()
        self.looks += 1
        return [Pose(x, z * (1.0 + 6e-8 * math.sin(self.looks)), theta, rate)]


SINGLE = {"precision": Precision.SINGLE, "shortest_step": 1e-6}
DOUBLE = {"precision": Precision.DOUBLE, "shortest_step": 1e-12}


@WITH_BULLET
def test_single_precision_is_judged_by_what_it_tells_apart(monkeypatch):
    """A block at rest, whose corners are 6e-8 of its height off in single precision."""
    at_rest = []
    for precision in (DOUBLE, SINGLE):
        use(monkeypatch, replace(HERE["pybullet"], build=TremblingWorld, **precision))
        at_rest.append(rocked("any", pulse(0.9, 1.0), duration=5.0).outcome is Outcome.AT_REST)
    assert at_rest == [False, True]


@WITH_BULLET
def test_single_precision_rocks(monkeypatch):
    """Rotations rounded to 6e-8 of themselves, heights to 6e-8 of the block's: an impact is seen
    1e-7 of a width too early or late."""
    use(monkeypatch, replace(HERE["pybullet"], build=RoundedWorld, **SINGLE))
    assert error("any") < 1e-4


@dataclass(frozen=True)
class SpringSettings:
    friction: float = 1.0
    tolerance: float = 1e-7


class SpringWorld(Bare):
    """Two corners on springs whose damping goes with their depth, in steps chosen by RK23."""

    def __init__(self, scene, settings, dt_s):
        (body,), block = scene.bodies, scene.system
        self._mass, self._inertia, at = body.mass, body.inertia[1], body.at
        self._scene, self._tolerance, self._time = scene, settings.tolerance, 0.0
        self._at = [at.x, at.z, at.theta, at.velocity_x, at.velocity_z, at.rate]
        self._half = (0.5 * block.width, 0.5 * block.height)
        self._spring = 1e6 * body.mass * block.p**2
        self._damping = 300.0 / (block.p * block.width)

    def _rates(self, time, state):
        _, z, theta, vx, vz, rate = state
        scene, sine, cosine = self._scene, math.sin(theta), math.cos(theta)
        along = -self._mass * float(scene.motion.acceleration(time))
        up = -self._mass * scene.system.gravity
        moment = 0.0
        for side in (-self._half[0], self._half[0]):
            arm, level = side * cosine - self._half[1] * sine, -side * sine - self._half[1] * cosine
            depth = -(z + level)
            if depth > 0.0:
                force = self._spring * depth
                push = force * max(1.0 - self._damping * (vz - rate * arm), 0.0)
                drag = -force * self._damping * (vx + rate * level)
                along, up = along + drag, up + push
                moment += drag * level - push * arm
        return [vx, vz, rate, along / self._mass, up / self._mass, moment / self._inertia]

    def advance(self, end_s):
        path = solve_ivp(
            self._rates, (self._time, end_s), self._at, "RK23",
            rtol=self._tolerance, atol=self._tolerance,
        )  # fmt: skip
        self._at, self._time = path.y[:, -1].tolist(), end_s
        return len(path.t) - 1

    def state(self):
        x, z, theta, _, _, rate = self._at
        return [Pose(x, z, theta, rate)]


def test_an_engine_may_choose_its_own_steps(monkeypatch):
    """It is told times to go to, on the corners of the motion among them; contact is yielding."""
    own = Preset(name="own", title="", settings=SpringSettings(), stepping=Stepping.OWN)
    use(monkeypatch, replace(ENGINES["pybullet"], build=SpringWorld, presets=(own,)))
    response = rocked("any", accuracy="loose")
    assert response.outcome is Outcome.ROCKED, response.message
    assert len(response.impacts) == 1
    # an impact on a spring of 1e6 m p^2 takes some 1e-3/p
    assert response.impacts[0].ratio == pytest.approx(BLOCK.restitution, rel=1e-2)
    assert response.peak_ratio == pytest.approx(simulate(BLOCK, SHAKEN).peak_ratio, rel=1e-2)
    assert response.steps > 40.0 * BLOCK.p * SHAKEN.duration
