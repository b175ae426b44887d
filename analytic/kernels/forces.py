"""Contact forces of the exact model: where the reference stops being valid, they show it.

A negative normal force means that the pivot lifts off; friction below the ratio of the horizontal
to the normal force means that it slides.
"""

import math

from analytic.kernels.closed_form import turning_rotation, work_to
from analytic.kernels.compiled import kernel
from analytic.kernels.law import FloatArray, Law
from analytic.kernels.rest import acceleration

POINTS = 16
"""Points at which the forces are looked at in a step."""


@kernel
def forces(law: Law, side: float, a: float, y: float, v: float) -> tuple[float, float]:
    """Return (normal, horizontal) contact force over weight of the exact model.

    From the acceleration of the centre of mass, which turns with the diagonal at z = alpha - y
    from the vertical; R p^2 = 3g/4.
    """
    z = law.alpha - y
    rate = acceleration(law, side, a, y)
    horizontal = a + 0.75 * side * (v * v * math.sin(z) + rate * math.cos(z))
    normal = 1.0 + 0.75 * (rate * math.sin(z) - v * v * math.cos(z))
    return normal, horizontal


@kernel
def watch(limits: FloatArray, law: Law, side: float, a: float, y: float, v: float) -> None:
    """Keep the smallest normal force and the largest friction ratio in limits[0], limits[1]."""
    normal, horizontal = forces(law, side, a, y, v)
    limits[0] = min(limits[0], normal)
    limits[1] = max(limits[1], abs(horizontal) / normal if normal > 0.0 else math.inf)


@kernel
def watch_free(limits: FloatArray, law: Law, side: float, y: float, v: float) -> None:
    """Watch a survivor's free rocking from (y, v) between its turning point and its next impact."""
    work = 0.5 * v * v + work_to(law, y)
    top = turning_rotation(law, work)
    if top == math.inf:
        return
    for i in range(POINTS + 1):
        height = top * i / POINTS
        rate = math.sqrt(max(2.0 * (work - work_to(law, height)), 0.0))
        watch(limits, law, side, 0.0, height, rate)
