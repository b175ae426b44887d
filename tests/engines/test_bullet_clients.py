"""PyBullet's clients: a run in one that others have used is that of a new one, to the bit."""

import itertools

import pytest

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Outcome
from engines import Scene
from engines.pybullet import clients as bullet_clients
from engines.pybullet.build import BulletWorld
from engines.pybullet.settings import FACTORS, LANDING, TUNED
from engines.run.drive import run

pytest.importorskip("pybullet")

BLOCK = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse(amplitude=0.45 * BLOCK.gravity, omega=4.0 * BLOCK.p)


@pytest.fixture(autouse=True)
def new_ones(monkeypatch):
    monkeypatch.setattr(bullet_clients, "idle", [])


def asked(**options):
    """Return what a run answers, but for the time it took."""
    scene = Scene(**{"system": BLOCK, "motion": PULSE, **options})
    found = run("pybullet", scene)
    return (found.outcome, repr(found.peak_ratio), found.message, found.steps, found.impacts)


RELEASED = {"start": (0.5 * BLOCK.alpha, 0.0), "preset": "naive"}
FEW = {"max_steps": 30}


@pytest.mark.parametrize("wanted", [RELEASED, {}])
def test_nothing_stays_of_any_setting(wanted):
    first = asked(**wanted)
    for level in itertools.chain.from_iterable(factor.levels for factor in FACTORS):
        for preset in level.presets:
            asked(preset=preset, settings=level.settings, **FEW, **level.scene)
        assert len(bullet_clients.idle) == 1
        assert asked(**wanted) == first, level.name


def test_two_worlds_at_once_have_a_client_each():
    scene = Scene(system=BLOCK, motion=PULSE)
    worlds = [BulletWorld(scene, settings, 1e-3) for settings in (TUNED, LANDING)]
    for world in worlds:
        world.close()
    assert len(set(bullet_clients.idle)) == 2


def test_a_run_that_was_lost_spoils_none_after_it():
    first = asked()
    lost = asked(preset="naive", motion=SinePulse(amplitude=1e30, omega=1.0))
    assert lost[0] is Outcome.FAILED
    assert asked() == first
