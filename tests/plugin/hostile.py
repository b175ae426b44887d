"""Worlds of an engine from outside that does what no engine should, one in each class."""

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

from engines.declaration import Stepping
from engines.world import Moment

NOTE = "HOSTILE_NOTE"
"""Environment variable: a file in which worlds write down the processes that they have started."""


class Calm:
    """A block that never moves."""

    moment, stepping = Moment.END, Stepping.LANDING

    def __init__(self, scene, settings, dt_s):
        self.at = scene.bodies[0].at

    def step(self, step):
        pass

    def state(self):
        return [(self.at.x, self.at.z, 0.0, 0.0)]

    def fault(self):
        return ""

    def close(self):
        pass


def note(process):
    with Path(os.environ[NOTE]).open("a") as file:
        file.write(f"{process}\n")


class Exits(Calm):
    def step(self, step):
        sys.exit()


class ExitsAtOnce(Calm):
    def step(self, step):
        os._exit(0)


class Own(BaseException):
    pass


class RaisesOfItsOwn(Calm):
    def step(self, step):
        raise Own("nobody\ncatches me")


class MuteError(Exception):
    def __str__(self):
        sys.exit()


class RaisesNothingThatPrints(Calm):
    def step(self, step):
        raise MuteError


class Interrupts(Calm):
    def step(self, step):
        raise KeyboardInterrupt


class Aborts(Calm):
    def step(self, step):
        os.abort()


class Crashes(Calm):
    def step(self, step):
        ctypes.string_at(0)


class Loops(Calm):
    """For ever, with a signal handler and children of its own."""

    def step(self, step):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        note(os.getpid())
        note(subprocess.Popen(["sleep", "1000"]).pid)
        note(subprocess.Popen(["sleep", "1000"], start_new_session=True, env={}).pid)
        while True:
            pass


class LeavesAChild(Calm):
    """A daemon, as they are made: it leaves its parent and its session, and ignores signals."""

    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
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


class Forks(Calm):
    """Both return."""

    def close(self):
        os.fork()


class StartsAProcess(Calm):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        process = multiprocessing.get_context("fork").Process(target=time.sleep, args=(1000.0,))
        process.start()
        note(process.pid)


class StartsAThread(Calm):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        threading.Thread(target=threading.Event().wait).start()


class Talks(Calm):
    """Without end, in its own words and its children's."""

    def step(self, step):
        while True:
            print("again and again")
            print("and again", file=sys.stderr)
            os.write(1, b"and again\n")
            subprocess.run(["echo", "and again"])


class Fills(Calm):
    def step(self, step):
        self.held = bytearray(10**10)


class GoesBack(Calm):
    """In time: by steps of its own of which there are fewer than none."""

    stepping = Stepping.OWN

    def advance(self, end_s):
        return -1


class IsNowhere(Calm):
    def state(self):
        return [(np.nan, np.nan, np.nan, np.nan)]


class IsShort(Calm):
    def state(self):
        return np.zeros(3)


class IsMany(Calm):
    def state(self):
        return np.zeros((4, 4))


class TellsNoWords(Calm):
    def fault(self):
        return b"\xff" * 10_000


class CannotGo(Calm):
    """Its garbage cannot be collected."""

    def __del__(self):
        raise Own


class Closes(Calm):
    """The streams, and what descriptors there may be."""

    def step(self, step):
        sys.stdout.close()
        sys.stderr.close()
        os.closerange(0, 1000)


class Moves(Calm):
    def step(self, step):
        os.chdir("/")


class StopsTheClock(Calm):
    def step(self, step):
        for name in ("time", "monotonic", "perf_counter", "sleep"):
            setattr(time, name, lambda *_: "noon")


class TurnsTheClockBack(Calm):
    def step(self, step):
        time.perf_counter = lambda: -1e6
