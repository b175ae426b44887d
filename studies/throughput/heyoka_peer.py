"""The exact model by heyoka.py, an adaptive Taylor integrator with events, as a peer.

The uplift, the rest and the decision after the pulse are the reference's; steps, error control and
events are heyoka's own, at its default tolerance, double precision. Its batch mode takes a step of
as many cases at once as the processor's registers hold, and stops when one of them lands.
"""

import math
import time
from collections.abc import Iterable, Iterator
from typing import Any

import heyoka
import numpy as np

from analytic.kernels.rest import side_after, time_to_rest
from analytic.kernels.swings import Pulse, parity, whole_half_cycles
from analytic.maps import decide, ground_after, later, next_lift
from analytic.models import MODELS
from analytic.motion import FloatArray
from studies.cases.window import Window

MOST_IMPACTS = 10_000
FIRST_EVENT = -1
"""How heyoka calls an outcome that is its first event, here an impact."""


class Flight:
    """A case from one stop of an integrator to the next.

    Parameters
    ----------
    window : Window
    x, onsets : float
        A point of the map.

    Attributes
    ----------
    overturned : bool or None
        Whether the block has; None while that is not decided.
    """

    def __init__(self, window: Window, x: float, onsets: float) -> None:
        alpha = float(window.alpha(np.array(x)))
        self.omega = float(window.ratio(np.array(x)))
        self.law = MODELS["exact"].law(alpha, window.case(x, onsets)[0].restitution)
        self.pulse = Pulse(onsets * self.law.onset, self.omega, window.half_cycles)
        self.angle = self.v = self.side = 0.0
        self.impacts = 0
        self.overturned: bool | None = None
        if self.pulse.amplitude <= self.law.onset:
            self.overturned = False
        else:
            self._level = math.asin(self.law.onset / self.pulse.amplitude)
            self._set_out()

    @property
    def span(self) -> tuple[float, float]:
        """Time [1/p] at which the integrator is to go on, and at which the pulse ends."""
        return self.angle / self.omega, self.pulse.half_cycles * math.pi / self.omega

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Slenderness, signed amplitude of the present half cycle [g] and omega/p."""
        return self.law.alpha, self.side * self.pulse.amplitude, self.omega

    def stopped(self, outcome: Any, at: float, y: float, v: float) -> None:
        """Go on from where the integrator stopped: at a time, a rotation and a velocity."""
        if outcome == heyoka.taylor_outcome.time_limit:
            self._decide(y, v)
        elif int(outcome) != FIRST_EVENT:
            self.overturned = True
        else:
            self._land(at, v)

    def _set_out(self) -> None:
        if self.side == 0.0:
            turned, self.angle = next_lift(self.angle, self._level)
            self.pulse, self.side = later(self.pulse, turned), -1.0
        if self.pulse.half_cycles <= 0:
            self._decide(0.0, self.v)

    def _decide(self, y: float, v: float) -> None:
        self.overturned = bool(decide(self.law, y, v, self.impacts)[0] >= 0)

    def _land(self, at: float, v: float) -> None:
        self.impacts += 1
        if self.impacts > MOST_IMPACTS:
            raise RuntimeError(f"more than {MOST_IMPACTS} impacts")
        law = self.law
        turned, angle = whole_half_cycles(at * self.omega)
        pulse = later(self.pulse, turned)
        side, v = -self.side * parity(turned), -law.eta * v
        a = ground_after(pulse, angle, 0.0)
        wait = time_to_rest(law, side, v, a)
        if side_after(law, side, v, a, ground_after(pulse, angle, wait), wait) == 0.0:
            turned, angle = whole_half_cycles(angle + self.omega * wait)
            pulse, side, v = later(pulse, turned), 0.0, 0.0
        elif v == 0.0:
            side = 0.0
        self.pulse, self.angle, self.side, self.v = pulse, angle, side, v
        self._set_out()


def equations() -> list[tuple[Any, Any]]:
    """Return the exact model with the slenderness and the pulse as parameters."""
    y, v = heyoka.make_vars("y", "v")
    alpha, force, omega = heyoka.par[0], heyoka.par[1], heyoka.par[2]
    ground = force * heyoka.sin(omega * heyoka.time)
    return [(y, v), (v, -(heyoka.sin(alpha - y) + ground * heyoka.cos(alpha - y)))]


def events(kind: Any) -> list[Any]:
    """Return impact and overturning as events of a kind, of one case or of a batch."""
    y = heyoka.make_vars("y")
    directions = heyoka.event_direction
    return [
        kind(y, direction=directions.negative),
        kind(y - 0.5 * math.pi, direction=directions.positive),
    ]


class HeyokaSolver:
    """One case after the other; compiled once for all."""

    def __init__(self) -> None:
        self.integrator: Any = heyoka.taylor_adaptive(
            equations(), [0.0, 0.0], pars=[0.1, 1.0, 1.0], t_events=events(heyoka.t_event)
        )

    def __call__(self, window: Window, x: FloatArray, onsets: FloatArray) -> list[bool]:
        """Say of each point of the map whether the block overturns."""
        points = zip(x.tolist(), onsets.tolist(), strict=True)
        return [self._overturns(Flight(window, *point)) for point in points]

    def _overturns(self, flight: Flight) -> bool:
        step = self.integrator
        while flight.overturned is None:
            step.time, end = flight.span
            step.state[:], step.pars[:] = (0.0, flight.v), flight.parameters
            step.reset_cooldowns()
            outcome = step.propagate_until(end)[0]
            flight.stopped(outcome, step.time, *step.state)
        return flight.overturned


class HeyokaBatch:
    """As many cases at once as the registers hold, each replaced by another when it is decided.

    Attributes
    ----------
    lanes : int
        Cases at once.
    integrating_s : float
        Time [s] spent within heyoka alone, without what is done in Python at each stop.
    """

    def __init__(self) -> None:
        self.lanes = int(heyoka.recommended_simd_size())
        self.integrating_s = 0.0
        self.integrator: Any = heyoka.taylor_adaptive_batch(
            equations(),
            np.zeros((2, self.lanes)),
            pars=np.ones((3, self.lanes)),
            t_events=events(heyoka.t_event_batch),
        )

    def __call__(self, window: Window, x: FloatArray, onsets: FloatArray) -> list[bool]:
        """Say of each point of the map whether the block overturns."""
        flights = [
            Flight(window, *point) for point in zip(x.tolist(), onsets.tolist(), strict=True)
        ]
        # those whose pulses end together leave together
        self._carry(sorted(flights, key=lambda flight: flight.omega))
        return [bool(flight.overturned) for flight in flights]

    def _carry(self, flights: Iterable[Flight]) -> None:
        step = self.integrator
        waiting = (flight for flight in flights if flight.overturned is None)
        lanes = [next(waiting, None) for _ in range(self.lanes)]
        times, ends = np.zeros(self.lanes), np.zeros(self.lanes)
        changed: Iterable[int] = range(self.lanes)
        while any(lanes):
            for lane in changed:
                self._load(lane, lanes[lane], times, ends)
            step.set_time(times)
            began = time.perf_counter()
            step.propagate_until(ends)
            self.integrating_s += time.perf_counter() - began
            times = step.time.copy()
            changed = list(self._stops(lanes, times))
            for lane in changed:
                flight = lanes[lane]
                if flight is not None and flight.overturned is not None:
                    lanes[lane] = next(waiting, None)

    def _load(self, lane: int, flight: Flight | None, times: FloatArray, ends: FloatArray) -> None:
        if flight is None:
            ends[lane] = times[lane]  # nothing is left to do here
            return
        times[lane], ends[lane] = flight.span
        self.integrator.state[:, lane] = 0.0, flight.v
        self.integrator.pars[:, lane] = flight.parameters
        self.integrator.reset_cooldowns(lane)

    def _stops(self, lanes: list[Flight | None], times: FloatArray) -> Iterator[int]:
        """Yield the lanes that have stopped, which know then what became of them."""
        for lane, result in enumerate(self.integrator.propagate_res):
            flight, outcome = lanes[lane], result[0]
            if flight is not None and outcome != heyoka.taylor_outcome.success:
                flight.stopped(outcome, times[lane], *self.integrator.state[:, lane])
                yield lane
