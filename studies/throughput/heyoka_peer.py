"""The exact model by heyoka.py, an adaptive Taylor integrator with events, as a peer.

The uplift, the rest and the decision after the pulse are the reference's; steps, error control and
events are heyoka's own, at its default tolerance, double precision.
"""

import math
from typing import Any

import heyoka
import numpy as np

from analytic.kernels.rest import comes_to_rest, time_to_rest
from analytic.maps import decide, next_lift
from analytic.models import MODELS
from studies.cases.window import Window

MOST_IMPACTS = 10_000


class HeyokaSolver:
    """Compiled once for all cases: the slenderness and the pulse are parameters."""

    def __init__(self) -> None:
        y, v = heyoka.make_vars("y", "v")
        alpha, force, omega = heyoka.par[0], heyoka.par[1], heyoka.par[2]
        ground = force * heyoka.sin(omega * heyoka.time)
        rate = -(heyoka.sin(alpha - y) + ground * heyoka.cos(alpha - y))
        falling = heyoka.event_direction.negative
        rising = heyoka.event_direction.positive
        self.integrator: Any = heyoka.taylor_adaptive(
            [(y, v), (v, rate)],
            [0.0, 0.0],
            pars=[0.1, 1.0, 1.0],
            t_events=[
                heyoka.t_event(y, direction=falling),
                heyoka.t_event(y - 0.5 * math.pi, direction=rising),
            ],
        )

    def __call__(self, window: Window, x: float, onsets: float) -> bool:
        """Say whether the block of a point of the map overturns."""
        alpha = float(window.alpha(np.array(x)))
        omega = float(window.ratio(np.array(x)))
        block, _ = window.case(x, onsets)
        law = MODELS["exact"].law(alpha, block.restitution)
        amplitude, end = onsets * law.onset, window.half_cycles * math.pi
        if amplitude <= law.onset:
            return False
        level, phase, v, side = math.asin(law.onset / amplitude), 0.0, 0.0, 0.0
        step = self.integrator
        for impacts in range(MOST_IMPACTS):
            if side == 0.0:
                phase = next_lift(phase, level, end)
                if phase == math.inf:
                    return False
                side = 1.0 if math.floor(phase / math.pi) % 2 else -1.0
            step.time, step.state[:], step.pars[:] = (
                phase / omega,
                (0.0, v),
                (alpha, side * amplitude, omega),
            )
            step.reset_cooldowns()
            outcome = step.propagate_until(end / omega)[0]
            if outcome == heyoka.taylor_outcome.time_limit:
                return bool(decide(law, step.state[0], step.state[1], impacts)[0] >= 0)
            if int(outcome) != -1:
                return True
            phase, side, v = step.time * omega, -side, -law.eta * step.state[1]
            a = amplitude * math.sin(phase)
            wait = time_to_rest(law, side, v, a)
            rested = phase + omega * wait
            later = amplitude * math.sin(rested) if rested < end else 0.0
            if comes_to_rest(law, side, a, later, wait):
                phase, side, v = rested, 0.0, 0.0
        raise RuntimeError(f"more than {MOST_IMPACTS} impacts")
