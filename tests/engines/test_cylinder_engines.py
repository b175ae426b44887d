"""A cylinder that rolls in space: every engine that holds one, and the law of its error."""

import math
from dataclasses import replace

import numpy as np
import pytest
from known import Bare
from uses import HERE

from analytic import RollingCylinder, Still
from analytic.response import Reason, RollingOutcome
from engines import ENGINES
from engines.layouts import Ability
from engines.physx.cylinder import PhysxCylinder
from engines.registry import OWN
from engines.space import axes, roll, rotated
from studies import respond
from studies.sources.rolling import space_scene

FLAT = RollingCylinder(radius=0.5, height=0.5, tilt=0.2)
HOLD = ("pybullet", "mujoco", "dart", "rapier", "drake", "newton", "physx")
HOLDING = [name for name in HERE if name in HOLD]
COARSE = ("newton", "physx")
every_one = pytest.mark.parametrize("name", HOLDING)
UP = np.array([0.0, 0.0, 1.0])


def turned(name, turns=1.0, **options):
    return respond(f"{name}:fixed", FLAT, duration=turns * FLAT.turn, **options)


@every_one
def test_an_engine_rolls_it(name):
    """A turn of 1.3e-4 s steps at most costs 6e-4 rad in tilt by the law below."""
    found = turned(name)
    assert found.outcome is RollingOutcome.ROLLED, found.message
    most = 0.1 if name in COARSE else 2e-3
    assert abs(found.observables["tilt_error_rad"]) < most
    assert abs(found.observables["phase_error_rad"]) < 50.0 * most
    assert found.observables["sink_m"] < 5e-3


def test_who_does_not_hold_it_says_why():
    assert {name for name in OWN if Ability.CYLINDER in ENGINES[name].holds} == set(HOLD)
    others = {f"{name}:fixed": "" for name in set(ENGINES) - set(HOLD)}
    others |= {"pymunk:fixed": "the plane alone", "mujoco:landing": "on whose impacts"}
    others |= {"drake:error-controlled": "not built here for a cylinder in space"}
    for name, words in others.items():
        found = respond(name, FLAT, duration=FLAT.turn)
        assert found.reason is Reason.UNAVAILABLE
        assert words in found.message


@every_one
def test_aloft_it_turns_as_a_free_top(name):
    """Its angular momentum stays, and its axis turns about that at |L|/A: the inertia is its own.

    A first-order step errs by (rates dt) of the turn of 0.1 s: 2e-3.
    """
    scene = space_scene(FLAT, Still(), duration=0.1)
    body = scene.cylinder
    aloft = replace(body, place=(0.0, 0.0, 5.0))
    states = roll(name, replace(scene, cylinder=aloft, preset="fixed", every=0.1)).states
    across, _, along = body.inertia
    first, spin = axes(states)[0], np.array(body.spin)
    momentum = across * spin + (along - across) * (spin @ first) * first
    rate, about = np.linalg.norm(momentum) / across, momentum / np.linalg.norm(momentum)
    c, s = math.cos(0.1 * rate), math.sin(0.1 * rate)
    expected = c * first + s * np.cross(about, first) + (1 - c) * (about @ first) * about
    assert axes(states)[-1] == pytest.approx(expected, abs=2e-3)
    assert states[-1, 2] == pytest.approx(5.0 - 0.5 * FLAT.gravity * 0.01, abs=1e-3)


