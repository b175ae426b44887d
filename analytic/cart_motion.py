"""The response of a block on a cart: Taylor steps between impacts, as for a block.

Symbols and units are those of `analytic.kernels.cart`; for the impact and for the bounds of what is
still to come see EQUATIONS.md, "The block on a cart".
"""

import math
import time
from dataclasses import dataclass, field

import numpy as np

from analytic.cart import CartBlock
from analytic.kernels.cart import Coupling, expand_cart, expand_rest
from analytic.kernels.closed_form import turning_rotation
from analytic.kernels.excursions import FAR, LYING, first_crossing, workspace
from analytic.kernels.law import FloatArray, Law, Start
from analytic.kernels.polynomial import highest, next_root, slope, stretch, value
from analytic.kernels.rest import EQUAL, ground, segment_at, side_after, then_still, time_to_rest
from analytic.kernels.taylor import TOLERANCE, accuracy, expand_forcing, trusted_step
from analytic.response import History, Impact, Outcome, Reason, Response

ACCURACY = accuracy(TOLERANCE)
ORDER = ACCURACY.order
REST_STEP = 1.5
"""Step at rest, in units of the shortest time scale: its series is then exact to 1e-18."""
PATIENCE = 300.0
"""Time [1/p] after the motion within which a response has to be decided."""
MAX_STEPS = 1_000_000


@dataclass(slots=True)
class Ride:
    """A response as far as it got.

    side is that of the block, 0 at rest; y, v its rotation and rate; x, u those of the cart; lead
    as in `kernels.law.State`. times [1/p] are those to sample theta, theta', x and x' at, and until
    is one to stop at.
    """

    law: Law
    cart: Coupling
    segments: FloatArray
    times: FloatArray
    until: float
    side: float
    y: float
    v: float
    peak: float
    lead: int
    tau: float = 0.0
    x: float = 0.0
    u: float = 0.0
    segment: int = 0
    steps: int = 0
    fallen: bool = False
    impacts: list[tuple[float, float, float]] = field(default_factory=list)
    uplifts: list[float] = field(default_factory=list)
    rests: list[float] = field(default_factory=list)
    samples: list[FloatArray] = field(default_factory=lambda: [np.empty((4, 0))])
    work: FloatArray = field(default_factory=workspace)
    push: FloatArray = field(default_factory=lambda: np.zeros(ORDER + 1))
    along: FloatArray = field(default_factory=lambda: np.zeros(ORDER + 1))

    def step(self) -> None:
        """Take a step, no further than to an event, the end of a segment, or `until`."""
        self.segment = segment_at(self.segments, self.segment, self.tau)
        expand_forcing(self.segments[self.segment], self.tau, 1.0, ORDER, self.push)
        self.steps += 1
        self.work[:2] = 0.0
        self.work[0, :2], self.work[1, :2] = (self.y, self.v), (self.x, self.u)
        if self.side == 0.0:
            self._stand()
        else:
            self._rock()

    def is_decided(self) -> bool:
        """Tell whether nothing to come can exceed the peak, the motion being over."""
        w2 = self.cart.stiffness
        if self.side == 0.0:
            return math.hypot(w2 * self.x, math.sqrt(w2) * self.u) <= self.law.onset
        if self.y > self.law.saddle:
            return False
        # over m g R and above the block at rest; without a spring, seen from where all moves alike
        kappa, c = self.cart.kappa, math.cos(self.law.alpha - self.y)
        energy = c - math.cos(self.law.alpha) + 0.5 * self.v**2
        if w2 == 0.0:
            energy -= 0.5 * kappa * (c * self.v) ** 2
        else:
            energy += 0.5 * (self.u**2 + w2 * self.x**2) / kappa + self.side * c * self.u * self.v
        return bool(turning_rotation(self.law, max(energy, 0.0)) <= self.peak)

    def _stand(self) -> None:
        """Move on with a block at rest, to its uplift at most."""
        moving, w2, onset = self.work[5], self.cart.stiffness, self.law.onset
        expand_rest(w2, ORDER, self.push, self.work[1], moving)
        if abs(moving[0]) > onset * (1.0 + EQUAL):
            self._lift(moving[0], 2)
            return
        quickest = max(math.sqrt(w2), self.segments[self.segment][3])
        h = min(REST_STEP / quickest if quickest > 0.0 else math.inf, self._limit() - self.tau)
        stretch(moving, ORDER - 2, h, self.along)
        lifts = 2.0
        for sign in (1.0, -1.0):
            excess = sign * self.along
            excess[0] -= onset
            lifts = min(lifts, next_root(excess, ORDER - 2, 0.0, self.work[7:]))
        self._move(h, min(lifts, 1.0))
        if lifts <= 1.0:
            self._lift(value(self.along, ORDER - 2, lifts), 3)

    def _lift(self, a: float, lead: int) -> None:
        self.side, self.lead = -math.copysign(1.0, a), lead
        self.uplifts.append(self.tau)

    def _rock(self) -> None:
        """Move on with a block that rocks, to its impact or fall at most."""
        y, d, spare = self.work[0], self.along, self.work[7:]
        expand_cart(self.cart, self.side, self.lead == 3, ORDER, self.push, self.work)
        h = min(trusted_step(series, ACCURACY) for series in self.work[:2])
        if self.lead == 1 and y[2] < 0.0:
            h = min(h, -FAR * self.v / y[2])
        h = min(h, self._limit() - self.tau)
        stretch(y, ORDER, h, d)
        hits = first_crossing(d, ORDER, self.lead, 0.0, spare)
        self.peak, _ = highest(d, ORDER, self.lead, min(hits, 1.0), self.peak, spare)
        falls = first_crossing(d, ORDER, 0, LYING, spare) if self.peak >= LYING else 2.0
        self._move(h, min(hits, falls, 1.0))
        self.lead, self.fallen = 0, falls <= min(hits, 1.0)
        if not self.fallen and (hits <= 1.0 or self.y <= 0.0):
            self._strike()

    def _strike(self) -> None:
        """Take the state through an impact, and through those after it where they are summed.

        The momentum of all is kept, and of the block what turns about its new foot.
        """
        before, after, onto = self.v, -self.law.eta * self.v, -self.side
        c = math.cos(self.law.alpha)
        self.impacts.append((self.tau, self.side * before, onto * after))
        self.u += self.cart.kappa * c * self.side * (before + after)
        a = self._felt(0.0)
        wait = time_to_rest(self.law, onto, after, a) * (1.0 - self.cart.kappa * c * c)
        later = self._felt(wait) if wait < math.inf else a
        self.side = side_after(self.law, onto, after, a, later, wait)
        self.y, self.v, self.lead = 0.0, after, 1 if after != 0.0 else 2
        if self.side == 0.0:
            self.u += self.cart.kappa * c * onto * after + a * wait
            self.x, self.v, self.tau = self.x + wait * self.u, 0.0, self.tau + wait
            self.rests.append(self.tau)

    def _felt(self, wait: float) -> float:
        push = ground(self.segments, self.segment, self.tau + wait)
        return float(push - self.cart.stiffness * (self.x + wait * self.u))

    def _limit(self) -> float:
        end = float(self.segments[self.segment][1])
        return min(end, self.until) if self.tau < self.until else min(end, self.tau + PATIENCE)

    def _move(self, h: float, part: float) -> None:
        """Move on by a part of a step, sampled, along the series in work[:2]."""
        done, passed = sum(rows.shape[1] for rows in self.samples), self.tau + part * h
        at = self.times[done : np.searchsorted(self.times, passed, side="right")] - self.tau
        if at.size:
            series = [np.polynomial.Polynomial(row[: ORDER + 1]) for row in self.work[:2]]
            turned, cart = ((line(at), line.deriv()(at)) for line in series)
            self.samples.append(np.array([*(self.side * row for row in turned), *cart]))
        (y, x), end = self.work[:2], part * h
        self.y, self.v = value(y, ORDER, end), slope(y, ORDER, end)
        self.x, self.u = value(x, ORDER, end), slope(x, ORDER, end)
        limit = self._limit()
        self.tau = limit if part == 1.0 and passed >= limit * (1.0 - 1e-15) else passed


