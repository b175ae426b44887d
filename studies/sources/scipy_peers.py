"""General-purpose integrators on the same problem: what one would use without this project."""

import math
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from analytic import History, Impact, Outcome, Response, RigidBlock
from analytic.kernels.excursions import BROKEN
from analytic.kernels.rest import acceleration, after_impact, ground, next_uplift, segment_at
from analytic.motion import FloatArray, Motion
from analytic.simulate import FAILURES
from analytic.start import REST, Posed, check_vertical, pose

MOST_EXCURSIONS, LYING = 2000, 0.5 * math.pi


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
    """Solve the exact model with `scipy.integrate.solve_ivp`, its events and one of its methods."""
    from scipy.integrate import solve_ivp

    check_vertical(block, motion)
    posed = pose(block, motion, "exact", start, duration, times)
    tolerances = {"rtol": rtol, "atol": 1e-3 * rtol * block.alpha}
    solve = partial(solve_ivp, method=method, dense_output=times is not None, **tolerances)
    march = _March(solve, posed, block.p, math.inf if duration is None else posed.until)
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
        history=None if times is None else march.history(),
    )


@dataclass
class _March:
    """One response: the rotation folded to one side, time in units of 1/p, acceleration in g."""

    solve: Callable[..., Any]
    posed: Posed
    p: float
    until: float
    impacts: list[Impact] = field(default_factory=list)
    evaluations: int = 0
    message: str = FAILURES[BROKEN].message

    def run(self) -> Outcome:
        laws, (side, y, v), segments, *_ = self.posed
        self.peak, self.end, self.samples = y, math.inf, np.zeros((2, self.posed.times.size))
        if not np.all(np.isfinite(segments)):
            return Outcome.FAILED
        tau, j, started = 0.0, 0, side != 0.0
        for _ in range(MOST_EXCURSIONS + len(segments)):
            j = segment_at(segments, j, tau)
            if side == 0.0:
                j, tau, side, _ = next_uplift(segments, j, tau, laws)
            if side == 0.0:
                return Outcome.ROCKED if started or self.peak > 0.0 else Outcome.AT_REST
            path = self._stretch(j, tau, y, v, side)
            if path.status < 0:
                self.message = str(path.message)
                return Outcome.FAILED
            self._record(path, side)
            tau, (y, v) = float(path.t[-1]), path.y[:, -1].tolist()
            if outcome := self._decided(path, tau, y, v):
                self.end = tau
                return outcome
            if len(path.t_events[0]):
                y, (tau, side, v) = 0.0, self._strike(j, tau, v, side)
        self.message = f"more than {MOST_EXCURSIONS} excursions"
        return Outcome.FAILED

    def _stretch(self, j: int, tau: float, y: float, v: float, side: float) -> Any:
        """Integrate to the next impact, breakpoint or decision."""
        # 60/p of free rocking decide: a fall takes at most -ln(1e-16) = 37; the first step out of
        # an impact is a tenth of the excursion, 2 v / y'', which a longer one would step over
        law, rows = self.posed.laws[0], self.posed.segments[j : j + 1].tolist()
        end = rows[0][1] if rows else min(self.until, tau + 60.0)
        decides = not rows and self.until == math.inf

        def rate(t: float, x: Any) -> tuple[float, float]:
            return x[1], acceleration(law, side, ground(rows, 0, t), x[0])

        fall = max(abs(rate(tau, (y, v))[1]), 1e-6)
        path = self.solve(
            rate,
            (tau, end),
            (y, v),
            events=[_crossing(0, 0.0, -1), _crossing(1, 0.0, -1, decides), _crossing(0, LYING, 1)],
            first_step=min(0.2 * v / fall, 0.5 * (end - tau)) if y == 0.0 < v else None,
        )
        self.evaluations += path.nfev
        return path

    def _record(self, path: Any, side: float) -> None:
        self.peak = max(self.peak, path.y[0].max(), *(float(top[0]) for top in path.y_events[1]))
        wanted = self.posed.times * self.p
        inside = (wanted >= path.t[0]) & (wanted <= path.t[-1])
        if inside.any():
            self.samples[:, inside] = side * path.sol(wanted[inside])

    def _decided(self, path: Any, tau: float, y: float, v: float) -> Outcome | None:
        """Return the outcome if a stretch has decided it."""
        contact, turns, lying = path.t_events
        beyond = y > self.posed.laws[0].alpha
        free = self.until == math.inf and tau >= self.posed.segments[-1, 1]
        if len(lying) or (free and beyond and v >= 0.0):
            return Outcome.OVERTURNED
        if tau >= self.until:
            return Outcome.OVERTURNED if beyond else Outcome.ROCKED
        turned = len(turns) and not len(contact) and path.status == 1
        return Outcome.ROCKED if free and turned else None

    def _strike(self, j: int, tau: float, v: float, side: float) -> tuple[float, float, float]:
        """Return time, side and velocity after an impact, or at the rest that follows it."""
        laws, segments, after = self.posed.laws, self.posed.segments, -self.posed.laws[0].eta * v
        self.impacts.append(Impact(tau / self.p, side * v * self.p, -side * after * self.p))
        onward, wait = after_impact(laws, segments, segment_at(segments, j, tau), tau, -side, after)
        return (tau, onward, after) if onward else (tau + wait, 0.0, 0.0)

    def history(self) -> History:
        """Return the samples to the end of the response."""
        times = self.posed.times
        seen = int(np.searchsorted(times * self.p, self.end, side="right"))
        theta, rate = self.samples[:, :seen]
        return History(times[:seen], theta, rate * self.p)


def _crossing(
    component: int, level: float, direction: int, terminal: bool = True
) -> Callable[[float, Any], float]:
    def event(t: float, x: Any) -> float:
        return float(x[component]) - level

    event.terminal, event.direction = terminal, direction  # type: ignore[attr-defined]
    return event