def lagging(dt, turns, grip=True):
    """Roll by velocity steps that hold the point which is lowest as a step begins.

    Nothing is taken from an engine: v and w get the weight's and the gyroscopic change, then the
    impulse that takes the velocity out of that point, or its vertical part alone, and carry on.
    """
    across, along = 0.25 * 0.25 + 0.25 / 12.0, 0.125
    axis, spin = FLAT.at(0.0).axis[0], FLAT.at(0.0).rates[0]
    place, velocity = FLAT.centre_height * UP, np.zeros(3)
    for _ in range(round(turns * FLAT.turn / dt)):
        inertia = across * np.eye(3) + (along - across) * np.outer(axis, axis)
        slope = UP - axis[2] * axis
        foot = -0.25 * axis - 0.5 * slope / np.linalg.norm(slope)
        velocity = velocity - dt * FLAT.gravity * UP
        spin = spin - dt * np.linalg.solve(inertia, np.cross(spin, inertia @ spin))
        arm = np.cross(foot, np.eye(3)).T
        eased = np.linalg.inv(inertia)
        yielding = np.eye(3) - arm @ eased @ arm
        wanted = -0.01 * (place + foot)[2] / dt * UP - velocity - np.cross(spin, foot)
        impulse = np.linalg.solve(yielding, wanted) if grip else wanted[2] / yielding[2, 2] * UP
        velocity, spin = velocity + impulse, spin + eased @ np.cross(foot, impulse)
        place = place + dt * velocity
        rate = np.linalg.norm(spin)
        c, s, about = math.cos(rate * dt), math.sin(rate * dt), spin / rate
        axis = c * axis + s * np.cross(about, axis) + (1 - c) * (about @ axis) * about
    return math.acos(axis[2]) - FLAT.tilt


@pytest.mark.skipif("mujoco" not in HERE, reason="MuJoCo is not installed")
def test_friction_that_holds_where_the_foot_was_is_what_mujoco_errs_by():
    """The foot goes on meanwhile: an error of first order, of which little is left unheld."""
    dt, turns = 2.0 * 2.5e-4 / FLAT.p, 1.0
    held, free = (
        turned("mujoco", turns, step=5e-4, **options).observables["tilt_error_rad"]
        for options in ({}, {"friction": 0.0})
    )
    assert held == pytest.approx(lagging(dt, turns), rel=0.02)
    assert free == pytest.approx(lagging(dt, turns, grip=False), rel=0.02, abs=2e-6)
    half = turned("mujoco", turns).observables
    assert held / half["tilt_error_rad"] == pytest.approx(2.0, abs=0.05)
    quarter = turned("mujoco", turns, step=1.25e-4).observables["phase_error_rad"]
    assert half["phase_error_rad"] / quarter == pytest.approx(2.0, abs=0.05)


@pytest.mark.skipif("physx" not in HERE, reason="SAPIEN is not installed")
def test_the_cylinder_of_physx_has_32_sides():
    """In the body, its contacts stand at multiples of 360/32 degrees about the axis."""
    scene = space_scene(FLAT, Still())
    world = PhysxCylinder(scene, ENGINES["physx"].preset("fixed").chosen(scene), 1e-4)
    angles = []
    for _ in range(400):
        world.step()
        place, turn, *_ = world.state()
        for contact in world._system.get_contacts():
            for point in contact.points:
                x, y, z = point.position
                at = np.array((x, y, z + world._sunk)) / world._unit - place
                x, y, _ = rotated(turn, at, back=True)
                angles.append(math.atan2(y, x))
    world.close()
    sides = np.array(angles) * 32.0 / (2.0 * math.pi)
    assert len(sides) > 100 and sides == pytest.approx(np.round(sides), abs=0.02)
    assert len(set(np.round(sides))) > 3


def test_a_start_that_is_not_taken_is_a_fault():
    class Slow(Bare):
        def __init__(self, scene, settings, dt_s):
            it = scene.cylinder
            self.read = it.place, it.turn, it.velocity, np.zeros(3)

        def state(self):
            return self.read

    slow = replace(ENGINES["mujoco"], builders={Ability.CYLINDER: Slow})
    track = roll(slow, replace(space_scene(FLAT, Still(), duration=0.1), preset="fixed"))
    assert track.problem.reason is Reason.FAULT
    assert track.problem.message.startswith("spin was set to (-3.1")


@pytest.mark.skipif("rapier" not in HERE, reason="Rapier is not installed")
def test_what_sleeps_flat_lies_down_and_is_no_fault():
    found = respond("rapier:naive", FLAT, duration=50.0 * FLAT.turn)
    assert found.outcome is RollingOutcome.LAY_DOWN and found.reason is None
