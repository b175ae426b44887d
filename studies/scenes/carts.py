"""A block on a cart that feels it: cases, what of an answer is kept, and the tables of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from analytic import CartBlock, simulate
from analytic.motion import SinePulse
from analytic.response import Outcome, Response
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.measures.carts import impact_ratio, place_error
from studies.scenes.places import steps
from studies.sources.registry import resolve

CARTS = ((1e-3, 0.0), (0.1, 0.0), (0.5, 0.0), (0.9, 0.0), (0.5, 5.0), (0.3, 20.0))
"""m/(m + M) and k/(m + M) [1/s2]: one that is all but a base, free ones, and two on springs."""

PULSES = ((0.6, 20.0), (0.6, 16.0), (0.8, 14.0))
"""Amplitude [g] and circular frequency [rad/s] of full sines; under the last one blocks fall.

No pivot needs more friction than 1.3, the least that a tuned preset has."""

PHASES = 3
"""Places of the first impact in a step; one where the block falls, and more says nothing."""

REFINED = (4.0, 2.0, 0.5)
"""Steps over an engine's own at which one case is asked again: the first pulse on `ASKED_AGAIN`."""

ASKED_AGAIN = (0.5, 0.0)

OBSERVED = 5.0
"""How long a cart is observed after the motion, in units of 1/p."""

TIMES = 31
"""Times at which the cart's place is compared."""

LIKE = ["mass_ratio", "stiffness", "amplitude_g", "omega"]


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
    for cart, pulse in ((cart, pulse) for cart in CARTS for pulse in PULSES):
        again = cart == ASKED_AGAIN and pulse == PULSES[0]
        phases = 1 if pulse == PULSES[-1] else PHASES
        for refined in (1.0, *(REFINED if again and not quick else ())):
            for source in sources if again or not quick else ():
                yield from _jobs(cart, pulse, source, 2 if quick else phases, refined)


def _jobs(
    cart: tuple[float, float], pulse: tuple[float, float], source: str, phases: int, refined: float
) -> Iterator[Job]:
    block = CartBlock(width=0.5, height=1.5, mass_ratio=cart[0], stiffness=cart[1])
    motion = SinePulse.in_g(pulse[0], omega=pulse[1], half_cycles=2)
    end = motion.duration + OBSERVED / block.p
    said = dict(zip(LIKE, (*cart, *pulse), strict=True))
    for place, options in enumerate(steps(source, block, motion, phases, end)):
        if options or refined == 1.0:
            yield Job(
                labels={"scene": "cart", **said, "refined": refined, "in_step": place},
                block=block,
                motion=motion,
                source=source,
                duration=end,
                times=np.linspace(0.0, end, TIMES),
                options={name: refined * step for name, step in options.items()},
            )


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


def cart_summary(parts: Sequence[tuple[str, pd.DataFrame]]) -> pd.DataFrame:
    """Return for each source how many of its carts are wrong, and how far off the others are.

    Parameters
    ----------
    parts : sequence of (str, DataFrame)
        The rows of each source, of what it can hold.
    """
    return pd.DataFrame(
        [{"source": source, **_line(part[part["refined"] == 1.0])} for source, part in parts]
    )


def cart_steps(parts: Sequence[tuple[str, pd.DataFrame]]) -> pd.DataFrame:
    """Return for each source and step, over its own, how far off the cart that is asked again is.

    Parameters
    ----------
    parts : sequence of (str, DataFrame)
        As of `cart_summary`.
    """
    lines = []
    for source, part in parts:
        case = part[LIKE].eq([*ASKED_AGAIN, *PULSES[0]]).all(axis=1)
        for refined, rows in part[case].groupby("refined"):
            lines.append({"source": source, "refined": refined, **_line(rows)})
    return pd.DataFrame(lines)


def _line(rows: pd.DataFrame) -> dict[str, Any]:
    size = rows["error"].abs()
    return {
        "carts": len(rows),
        "wrong": int((~rows["agrees"].astype(bool)).sum()),
        "median_error": size.median(),
        "largest_error": size.max(),
        "median_eta_error": rows["eta_error"].abs().median(),
        "place_error_m": rows["place_error_m"].max(),
        "momentum_error": rows["momentum_error"].max(),
        "us_a_step": 1e6 * rows["wall_s"].sum() / max(int(rows["steps"].sum()), 1),
    }
