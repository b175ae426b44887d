"""Batches of the small engine beside this module: its worlds one after another, and traps."""

import os
import time
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

import numpy as np
from rocking_moreau import ENGINE as MOREAU
from rocking_moreau import MoreauWorld

from engines.declaration import BatchEngine
from engines.run.batch import alone
from engines.world import Step

NOTE = "BATCH_NOTE"
"""Environment variable: a file in which each batch writes down its process and its size."""
GATE = "BATCH_GATE"
"""Environment variable: a file for which all batches but the first wait."""
SPOILT, RAISING, CRASHING, SLOW, HANGING = 3001.0, 3002.0, 3003.0, 3004.0, 3005.0
"""Densities [kg/m3] of blocks that become nan, that raise or end the process in a batch, that take
`PAUSE_S`, or for ever."""
PAUSE_S = 0.4


class Looped:
    moment, driver = MoreauWorld.moment, "one after another"

    def __init__(self, scenes, settings, dt_s):
        self._worlds = [
            MoreauWorld(scene, settings, its_s) for scene, its_s in zip(scenes, dt_s, strict=True)
        ]
        self._densities = [scene.density for scene in scenes]
        time.sleep(PAUSE_S * self._densities.count(SLOW))
        with Path(os.environ.get(NOTE, os.devnull)).open("a") as file:
            file.write(f"{os.getpid()} {len(scenes)}\n")
        gate = os.environ.get(GATE)
        while gate and len(Path(os.environ[NOTE]).read_text().splitlines()) > 1:
            if Path(gate).exists():
                break
            time.sleep(0.01)

    def advance(self, steps, going):
        if RAISING in self._densities and len(self._worlds) > 1:
            raise RuntimeError("no batch\ntoday")
        if CRASHING in self._densities and len(self._worlds) > 1:
            os.abort()
        while HANGING in self._densities:
            time.sleep(1.0)
        states = np.full((*steps.dt_s.shape, 1, 4), 7.0)  # what is not looked at may be anything
        for number in np.nonzero(going)[0]:
            for k in range(steps.dt_s.shape[1]):
                self._worlds[number].step(Step(*(float(part[number, k]) for part in steps)))
                states[number, k] = self._worlds[number].state()
            if self._densities[number] == SPOILT:
                states[number] = np.nan
        return states

    def fault(self, world):
        return ""

    def close(self):
        pass


DECLARED = {item.name: getattr(MOREAU, item.name) for item in fields(MOREAU)}
ENGINE = BatchEngine(
    **{**DECLARED, "name": "looped", "build": partial(alone, Looped)},
    batch=Looped,
    most_worlds=5,
)

BRISK = replace(
    ENGINE,
    presets=tuple(replace(each, step=each.step and 40 * each.step) for each in ENGINE.presets),
)
"""The same in fewer steps, where how often it is asked matters and not how well it answers."""