def ridden(
    cart: CartBlock,
    law: Law,
    segments: FloatArray,
    begin: Start,
    until: float,
    sampled: FloatArray | None,
    bounded: bool,
) -> Response:
    """Solve the response of a block on a cart that starts at rest.

    Parameters
    ----------
    cart : CartBlock
    law : Law
        The exact one, of the block's alpha and the cart's restitution.
    segments, begin
        As for `kernels.excursions.march`.
    until : float
        Time [s] up to which the response has events and samples.
    sampled : ndarray or None
        Times [s] of the history.
    bounded : bool
        Whether a response with a spring is decided at that time, too.
    """
    p, w2, end = cart.p, cart.stiffness / cart.p**2, until * cart.p
    times = np.empty(0) if sampled is None else sampled * p
    coupling = Coupling(cart.alpha, 0.75 * cart.mass_ratio, w2)
    moving, lead = then_still(segments, math.inf), 1 if begin.y == 0.0 else 0
    ride = Ride(law, coupling, moving, times, end, *begin, begin.y, lead)
    began = time.perf_counter()
    first = np.array([begin.side * begin.y, begin.side * begin.v, 0.0, 0.0])
    ride.samples.append(np.repeat(first[:, None], np.count_nonzero(times <= 0.0), axis=1))
    while not ride.fallen:
        if ride.tau >= end and ((bounded and w2 > 0.0) or ride.is_decided()):
            break
        if not abs(ride.y) + abs(ride.x) < math.inf:
            message = "the solution overflows"
            return Response.failure(message, reason=Reason.DIVERGED, steps=ride.steps)
        if ride.tau > end + PATIENCE or ride.steps == MAX_STEPS:
            message = "the cart keeps the block rocking; a duration would decide"
            return Response.failure(message, reason=Reason.UNDECIDED, steps=ride.steps)
        ride.step()
    wall_s = time.perf_counter() - began
    rocked = ride.uplifts or begin.side != 0.0
    survived = Outcome.ROCKED if rocked else Outcome.AT_REST
    theta, rate, x, u = np.concatenate(ride.samples, axis=1)
    base = np.array([x, u * p]) * cart.gravity / p**2
    return Response(
        outcome=Outcome.OVERTURNED if ride.fallen else survived,
        peak_ratio=math.inf if ride.fallen else ride.peak / cart.alpha,
        crossed=ride.fallen or ride.peak > cart.alpha,
        impacts=tuple(Impact(t / p, a * p, b * p) for t, a, b in ride.impacts if t <= end),
        uplifts=tuple(t / p for t in ride.uplifts if t <= end),
        rests=tuple(t / p for t in ride.rests if t <= end),
        steps=ride.steps,
        wall_s=wall_s,
        history=None if sampled is None else History(sampled[: x.size], theta, rate * p, base),
    )
