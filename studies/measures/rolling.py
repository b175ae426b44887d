"""What is told of a cylinder that rolls, after so many turns."""

import math

from analytic.response import Response
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row

TURNS = (5.0, 50.0)
"""After so many turns of the foot about the centre a cylinder is looked at."""

ERRORS = ("tilt_error_rad", "phase_error_rad", "height_drift_m", "aside_m", "energy_change")
"""Observables of `studies.sources.rolling.seen` that are told."""


def reduced(job: Job, response: Response) -> Row:
    """Return how far a rolling cylinder is from its steady motion.

    Parameters
    ----------
    job : Job
        Of a `RollingCylinder`; its label turns says how many turns of the foot it lasts.
    response : Response

    Returns
    -------
    dict
        The columns of `summary`; ERRORS, in the units of their names (energy_change over the steady
        energy), nan where they were not observed; tilt_growth and phase_growth, what small
        disturbances become by then: `RollingCylinder.growth`.
    """
    tilt, phase = job.block.growth(job.labels["turns"] * job.block.turn)
    seen = {name: float(response.observables.get(name, math.nan)) for name in ERRORS}
    return {**summary(job, response), **seen, "tilt_growth": tilt, "phase_growth": phase}
