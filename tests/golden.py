"""Rows to reproduce to the bit: `golden.py [NAME ...]` prints what differs, `write` makes them."""

import hashlib
import sys

import numpy as np
import pandas as pd

from analytic import Delayed, Record, RigidBlock, RockingFrame, SinePulse, SlidingBlock, Still
from engines import ENGINES, installed_engines
from studies import respond

TABLE = __file__.removesuffix("py") + "csv"
COLUMNS = ["source", "case", "outcome", "peak_ratio", "steps", "events"]
PEERS = ("rk45", "dop853", "radau", "lsoda")
OTHERS = ("exact", "housner", "modified", "onset-matched", "rk4", "average-acceleration", *PEERS)
PRESETS = ("default", "default-at-rest", "recommended", "tuned", "landing", "error-controlled")
NAMES = ("pybullet", "mujoco", "pymunk", "box2d", "dart", "rapier", "drake", "newton", "physx")
HERE = [name for name in NAMES if name in installed_engines()]


def pulse(amplitude_g, omega, half_cycles=2):
    return SinePulse(amplitude=9.81 * amplitude_g, omega=omega, half_cycles=half_cycles)


def cases():
    """Yield the name, the system, its motion and the options of each case."""
    block, full = RigidBlock(width=0.5, height=1.5), pulse(0.4, 6.2832)
    figures = [(0.5, 1, 0.05), (0.5, 1, 0.1), (1.0, 2, 0.1), (1.0, 2, 0.125)] * 3
    for number, (width, cycles, excess) in enumerate(figures):
        one = RigidBlock(width=width, height=(aspect := 2 + number // 4) * width)
        shaken = pulse(1 / aspect + excess, (0.4 + 0.3 * number) * one.p, cycles)
        yield f"paper {number}", one, shaken, {}
    extremes = [(0.5, 20, 1.2, 3), (0.5, 0.8, 1.5, 3), (0.5, 3, 1 + 1e-6, 3), (0.5, 3, 10.0, 100)]
    for width, aspect, onsets, ratio in (*extremes, (0.01 / 3, 3, 1.2, 3)):
        one = RigidBlock(width=width, height=width * aspect)
        yield f"extreme {one.height:.4g} {ratio}", one, pulse(onsets / aspect, ratio * one.p), {}
    yield "extreme step", block, full, {"step": block.p / 30}
    for columns, load, amplitude in ((2, 2.0, 0.4), (3, 0.5, 0.45), (2, 0.1, 0.6), (4, 4.0, 0.4)):
        frame = RockingFrame(width=0.5, height=1.5, columns=columns, load=load)
        yield f"frame {columns} {load}", frame, pulse(amplitude, 9.0), {}
    for friction in (0.1, 0.2, 0.3):
        yield f"slide {friction}", SlidingBlock(width=1.0, height=0.5, friction=friction), full, {}
    noise = np.random.default_rng(7).normal(0.0, 1.2, 400).cumsum()
    yield "record", block, Record(dt=0.01, samples=noise - noise.mean()), {}
    yield "released", block, Still(), {"start": (0.5 * block.alpha, 0.0), "duration": 1.0}
    yield "friction 0.8", block, Delayed(full, 0.2), {"friction": 0.8}


def sources(*names):
    """Return the sources of some names, which may be those of engines or "models"; else all."""
    uses = [(name, use.name) for name in HERE for use in ENGINES[name].presets]
    known = {source: {source, "models"} for source in OTHERS}
    known |= {f"{name}:{use}": {name, f"{name}:{use}"} for name, use in uses if use in PRESETS}
    return [source for source, called in known.items() if not names or called & {*names}]


def rows(*names):
    """Yield a row for each case and each source that is installed and takes the case."""
    for source in sources(*names):
        for name, system, motion, options in cases():
            if source.startswith("dart") and isinstance(system, RockingFrame):
                continue  # they depend on where in memory its bodies are
            if (source, name) == ("pybullet:landing", "frame 4 4.0"):
                continue  # it takes five minutes
            try:
                it = respond(source, system, motion, **options)
            except ValueError:  # the source does not take the case
                continue
            seen = (it.impacts, it.uplifts, it.rests, it.slips, it.slip_m, it.sink_m, it.hop_m)
            numbers = repr([np.asarray(one, dtype=float).tolist() for one in seen])
            events = hashlib.sha256(numbers.encode()).hexdigest()[:12]
            yield source, name, it.outcome.value, repr(float(it.peak_ratio)), it.steps, events


def compared(*names):
    """Return each kept row of what is installed beside the same row of today."""
    kept = pd.read_csv(TABLE, dtype=str, keep_default_na=False).set_index(COLUMNS[:2])
    today = pd.DataFrame(rows(*names), columns=COLUMNS).astype(str).set_index(COLUMNS[:2])
    kept = kept.loc[sources(*names)]
    return pd.concat({"kept": kept, "today": today}, axis=1).fillna("no row")


if __name__ == "__main__" and sys.argv[1:] == ["write"]:
    pd.DataFrame(rows(), columns=COLUMNS).to_csv(TABLE, index=False)
elif __name__ == "__main__":
    both = compared(*sys.argv[1:])
    apart = (both["kept"] != both["today"]).any(axis=1)
    print(both[apart].to_string(), f"{(~apart).sum()} of {len(both)} rows are equal", sep="\n")
