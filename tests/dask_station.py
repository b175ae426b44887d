"""A Dask scheduler and workers of the tests' own, each a process."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

from distributed import Client

HERE = Path(__file__).parent
KNOWN = os.pathsep.join(map(str, (HERE, HERE / "plugin", HERE.parent)))
DASK = [sys.executable, "-m", "dask"]
PATIENCE_S = 120.0


@contextmanager
def scheduler(folder):
    """Start a scheduler; yield its address."""
    place = folder / "scheduler.json"
    options = ["--port", "0", "--no-dashboard", "--scheduler-file", str(place)]
    with started("scheduler", *options):
        while not (place.exists() and place.read_text().endswith("}")):
            time.sleep(0.05)
        yield json.loads(place.read_text())["address"]


@contextmanager
def working(address, nanny="--no-nanny", **environment):
    """Start a worker; yield its process."""
    with started(
        "worker", address, nanny, "--nthreads", "1", "--no-dashboard", **environment
    ) as it:
        yield it


@contextmanager
def started(*words, **environment):
    """Start a process of Dask, and end it afterwards."""
    known = {**os.environ, "PYTHONPATH": KNOWN, **environment}
    process = subprocess.Popen([*DASK, *words], env=known, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def wait_for_workers(address, count):
    """Wait until a scheduler has so many workers."""
    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=PATIENCE_S)
