"""How long a user waits: `python tests/benchmark.py`, some three minutes on a quiet machine.

Each command runs in a process of its own, the first time with no kernel compiled and no bytecode
kept. R, the time to import numba and pandas, is measured in the same run: machines differ, ratios
less.
"""

import os
import subprocess
import sys
import tempfile
import time

CASE = "--width 0.5 --height 1.5 --amplitude 0.4 --omega 6.2832 --jobs 1"
WAITS = {
    "help of a command": "sweep --help",
    "three models": f"compare {CASE} --sources exact housner modified",
    "five sources": f"compare {CASE} --sources exact housner modified pybullet mujoco",
    "figure 6, three models": "sweep OUT --figure 6 --sources exact housner modified",
    "the paper's sweep": "sweep OUT",
}


def seconds(words, known):
    """Return how long Python takes for some words, where it keeps what it compiles in a folder."""
    began = time.perf_counter()
    subprocess.run([sys.executable, *words], env=known, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def main():
    """Print the seconds of each command, the first time and in the median of three later ones."""
    for name, command in WAITS.items():
        with tempfile.TemporaryDirectory() as folder:
            known = os.environ | {"NUMBA_CACHE_DIR": folder, "PYTHONPYCACHEPREFIX": folder}
            unit = sorted(seconds(["-c", "import numba, pandas"], known) for _ in range(4))[1]
            waits = []
            for run in range(4):
                words = command.replace("OUT", f"--out {folder}/{run}").split()
                waits.append(seconds(["-m", "studies", *words], known))
            first, later = waits[0], sorted(waits[1:])[1]
            print(f"{name}: {first:.2f} s the first time, then {later:.2f} s, {later / unit:.2g} R")


if __name__ == "__main__":
    main()
