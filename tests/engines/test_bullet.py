"""PyBullet's compiled loop, which is left alone where it is not what it should be; its clients."""

import itertools
import multiprocessing
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from given import BLOCK, all_but_times, pulse
from uses import rocked, scene

from analytic.block import RigidBlock
from engines import ENGINES
from engines.pybullet import build as bullet
from engines.pybullet import clients as bullet_clients
from engines.pybullet import fast as bullet_loop
from engines.pybullet.addresses import spans
from engines.pybullet.settings import FACTORS
from engines.run.drive import build, run, simulate_world
from engines.world import ContactPhase

p = pytest.importorskip("pybullet")

ROCKS = scene(accuracy="loose")


def forget():
    bullet_loop.clients.cache_clear()
    bullet.loop_agrees.cache_clear()


@pytest.fixture(autouse=True)
def asked_anew():
    forget()
    yield
    forget()


def driven(asked):
    world = build(ENGINES["pybullet"], asked)
    world.close()
    return world.drive is not None


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("CLIENTS", "sPhysicsClientsGUI"),  # none is there
        ("CLIENTS", "sNobody"),
        ("DIRECT", "_ZTV25PhysicsClientSharedMemory"),  # clients of another kind
        ("FUNCTIONS", (bullet_loop.CFunction("b3Nothing", bullet_loop.HANDLE),)),
    ],
)
def test_another_build_is_stepped_from_python(name, other, monkeypatch):
    compiled = all_but_times(run("pybullet", ROCKS))
    assert driven(ROCKS)
    forget()
    monkeypatch.setattr(bullet_loop, name, other)
    assert not driven(ROCKS)
    stepped = run("pybullet", ROCKS)
    assert stepped.driver == "python: the library is another build, whose clients are not known"
    assert all_but_times(stepped) == compiled


def test_a_library_without_symbols_is_left_alone(tmp_path):
    (tmp_path / "library").write_bytes(b"MZ" + bytes(100))
    with pytest.raises(ValueError, match="library is no ELF file of 64 bits"):
        spans(tmp_path / "library", "anything")


def test_where_functions_stand():
    """Two that can be asked for, too, are as far apart as they were loaded."""
    names = ("b3ConnectPhysicsDirect", "b3InitStepSimulationCommand")
    (first, _), (second, size) = spans(Path(p.__file__), *names)
    assert bullet_loop.clients(p).size
    loaded = [bullet_loop.address_of(name) for name in names]
    assert second - first == loaded[1] - loaded[0]
    assert 0 < size < 1000


OTHERWISE = {"contact_erp": 0.5, "friction_erp": 0.5, "ordinary": 1.0}
OTHERWISE |= dict.fromkeys(("by_phase", "moving", "base_velocity"), False)


@pytest.mark.parametrize("name", OTHERWISE)
def test_a_loop_that_steps_otherwise_is_not_used(name, monkeypatch):
    assert bullet.loop_agrees()
    bullet.loop_agrees.cache_clear()
    begin = bullet.begin_contact
    looped = iter((True, False))

    def otherwise(held, *rest):
        begin(held, *rest)
        if next(looped):
            setattr(held, name, OTHERWISE[name])

    with monkeypatch.context() as patch:
        patch.setattr(bullet, "begin_contact", otherwise)
        assert not bullet.loop_agrees()
    assert run("pybullet", ROCKS).driver == "python: its loop does not step as Python does"


@pytest.mark.parametrize("phase", ContactPhase)
def test_both_drivers_correct_alike_whatever_a_step_is_for(phase, monkeypatch):
    monkeypatch.setattr(bullet, "TRIAL", [step._replace(phase=phase) for step in bullet.TRIAL])
    assert bullet.loop_agrees()
    bullet.loop_agrees.cache_clear()
    monkeypatch.setattr(
        bullet, "corrected", lambda *_: (0.0, 0.0) if phase < ContactPhase.APPROACH else (1.0, 1.0)
    )
    assert not bullet.loop_agrees()  # what is corrected is seen in the trial


