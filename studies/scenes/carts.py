"""A block on a cart that feels it: cases, and what of an answer is kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from analytic import CartBlock, simulate
from analytic.motion import SinePulse
from analytic.response import Outcome, Response
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.measures.carts import impact_ratio, place_error
from studies.scenes.places import placed
from studies.sources.registry import resolve

CARTS = ((1e-3, 0.0), (0.1, 0.0), (0.5, 0.0), (0.9, 0.0), (0.5, 5.0), (0.3, 20.0))
"""m/(m + M) and k/(m + M) [1/s2]: one that is all but a base, free ones, and two on springs."""

PULSES = ((0.6, 20.0), (0.6, 16.0), (0.8, 14.0))
"""Amplitude [g] and circular frequency [rad/s] of full sines; under the last one blocks fall.

No pivot needs more friction than 1.3, the least that a tuned preset has."""

PHASES = 3
"""Places of the first impact in a step; one where the block falls, and more says nothing."""

OBSERVED = 5.0
"""How long a cart is observed after the motion, in units of 1/p."""

TIMES = 31
"""Times at which the cart's place is compared."""

AGAIN = {"mass_ratio": 0.5, "stiffness": 0.0, "amplitude_g": 0.6, "omega": 20.0}
"""The case that is asked in several steps, by its labels."""

REFINED = (4.0, 2.0, 0.5)
"""Steps over an engine's own at which it is asked again."""


def carts(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of blocks on carts under pulses, and of one in other steps.

    Engines are asked with equal steps alone: no others are built for a cart.

    Parameters
    ----------
    sources : sequence of str
        exact, and names of engines, of which those with other steps are left out.
    quick : bool
        One cart under one pulse alone.

    Yields
    ------
    Job
        Its labels are scene, mass_ratio, stiffness, amplitude_g, omega, refined (step over the
        engine's own) and in_step (which of the steps that are tried).

    Raises
    ------
    BadInputError
        If a source is neither exact nor an engine.
    """
    sources = [name for name in sources if not resolve(name).accurate]
    for cart, pulse in product(CARTS, PULSES):
        said = dict(zip(AGAIN, (*cart, *pulse), strict=True))
        if quick and said != AGAIN:
            continue
        block = CartBlock(width=0.5, height=1.5, mass_ratio=cart[0], stiffness=cart[1])
        motion = SinePulse.in_g(pulse[0], omega=pulse[1], half_cycles=2)
        end = motion.duration + OBSERVED / block.p
        phases = 2 if quick else 1 if pulse == PULSES[-1] else PHASES
        for refined in (1.0, *(REFINED if said == AGAIN and not quick else ())):
            for source in sources:
                job = Job(
                    labels={"scene": "cart", **said, "refined": refined},
                    block=block,
                    motion=motion,
                    source=source,
                    duration=end,
                    times=np.linspace(0.0, end, TIMES),
                )
                yield from placed(job, phases, refined, "in_step")


def cart_row(job: Job, response: Response) -> Row:
    """Return how far a response is from the exact one of its cart.

    Parameters
    ----------
    job : Job
        Of `carts`.
    response : Response

    Returns
    -------
    dict
        exact, its peak; agrees; error, that of the peak, relative; eta, exact_eta and eta_error
        (relative), of the velocity ratio at fast impacts; place_error_m [m]; momentum_error,
        relative. Errors of peak and place are nan unless both rock and survive.
    """
    exact = simulate(job.block, job.motion, duration=job.duration, times=job.times)
    both = response.outcome is Outcome.ROCKED is exact.outcome
    found, eta = impact_ratio(response), float(job.block.restitution)
    return {
        "exact": exact.peak_ratio,
        "agrees": response.outcome is exact.outcome,
        "error": response.peak_ratio / exact.peak_ratio - 1.0 if both else np.nan,
        "eta": found,
        "exact_eta": eta,
        "eta_error": found / eta - 1.0,
        # one that falls goes on to where nothing is asked
        "place_error_m": place_error(response, exact) if both else np.nan,
        "momentum_error": float(response.observables.get("momentum_error", np.nan)),
    }
