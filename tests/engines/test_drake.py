"""Drake: how near it comes, by steps of its own too, and the traps that it sets without a word."""

from typing import Any

import numpy as np
import pytest
from test_landing import errors_of_sweep
from uses import BLOCK, HERE, pulse, scene

from analytic import simulate
from analytic.response import Outcome, Response
from engines import run
from engines.drive import build

pytestmark = pytest.mark.skipif("drake" not in HERE, reason="pydrake is not installed")

MOTION = pulse(1.3, 3.0, 2)


def rocked(preset: str = "fixed", **settings: Any) -> Response:
    return run("drake", scene(MOTION, preset=preset, settings=settings))


def error(preset: str = "fixed", **settings: Any) -> float:
    return abs(rocked(preset, **settings).peak_ratio / simulate(BLOCK, MOTION).peak_ratio - 1.0)