@pytest.mark.parametrize(
    ("phase", "dt_s", "normal", "across"),
    [
        (ContactPhase.SWING, 1e-3, 1.0, 1.0),
        (ContactPhase.SWING, 2e-3, 1.0, 1.0),  # no more than there is
        (ContactPhase.SWING, 5e-4, 0.25, 0.25),
        (ContactPhase.REST, 5e-4, 0.25, 0.0),
        (ContactPhase.APPROACH, 1e-3, 0.0, 0.0),
        (ContactPhase.STRIKE, 1e-3, 0.0, 0.0),
    ],
)
def test_what_is_corrected_of_a_position(phase, dt_s, normal, across):
    assert bullet_loop.corrected(phase, dt_s, 1e-3) == (normal, across)


def apart(number):
    """Return a scene in which contacts are kept up to a gap of its own."""
    block = RigidBlock(width=0.2 + 0.1 * number, height=1.5)
    return scene(pulse(1.3, 3.0, 1, block), system=block, accuracy="loose")


def answer(number):
    return all_but_times(run("pybullet", apart(number)))


@pytest.mark.parametrize("compiled", [True, False])
def test_worlds_at_once_keep_their_own_gaps(compiled):
    """The library holds that up to which contacts are kept for the whole process, and looks at it
    when two bodies meet first: on a plane, while a scene is built."""
    engine, alone, asked = ENGINES["pybullet"], answer(1), replace(apart(1), compiled=compiled)
    world, other = build(engine, asked), build(engine, replace(asked, preset="naive"))
    dt_s, resolution = engine.best.ordinary_step_s(asked), engine.resolution(asked.system)
    response = simulate_world(world, asked, dt_s, resolution=resolution)
    world.close()
    other.close()
    assert all_but_times(response) == alone


def test_threads_do_not_disturb_each_other():
    alone = [answer(number) for number in range(6)]
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(answer, 4 * list(range(6)))) == 4 * alone


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_answer_alike(method):
    here = answer(1)
    with ProcessPoolExecutor(1, multiprocessing.get_context(method)) as pool:
        assert pool.submit(answer, 1).result() == here


def test_a_signal_ends_a_loop():
    def stop(number, frame):
        raise InterruptedError

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(InterruptedError):
            rocked("pybullet", pulse(0.5, 1.0), preset="fixed", duration=1e5)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert driven(ROCKS)


@pytest.mark.parametrize("compiled", [True, False])
def test_the_solver_ends_by_itself_at_rest(compiled):
    """More iterations change nothing: places that contradict each other would use them all up."""
    block = RigidBlock(width=0.5, height=1.0)
    motion = pulse(1.3, 0.1, 2, block)
    times = [0.1 * i for i in range(20)]  # the block lifts after 2.5 s
    asked = {"system": block, "times": times, "compiled": compiled}
    enough, more = (
        rocked("pybullet", motion, **asked, settings={"iterations": iterations})
        for iterations in (1000, 3000)
    )
    assert (enough.history.theta == more.history.theta).all()


@pytest.mark.parametrize("wanted", [{"start": (0.5 * BLOCK.alpha, 0.0), "preset": "naive"}, {}])
def test_nothing_stays_of_any_setting(wanted, monkeypatch):
    """A run in a client that others have used is that of a new one, to the bit."""
    monkeypatch.setattr(bullet_clients, "idle", [])

    def answered():
        return all_but_times(rocked("pybullet", pulse(1.35, 4.0), **wanted))

    first = answered()
    for level in itertools.chain.from_iterable(factor.levels for factor in FACTORS):
        for preset in level.presets:
            few = {"preset": preset, "settings": level.settings, "max_steps": 30}
            rocked("pybullet", pulse(1.35, 4.0), **few, **level.scene)
        assert len(bullet_clients.idle) == 1
        assert answered() == first, level.name
