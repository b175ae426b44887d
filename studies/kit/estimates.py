"""What a command would take, told before it begins: what is too much is refused with the figure."""

import contextlib
import os
from pathlib import Path

from studies.kit.arguments import BadInputError

DAY_S = 86_400.0
"""What takes longer is begun only with --yes."""

CASE_S = {"model": 1e-3, "solver": 5e-3, "peer": 0.05, "engine": 0.1}
"""About what a case takes a source of each kind, its row in the table included [s]."""

CASE_BYTES = 4e3
"""About what a case and its row hold of memory."""

PROCESS_BYTES = 2e8
"""About what a process with an engine and the compiled kernels holds."""

CONTAINER = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Where Linux says how much memory a container may use."""


def refuse_days(asked: str, seconds: float, yes: bool) -> None:
    """Raise BadInputError if what was asked for takes longer than a day, unless that is wanted."""
    if seconds > DAY_S and not yes:
        days = f"{seconds / DAY_S:.0f} days"
        raise BadInputError(f"{asked}; that takes about {days}, and more than one needs --yes")


def refuse_excess(asked: str, held: float) -> None:
    """Raise BadInputError if what was asked for needs more memory [byte] than there is."""
    if held > (there := memory()):
        needs = f"that needs about {held / 1e9:.0f} GB of memory"
        raise BadInputError(f"{asked}; {needs}, and at most {there / 1e9:.0f} GB are there")


def memory() -> float:
    """Return the memory of this machine, or what its container may use of it [byte]."""
    limits = [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")]
    for name in CONTAINER:
        # a container without a limit says "max"
        with contextlib.suppress(OSError, ValueError):
            limits.append(int(Path(name).read_text()))
    return float(min(limits))
