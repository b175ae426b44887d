"""The response of a block on a cart: Taylor steps between impacts, as for a block.

The state is folded to one side, y = s theta; time is in units of 1/p, places in g/p^2.
"""

import math
import time
from dataclasses import dataclass, field

import numpy as np

from analytic.cart import CartBlock
from analytic.kernels.cart import Coupling, expand_cart, expand_rest
from analytic.kernels.closed_form import turning_rotation
from analytic.kernels.excursions import FAR, LYING, VANISHING, first_crossing, workspace
from analytic.kernels.law import FloatArray, Law, Start
from analytic.kernels.polynomial import highest, next_root, slope, stretch, value
from analytic.kernels.rest import EQUAL, ZENO, ground, segment_at, then_still
from analytic.kernels.taylor import TOLERANCE, accuracy, expand_forcing, trusted_step
from analytic.response import History, Impact, Outcome, Reason, Response

ACCURACY = accuracy(TOLERANCE)
ORDER = ACCURACY.order
REST_STEP = 1.5
"""Step at rest, in units of the shortest time scale: its series is then exact to 1e-18."""
PATIENCE = 300.0
"""Time [1/p] after the motion within which a response has to be decided."""


@dataclass(slots=True)
class Ride:
    """A response as far as it got.

    side is that of the block, 0 at rest; y, v its rotation and rate; x, u those of the cart. lead
    is as in `kernels.law.State`. The samples are of theta, theta', x and x'.
    """

    law: Law
    cart: Coupling
    segments: FloatArray
    times: FloatArray
    until: float
    side: float
    y: float
    v: float
    lead: int
    peak: float
    tau: float = 0.0
    x: float = 0.0
    u: float = 0.0
    segment: int = 0
    steps: int = 0
    fallen: bool = False
    impacts: list[tuple[float, float, float]] = field(default_factory=list)
    uplifts: list[float] = field(default_factory=list)
    rests: list[float] = field(default_factory=list)
    samples: list[FloatArray] = field(default_factory=list)
    sampled: int = 0
    work: FloatArray = field(default_factory=workspace)
    push: FloatArray = field(default_factory=lambda: np.zeros(ORDER + 1))

    def step(self) -> None:
        """Take a step, no further than to an event or the end of a segment."""
        self.segment = segment_at(self.segments, self.segment, self.tau)
        expand_forcing(self.segments[self.segment], self.tau, 1.0, ORDER, self.push)
        self.steps += 1
        if self.side == 0.0:
            self._stand()
        else:
            self._rock()

    def lift_energy(self) -> float:
        """Return the energy above that of the block at rest, over m g R.

        Of a cart without a spring, that of the uniform motion of all is left out.
        """
        z = self.law.alpha - self.y
        kappa, c, w2 = self.cart.kappa, math.cos(z), self.cart.stiffness
        lifted = c - math.cos(self.law.alpha)
        if w2 == 0.0:
            return lifted + 0.5 * self.v**2 * (1.0 - kappa * c * c)
        held = 0.5 * (self.u**2 + w2 * self.x**2) / kappa
        return lifted + held + self.side * c * self.u * self.v + 0.5 * self.v**2

    def is_decided(self) -> bool:
        """Tell whether nothing to come can exceed the peak, the motion being over."""
        if self.side == 0.0:
            w2 = self.cart.stiffness
            return math.hypot(w2 * self.x, math.sqrt(w2) * self.u) <= self.law.onset
        if self.y > self.law.saddle:
            return False
        return bool(turning_rotation(self.law, max(self.lift_energy(), 0.0)) <= self.peak)

    def _length(self, h: float) -> tuple[float, bool]:
        """Return how long the step is that may be h, and whether it ends its segment."""
        end = self.segments[self.segment, 1]
        if self.tau < self.until:
            end = min(end, self.until)
        whole = self.tau + h >= end
        return (end - self.tau, True) if whole else (h, False)

    def _stand(self) -> None:
        """Move on with a block at rest, to its uplift at most."""
        x, moving, w2 = self.work[1], self.work[5], self.cart.stiffness
        x[0], x[1] = self.x, self.u
        expand_rest(w2, ORDER, self.push, x, moving)
        if abs(moving[0]) > self.law.onset * (1.0 + EQUAL):
            self._lift(moving[0], 2)
            return
        quickest = max(math.sqrt(w2), self.segments[self.segment, 3])
        h, _ = self._length(REST_STEP / quickest if quickest > 0.0 else math.inf)
        if h == math.inf:
            h, _ = 1.0, False
        along = np.zeros(ORDER + 1)
        stretch(moving, ORDER - 2, h, along)
        lifts = 2.0
        for sign in (1.0, -1.0):
            excess = sign * along
            excess[0] -= self.law.onset
            lifts = min(lifts, next_root(excess, ORDER - 2, 0.0, self.work[7:]))
        part = min(lifts, 1.0)
        self._sample(h, part, None)
        self.x, self.u = value(x, ORDER, part * h), slope(x, ORDER, part * h)
        self._advance(h, part)
        if lifts <= 1.0:
            self._lift(value(along, ORDER - 2, lifts), 3)

    def _lift(self, ground_now: float, lead: int) -> None:
        self.side, self.y, self.v, self.lead = -math.copysign(1.0, ground_now), 0.0, 0.0, lead
        self.uplifts.append(self.tau)

    def _rock(self) -> None:
        """Move on with a block that rocks, to its impact or fall at most."""
        work, y, x = self.work, self.work[0], self.work[1]
        y[0], y[1], x[0], x[1] = self.y, self.v, self.x, self.u
        expand_cart(self.cart, self.side, self.lead == 3, ORDER, self.push, work)
        h = min(trusted_step(series, ACCURACY) for series in (y, x) if np.any(series[2:]))
        if self.lead == 1 and y[2] < 0.0:
            h = min(h, -FAR * self.v / y[2])
        h, _ = self._length(h)
        d = np.zeros(ORDER + 1)
        stretch(y, ORDER, h, d)
        hits = first_crossing(d, ORDER, self.lead, 0.0, work[7:])
        self.peak, _ = highest(d, ORDER, self.lead, min(hits, 1.0), self.peak, work[7:])
        falls = first_crossing(d, ORDER, 0, LYING, work[7:]) if self.peak >= LYING else 2.0
        part = min(hits, falls, 1.0)
        self._sample(h, part, d)
        self.y, self.v = value(d, ORDER, part), slope(d, ORDER, part) / h
        self.x, self.u = value(x, ORDER, part * h), slope(x, ORDER, part * h)
        self._advance(h, part)
        self.lead, self.fallen = 0, falls <= hits and falls <= 1.0
        if not self.fallen and (hits <= 1.0 or self.y <= 0.0):
            self._strike()

    def _strike(self) -> None:
        """Take the state through an impact: momentum is kept, and so is what turns about a foot."""
        before, after = self.v, -self.law.eta * self.v
        lever = self.cart.kappa * math.cos(self.law.alpha)
        self.u += self.side * lever * (before + after)
        self.impacts.append((self.tau, self.side * before, -self.side * after))
        self.side, self.y, self.v, self.lead = -self.side, 0.0, after, 1
        a = ground(self.segments, self.segment, self.tau) - self.cart.stiffness * self.x
        here, there = self._restoring(self.side, a), self._restoring(-self.side, a)
        wait = math.inf
        if min(here, there) > 0.0 and self.law.eta < 1.0:
            eta = self.law.eta
            wait = 2.0 * after * (1.0 / here + eta / there) / (1.0 - eta * eta)
        if wait < ZENO and self._stays(a, wait, min(here, there)):
            self._settle(a, wait, lever)
        elif after == 0.0:
            self.side, self.lead = -math.copysign(1.0, a), 2

    def _restoring(self, side: float, a: float) -> float:
        """Return -y'' of an upright block on a side."""
        alpha, c = self.law.alpha, math.cos(self.law.alpha)
        return (math.sin(alpha) + side * a * c) / (1.0 - self.cart.kappa * c * c)

    def _stays(self, a: float, wait: float, least: float) -> bool:
        ahead = ground(self.segments, self.segment, self.tau + wait)
        ahead -= self.cart.stiffness * (self.x + wait * self.u)
        return abs(self._restoring(1.0, ahead) - self._restoring(1.0, a)) <= ZENO * least

    def _settle(self, a: float, wait: float, lever: float) -> None:
        """Sum a train of impacts: it ends at rest, with the momentum that the push gives."""
        self.u += self.side * lever * self.v + a * wait
        self.x += wait * self.u
        self.side = self.v = 0.0
        self.tau += wait
        self.rests.append(self.tau)

    def _advance(self, h: float, part: float) -> None:
        end = self.segments[self.segment, 1]
        ends = min(end, self.until) if self.tau < self.until else end
        self.tau = ends if part == 1.0 and self.tau + h >= ends else self.tau + part * h

    def _sample(self, h: float, part: float, d: FloatArray | None) -> None:
        """Sample a step up to a part of it: theta, its rate, and the cart's."""
        last = int(np.searchsorted(self.times, self.tau + part * h, side="right"))
        if last <= self.sampled:
            return
        at = self.times[self.sampled : last] - self.tau
        cart = np.polynomial.Polynomial(self.work[1, : ORDER + 1])
        turned = np.polynomial.Polynomial([0.0] if d is None else self.work[0, : ORDER + 1])
        theta, rate = self.side * turned(at), self.side * turned.deriv()(at)
        self.samples.append(np.array([theta, rate, cart(at), cart.deriv()(at)]))
        self.sampled = last


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
    p, scale = cart.p, cart.gravity / cart.p
    end = until * p
    moving = then_still(segments, math.inf)
    coupling = Coupling(cart.alpha, 0.75 * cart.mass_ratio, cart.stiffness / p**2)
    times = np.empty(0) if sampled is None else sampled * p
    lead = 1 if begin.y == 0.0 else 0
    ride = Ride(law, coupling, moving, times, end, *begin, lead, begin.y)
    bounded = bounded and cart.stiffness > 0.0
    began = time.perf_counter()
    while not ride.fallen:
        if ride.tau >= end and (bounded or ride.is_decided()):
            break
        if ride.tau > end + PATIENCE or not abs(ride.y) + abs(ride.x) < math.inf:
            message = "the cart keeps the block rocking; a duration would decide"
            return Response.failure(message, reason=Reason.UNDECIDED, steps=ride.steps)
        ahead = ride.tau
        ride.step()
        if ride.tau < ahead + ahead * VANISHING and ride.steps > 10**6:
            return Response.failure("the steps vanish", reason=Reason.DIVERGED, steps=ride.steps)
    lifted = bool(ride.uplifts) or begin.side != 0.0
    outcome = Outcome.ROCKED if lifted else Outcome.AT_REST
    outcome = Outcome.OVERTURNED if ride.fallen else outcome
    history = None
    if sampled is not None:
        theta, rate, x, u = np.concatenate([np.empty((4, 0)), *ride.samples], axis=1)
        base = np.array([x * scale / p, u * scale])
        history = History(sampled[: theta.size], theta, rate * p, base)
    return Response(
        outcome=outcome,
        peak_ratio=math.inf if ride.fallen else ride.peak / cart.alpha,
        crossed=ride.fallen or ride.peak > cart.alpha,
        impacts=tuple(
            Impact(float(t) / p, float(a) * p, float(b) * p) for t, a, b in ride.impacts if t <= end
        ),
        uplifts=tuple(float(t) / p for t in ride.uplifts if t <= end),
        rests=tuple(float(t) / p for t in ride.rests if t <= end),
        steps=ride.steps,
        wall_s=time.perf_counter() - began,
        history=history,
    )
