"""The first picture: one block under one pulse, by every source that the first screen names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from analytic.block import GRAVITY, RigidBlock
from analytic.motion import SinePulse
from studies.cases.paper import free_rocking_window
from studies.old import provenance
from studies.old.jobs import Job, ask
from studies.measures.samples import samples
from studies.sources.registry import core_sources, resolve

BLOCK = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse(amplitude=0.4 * GRAVITY, omega=6.2832, half_cycles=2)
SOURCES = ("exact", "housner", *core_sources("naive"), *core_sources())
SAMPLES = 401
COLUMNS = ["source", "outcome", "peak_ratio", "time_s", "theta_ratio"]
DIGITS = {"time_s": 9, "theta_ratio": 9}


def measure(path: Path) -> None:
    """Ask every source for its history of the case, and write one table of them."""
    window = free_rocking_window(BLOCK, PULSE)
    times = np.linspace(0.0, window, SAMPLES)
    parts = []
    for name in SOURCES:
        source = resolve(name)
        job = Job(labels={}, block=BLOCK, motion=PULSE, source=name, duration=window, times=times)
        response = ask(job, source)
        labels = {"source": name, "peak_ratio": response.peak_ratio}
        parts.append(samples(response, BLOCK, PULSE, labels)[COLUMNS].round(DIGITS))
    text = pd.concat(parts, ignore_index=True).to_csv(index=False, na_rep="nan")
    provenance.write_text(path, text)


def summary(histories: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: its outcome, its peak and the error of that."""
    lines = histories.groupby("source", sort=False)[["outcome", "peak_ratio"]].first().reset_index()
    exact = float(lines.loc[lines["source"] == "exact", "peak_ratio"].iloc[0])
    survived = lines["outcome"] == "rocked"
    return lines.assign(error=(lines["peak_ratio"] / exact - 1.0).where(survived))
