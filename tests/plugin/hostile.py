"""Worlds of an engine from outside that does what no engine should, a kind each."""

import ctypes
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
from given import Bare

from engines.declaration import Stepping

NOTE = "HOSTILE_NOTE"
"""Environment variable: a file in which worlds write down the processes that they have started."""


class Calm(Bare):
    """A block that never moves."""

    stepping = Stepping.LANDING

    def __init__(self, scene, settings, dt_s):
        self.at = scene.bodies[0].at

    def state(self):
        return [(self.at.x, self.at.z, 0.0, 0.0)]


class Own(BaseException):
    pass


class MuteError(Exception):
    def __str__(self):
        sys.exit()


def note(process):
    with Path(os.environ[NOTE]).open("a") as file:
        file.write(f"{process}\n")


def throw(error):
    raise error


def loop():
    """Go on for ever, with a signal handler and children of its own."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    note(os.getpid())
    note(subprocess.Popen(["sleep", "1000"]).pid)
    note(subprocess.Popen(["sleep", "1000"], start_new_session=True, env={}).pid)
    while True:
        pass


def leave_a_child():
    """End, but for a daemon as they are made: it leaves its session, and ignores signals."""
    there, done = os.pipe()
    if not os.fork():
        os.setsid()
        if not os.fork():
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
            note(os.getpid())
            os.write(done, b".")
            time.sleep(1000.0)
        os._exit(0)
    os.wait()
    os.read(there, 1)  # it is noted, and will not be ended before
    os._exit(5)


def start_a_process():
    process = multiprocessing.get_context("fork").Process(target=time.sleep, args=(1000.0,))
    process.start()
    note(process.pid)


def start_a_thread():
    threading.Thread(target=threading.Event().wait).start()


def talk():
    """Talk without end, in its own words and its children's."""
    while True:
        print("again and again")
        print("and again", file=sys.stderr)
        os.write(1, b"and again\n")
        subprocess.run(["echo", "and again"])


def close_all():
    """Close the streams, and what descriptors there may be."""
    sys.stdout.close()
    sys.stderr.close()
    os.closerange(0, 1000)


def stop_the_clock():
    for name in ("time", "monotonic", "perf_counter", "sleep"):
        setattr(time, name, lambda *_: "noon")


def then(act):
    """Return what builds a calm world, and then does something."""

    def begin(world, scene, settings, dt_s):
        Calm.__init__(world, scene, settings, dt_s)
        act()

    return begin


BY_ITSELF, SIGNAL = "the process ended by itself with exit code", "the process was ended by signal"
LATE = "no result within the time limit of 3 s"
IN_A_STEP = {
    "Exits": (sys.exit, "SystemExit"),
    "ExitsAtOnce": (lambda: os._exit(0), f"{BY_ITSELF} 0"),
    "RaisesOfItsOwn": (lambda: throw(Own("nobody\ncatches me")), "Own: nobody catches me"),
    "RaisesNothingThatPrints": (lambda: throw(MuteError), "MuteError"),
    "Interrupts": (lambda: throw(KeyboardInterrupt), "KeyboardInterrupt"),
    "Aborts": (os.abort, f"{SIGNAL} SIGABRT"),
    "Crashes": (lambda: ctypes.string_at(0), f"{SIGNAL} SIGSEGV"),
    "Loops": (loop, LATE),
    "Talks": (talk, LATE),
    "Fills": (lambda: bytearray(10**10), "MemoryError"),
    "Closes": (close_all, f"{BY_ITSELF} 1"),
    "Moves": (lambda: os.chdir("/"), ""),
    "StopsTheClock": (stop_the_clock, ""),
    "TurnsTheClockBack": (lambda: setattr(time, "perf_counter", lambda: -1e6), ""),
}
"""World -> what it does in each step, and how its row begins; empty where that is a usable one."""
SHAPE = "ValueError: the engine's state has the shape"
OTHERWISE = {
    "LeavesAChild": ("__init__", then(leave_a_child), f"{BY_ITSELF} 5"),
    "StartsAProcess": ("__init__", then(start_a_process), ""),
    "StartsAThread": ("__init__", then(start_a_thread), ""),
    "IsNowhere": ("state", lambda _: [(np.nan,) * 4], "the engine's state is not finite"),
    "IsShort": ("state", lambda _: np.zeros(3), f"{SHAPE} (3,)"),
    "IsMany": ("state", lambda _: np.zeros((4, 4)), f"{SHAPE} (4, 4)"),
    "TellsNoWords": ("fault", lambda _: b"\xff" * 10_000, r"b'\xff\xff"),
    "Forks": ("close", lambda _: os.fork(), ""),  # both return
    "CannotGo": ("__del__", lambda _: throw(Own), ""),  # its garbage cannot be collected
}
"""World -> what it has in place of a calm one's, and how its row begins."""


def world_of(name):
    """Return the class of a world."""
    if name in IN_A_STEP:
        act, _ = IN_A_STEP[name]
        return type(name, (Calm,), {"step": lambda world, step: act()})
    part, does, _ = OTHERWISE[name]
    return type(name, (Calm,), {part: does})


def __getattr__(name):
    """Return the class of a world, as an engine that stands in this module."""
    if name in IN_A_STEP or name in OTHERWISE:
        return world_of(name)
    raise AttributeError(name)
