"""General-purpose integrators on the same problem: what one would use without this project.

The equation, the uplift and the rest are the reference's; steps, error control and events are
SciPy's own.
"""

import math
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from analytic.block import RigidBlock
from analytic.kernels.excursions import BROKEN
from analytic.kernels.rest import after_impact, next_uplift
from analytic.motion import FloatArray, Motion
from analytic.response import History, Impact, Outcome, Response
from analytic.simulate import FAILURES
from analytic.start import REST, pose

MOST_EXCURSIONS = 2000


def solve_ivp_response(
    block: RigidBlock,
    motion: Motion,
    *,
    method: str,
    rtol: float = 1e-9,
    start: tuple[float, float] = REST,
    duration: float | None = None,
    times: FloatArray | None = None,
) -> Response:
    """Solve the exact model with `scipy.integrate.solve_ivp`, its events and one of its methods.

    The absolute tolerance is that of a rotation of a thousandth of alpha. The response's steps are
    evaluations of the right-hand side.
    """
    posed = pose(block, motion, "exact", start, duration, times)
    march = _March(block, method, rtol, posed, duration is None, times is not None)
    began = time.perf_counter()
    with warnings.catch_warnings(record=True) as said:
        # what an integrator has to say belongs to its row
        warnings.simplefilter("always")
        outcome = march.run()
    wall_s = time.perf_counter() - began
    if outcome is Outcome.FAILED:
        reasons = dict.fromkeys([march.message, *(str(warning.message) for warning in said)])
        message = " ".join("; ".join(reasons).split())
        return Response.failure(message, steps=march.evaluations, wall_s=wall_s)
    overturned = outcome is Outcome.OVERTURNED
    return Response(
        outcome=outcome,
        peak_ratio=math.inf if overturned else float(march.peak) / block.alpha,
        crossed=overturned or march.peak > block.alpha,
        impacts=tuple(march.impacts),
        steps=march.evaluations,
        wall_s=wall_s,
        history=march.history(),
    )


class _March:
    """One response: the rotation folded to one side, time in units of 1/p, acceleration in g."""

    def __init__(
        self, block: RigidBlock, method: str, rtol: float, posed: Any, free: bool, recorded: bool
    ) -> None:
        from scipy.integrate import solve_ivp

        self.solve_ivp: Any = solve_ivp
        self.method, self.rtol = method, rtol
        self.p, self.alpha = block.p, block.alpha
        self.law, self.start, self.segments, until, self.times = posed
        self.moving = float(self.segments[-1, 1])
        self.until = math.inf if free else until
        self.samples = np.zeros((2, self.times.size))
        self.recorded, self.end = recorded, self.until
        self.impacts: list[Impact] = []
        self.peak, self.evaluations = self.start.y, 0

    def run(self) -> Outcome:
        self.message = FAILURES[BROKEN].message
        if not np.all(np.isfinite(self.segments)):
            return Outcome.FAILED
        side, y, v = self.start
        tau, j = 0.0, int(np.searchsorted(self.segments[:, 1], 0.0, side="right"))
        started = side != 0.0
        for _ in range(MOST_EXCURSIONS + len(self.segments)):
            if side == 0.0:
                j, tau, side, _ = next_uplift(self.segments, j, tau, self.law.onset)
                if side == 0.0:
                    return Outcome.ROCKED if started or self.peak > 0.0 else Outcome.AT_REST
            path = self._stretch(j, tau, y, v, side)
            self.evaluations += path.nfev
            if path.status < 0:
                self.message = str(path.message)
                return Outcome.FAILED
            contact, turns, lying = path.y_events
            self.peak = max(self.peak, path.y[0].max(), *(float(top[0]) for top in turns))
            self._sample(path, side)
            tau, y, v = float(path.t[-1]), float(path.y[0, -1]), float(path.y[1, -1])
            over = tau >= self.moving
            if len(lying) or (over and y > self.alpha and v >= 0.0 and self.until == math.inf):
                self.end = tau
                return Outcome.OVERTURNED
            if tau >= self.until:
                return Outcome.OVERTURNED if y > self.alpha else Outcome.ROCKED
            if len(contact):
                side, v = self._strike(tau, v, side)
                y = 0.0
                if side == 0.0:
                    tau, v = tau + v, 0.0
            elif len(turns) and over and self.until == math.inf and path.status == 1:
                return Outcome.ROCKED
            while j < len(self.segments) and tau >= self.segments[j, 1]:
                j += 1
        self.message = f"more than {MOST_EXCURSIONS} excursions"
        return Outcome.FAILED

    def _stretch(self, j: int, tau: float, y: float, v: float, side: float) -> Any:
        """Integrate to the next impact, breakpoint or decision.

        Of free rocking 60/p at once decide: longer than any block that a double can hold takes to
        turn or to fall, some -ln(1e-16) = 37. The first step out of an impact is a tenth at most of
        the excursion, 2 v / y'', for an excursion shorter than that step would be stepped over.
        """
        free = j >= len(self.segments)
        end = min(self.until, tau + 60.0) if free else float(self.segments[j, 1])
        events = [_crossing(0, 0.0, -1), _crossing(1, 0.0, -1), _crossing(0, 0.5 * math.pi, 1)]
        events[1].terminal = free and self.until == math.inf  # type: ignore[attr-defined]
        fall = max(abs(self._rate(j, side)(tau, (y, v))[1]), 1e-6)
        return self.solve_ivp(
            self._rate(j, side),
            (tau, end),
            (y, v),
            method=self.method,
            rtol=self.rtol,
            atol=1e-3 * self.rtol * self.alpha,
            events=events,
            dense_output=self.recorded,
            first_step=min(0.2 * v / fall, 0.5 * (end - tau)) if y == 0.0 < v else None,
        )

    def _rate(self, j: int, side: float) -> Callable[[float, Any], tuple[float, float]]:
        sin, cos, alpha = math.sin, math.cos, self.alpha
        if j >= len(self.segments):
            return lambda t, x: (x[1], -sin(alpha - x[0]))
        start, _, amplitude, omega, phase, offset, slope = map(float, self.segments[j])

        def rate(t: float, x: Any) -> tuple[float, float]:
            a = amplitude * sin(omega * (t - start) + phase) + offset + slope * (t - start)
            z = alpha - x[0]
            return x[1], -(sin(z) + side * a * cos(z))

        return rate

    def _strike(self, tau: float, v: float, side: float) -> tuple[float, float]:
        """Return (side, velocity) after an impact, or (0, time until rest)."""
        after = -self.law.eta * v
        self.impacts.append(Impact(tau / self.p, side * v * self.p, -side * after * self.p))
        j = int(np.searchsorted(self.segments[:, 1], tau, side="right"))
        onward, wait = after_impact(self.law, self.segments, j, tau, -side, after)
        return onward, after if onward else wait

    def _sample(self, path: Any, side: float) -> None:
        wanted = self.times * self.p
        inside = (wanted >= path.t[0]) & (wanted <= path.t[-1])
        if inside.any():
            self.samples[:, inside] = side * path.sol(wanted[inside])

    def history(self) -> History | None:
        """Return the samples to the end of the response, if they were asked for."""
        if not self.recorded:
            return None
        seen = int(np.searchsorted(self.times * self.p, self.end, side="right"))
        theta, rate = self.samples[:, :seen]
        return History(self.times[:seen], theta, rate * self.p)


def _crossing(component: int, level: float, direction: int) -> Callable[[float, Any], float]:
    def event(t: float, x: Any) -> float:
        return float(x[component]) - level

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = direction  # type: ignore[attr-defined]
    return event
