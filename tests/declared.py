"""What an engine declares to get wrong: tests of it must fail, or the declaration is old."""

from typing import Any

import pytest

from engines import ENGINES
from engines.declaration import Miss


def held_to(miss: Miss, engine: str, preset: str) -> list[Any]:
    """Return the marks of a test of what a preset may declare to miss."""
    missed = miss in ENGINES[engine].preset(preset).misses
    return [pytest.mark.xfail(strict=True, reason=miss.value)] if missed else []
