"""The exact model by heyoka.py, an adaptive Taylor integrator with events, as a peer.

The uplift, the rest and the decision after the pulse are the reference's; steps, error control and
events are heyoka's own, at its default tolerance, double precision.
"""

import math
from typing import Any

import heyoka
import numpy as np

from analytic.kernels.rest import side_after, time_to_rest
from analytic.kernels.swings import Pulse, parity, whole_half_cycles
from analytic.maps import decide, ground_after, later, next_lift
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
        pulse = Pulse(onsets * law.onset, omega, window.half_cycles)
        if pulse.amplitude <= law.onset:
            return False
        level, angle, v, side = math.asin(law.onset / pulse.amplitude), 0.0, 0.0, 0.0
        step = self.integrator
        for impacts in range(MOST_IMPACTS):
            if side == 0.0:
                turned, angle = next_lift(angle, level)
                pulse, side = later(pulse, turned), -1.0
            if pulse.half_cycles <= 0:
                return bool(decide(law, 0.0, v, impacts)[0] >= 0)
            step.time, step.state[:], step.pars[:] = (
                angle / omega,
                (0.0, v),
                (alpha, side * pulse.amplitude, omega),
            )
            step.reset_cooldowns()
            outcome = step.propagate_until(pulse.half_cycles * math.pi / omega)[0]
            if outcome == heyoka.taylor_outcome.time_limit:
                return bool(decide(law, step.state[0], step.state[1], impacts)[0] >= 0)
            if int(outcome) != -1:
                return True
            turned, angle = whole_half_cycles(step.time * omega)
            pulse = later(pulse, turned)
            side, v = -side * parity(turned), -law.eta * step.state[1]
            a = ground_after(pulse, angle, 0.0)
            wait = time_to_rest(law, side, v, a)
            if side_after(law, side, v, a, ground_after(pulse, angle, wait), wait) == 0.0:
                turned, angle = whole_half_cycles(angle + omega * wait)
                pulse, side, v = later(pulse, turned), 0.0, 0.0
            elif v == 0.0:
                side = 0.0
        raise RuntimeError(f"more than {MOST_IMPACTS} impacts")
