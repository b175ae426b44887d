"""PyBullet: its clients, its solver at rest."""

import itertools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from declared import run
from given import BLOCK, all_but_times, pulse
from uses import rocked, scene

from analytic import RigidBlock, SinePulse
from analytic.response import Outcome
from engines import ENGINES
from engines.pybullet import FACTORS
from engines.pybullet import build as bullet
from engines.run.run import build, simulate_world

p = pytest.importorskip("pybullet")


def apart(number):
    """Return a scene in which contacts are kept up to a gap of its own."""
    block = RigidBlock(width=0.2 + 0.1 * number, height=1.5)
    return scene(pulse(1.3, 3.0, 1, block), system=block, accuracy="loose")


def answer(number):
    return all_but_times(run("pybullet", apart(number)))


def test_worlds_at_once_keep_their_own_gaps():
    """The library holds that up to which contacts are kept for the whole process, and looks at it
    when two bodies meet first: on a plane, while a scene is built."""
    engine, alone, asked = ENGINES["pybullet"], answer(1), apart(1)
    world, other = build(engine.use(asked)), build(engine.use(replace(asked, preset="naive")))
    dt_s, resolution = engine.use(asked).dt_s, engine.use(asked).resolution
    response = simulate_world(world, asked, dt_s, resolution=resolution)
    world.close()
    other.close()
    assert all_but_times(response) == alone


def test_threads_do_not_disturb_each_other():
    alone = [answer(number) for number in range(6)]
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(answer, 4 * list(range(6)))) == 4 * alone


def test_the_solver_ends_by_itself_at_rest():
    """More iterations change nothing: places that contradict each other would use them all up."""
    block = RigidBlock(width=0.5, height=1.0)
    motion = pulse(1.3, 0.1, 2, block)
    times = [0.1 * i for i in range(20)]  # the block lifts after 2.5 s
    asked = {"system": block, "times": times}
    enough, more = (
        rocked("pybullet", motion, **asked, settings={"iterations": iterations})
        for iterations in (1000, 3000)
    )
    assert (enough.history.theta == more.history.theta).all()


@pytest.mark.parametrize("wanted", [{"start": (0.5 * BLOCK.alpha, 0.0), "preset": "naive"}, {}])
def test_nothing_stays_of_any_setting(wanted, monkeypatch):
    """A run in a client that others have used, or in which one failed, is that of a new one."""
    monkeypatch.setattr(bullet, "idle", [])

    def answered():
        return all_but_times(rocked("pybullet", pulse(1.35, 4.0), **wanted))

    first = answered()
    lost = rocked("pybullet", SinePulse(amplitude=1e30, omega=1.0), preset="fixed")
    assert lost.outcome is Outcome.FAILED
    for level in itertools.chain.from_iterable(factor.levels for factor in FACTORS):
        for preset in level.presets:
            few = {"preset": preset, "settings": level.settings, "max_steps": 30}
            rocked("pybullet", pulse(1.35, 4.0), **few, **level.scene)
        assert len(bullet.idle) == 1
        assert answered() == first, level.name
