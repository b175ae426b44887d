"""How long a user waits for an answer: whole commands, in processes of their own.

Cold is where nothing was compiled before, warm is later. Ratios to R, the time in which Python
loads numba and pandas, hold on any machine.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import pandas as pd

from analytic.block import GRAVITY
from analytic.synthetic import kanai_tajimi

LOADING = ("-c", "import numba, pandas")
"""What R is the time of."""

ONE = "compare --width 0.5 --height 1.5 --pulse full-sine --amplitude 0.4 --omega 6.2832 --sources"
ASKED = {
    "rocking --help": "--help",
    "rocking compare --help": "compare --help",
    "rocking compare, three models": f"{ONE} exact housner modified",
    "rocking compare, five sources": f"{ONE} exact housner modified pybullet mujoco",
    "rocking blocks, forty under a record": "blocks blocks.csv --record shaking.AT2 --out results",
}
AT_LENGTH = {
    "rocking sweep, three models": "sweep --sources exact housner modified --out results",
    "rocking sweep": "sweep --out results",
}
"""Arguments by what they are called; those of the second are not asked quickly."""

BLOCKS = "\n".join(
    ["name,width,height", *(f"N{n},{0.3 + 0.02 * n:.2f},{1.6 + 0.03 * n:.2f}" for n in range(40))]
)
"""What `rocking blocks` is asked about."""

AS_INSTALLED = {"PYTHONDONTWRITEBYTECODE": ""}
"""A user's Python keeps the modules that it has compiled, whatever the one here does."""

REPEATS = 5
"""Of what is warm, of which the median counts."""


def start_table(quick: bool) -> pd.DataFrame:
    """Return the times of whole commands, a row each: cold and warm [s], and both over R."""
    unit = median(_spent(LOADING, {}) for _ in range(REPEATS))
    lines = []
    for name, arguments in {**ASKED, **({} if quick else AT_LENGTH)}.items():
        command = ("-m", "studies", *arguments.split())
        with TemporaryDirectory() as kept:
            cold, *later = (
                _spent(command, {"NUMBA_CACHE_DIR": kept})
                for _ in range(1 + (1 if name in AT_LENGTH else REPEATS))
            )
        warm = median(later)
        lines.append(
            {
                "command": name,
                "cold_s": cold,
                "warm_s": warm,
                "unit_s": unit,
                "cold_ratio": cold / unit,
                "warm_ratio": warm / unit,
            }
        )
    return pd.DataFrame(lines)


def _shaking() -> str:
    """Return an artificial record of 40 s as PEER's files hold one."""
    record = kanai_tajimi(1, peak=4.0, duration=40.0, omega=12.0, rise=5.0, fall=15.0)
    head = f"PEER\nA\nACCELERATION IN UNITS OF G\nNPTS= {len(record.samples)}, DT= {record.dt} SEC"
    return f"{head}\n{' '.join(repr(float(a)) for a in record.samples / GRAVITY)}\n"


def _spent(arguments: tuple[str, ...], variables: dict[str, str]) -> float:
    """Return how long a process of Python takes [s], in a folder of its own.

    Raises
    ------
    OSError
        If it fails; with what it said last.
    """
    # what is imported here is there, too, wherever it was found
    places = os.pathsep.join(str(Path(place).resolve()) for place in sys.path if place)
    with TemporaryDirectory() as folder:
        Path(folder, "blocks.csv").write_text(BLOCKS)
        Path(folder, "shaking.AT2").write_text(_shaking())
        began = time.perf_counter()
        done = subprocess.run(
            [sys.executable, *arguments],
            env={**os.environ, "PYTHONPATH": places, **AS_INSTALLED, **variables},
            cwd=folder,
            capture_output=True,
            text=True,
        )
        spent = time.perf_counter() - began
    if done.returncode:
        raise OSError(f"{' '.join(arguments)}: {done.stderr.strip().splitlines()[-1:]}")
    return spent
