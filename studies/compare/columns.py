"""What a table of a comparison has of each scene: its first line, its columns, what they mean."""

import math
from collections.abc import Mapping

from analytic.frame import RockingFrame
from analytic.frame_forces import frame_demands
from analytic.response import Outcome, Response
from analytic.slide import SlidingBlock
from engines.layouts import BEAM_DEPTH, SPACING, System
from engines.run.drive import LAG
from studies.kit.journal import Row
from studies.kit.posing import Posed
from studies.measures.differences import scientific

Columns = dict[str, list[object]]

OF_A_FRAME = {"parting": "parting/θcr", "tilt": "beam/θcr", "drift_m": "drift [m]"}
"""Observable of a frame -> its column."""


SEEN_M = 1e-6
"""Of a floor's lag, what is shown [m]."""

HOW_SURE = ("κ       per cent of the exact peak for one of the amplitude; sens: the sensitivity",)


def first_line(system: System, degrees: bool) -> str:
    """Return the sizes of what stands on the base."""
    sizes = f"B = {system.width:g} m, H = {system.height:g} m"
    if isinstance(system, SlidingBlock):
        return f"slide   {sizes}, friction {system.friction:g}"
    alpha = f"{math.degrees(system.alpha):.5g}°" if degrees else f"{system.alpha:.5g} rad"
    numbers = f"α = θcr = {alpha}, p = {system.p:.5g} rad/s"
    if isinstance(system, RockingFrame):
        return f"frame   {system.columns} columns of {sizes}, load {system.load:g}: {numbers}"
    return f"block   {sizes}: {numbers}"


def columns_of(
    system: System, rows: list[Row], scale: float, degrees: bool, estimates: Mapping[str, list[str]]
) -> Columns:
    """Return the columns of a scene; rotations are in θcr times `scale`."""
    if isinstance(system, SlidingBlock):
        return {
            "slips [m]": [_slips(row["response"]) for row in rows],
            "vs exact": [part(row["error"]) for row in rows],
            "stops [s]": [_stop(row["response"]) for row in rows],
            "lift [m]": [_observed(row["response"].observables, "lift_m") for row in rows],
        }
    peak = "θmax [°]" if degrees else "θmax/θcr"
    seen = OF_A_FRAME if isinstance(system, RockingFrame) else {}
    slips = [part(row["response"].slip_m / system.width) for row in rows]
    lags = [_lag(row["response"].observables.get(LAG, 0.0)) for row in rows]
    return {
        peak: [_peak(row, scale) for row in rows],
        "vs exact": [_difference(row) for row in rows],
        "κ": [_figures(row["kappa"]) for row in rows],
        "sens": [_figures(row["sensitivity"]) for row in rows],
        **estimates,
        "impacts": [row["impacts"] for row in rows],
        "late·p": [part(row["impact_error"]) for row in rows],
        "ratio": [fixed(row["velocity_ratio"]) for row in rows],
        **({"slip/B": slips} if any(slip != "-" for slip in slips) else {}),
        **({"lag [m]": lags} if any(lag != "-" for lag in lags) else {}),
        **{
            column: [_observed(row["response"].observables, name) for row in rows]
            for name, column in seen.items()
        },
    }


def meanings(system: System, posed: Posed, exact: Response) -> list[str]:
    """Return what the columns mean, and what the exact solution needs, a line each."""
    if isinstance(system, SlidingBlock):
        return ["vs      largest difference of a slip, over the largest slip"]
    eta = f"η = {system.restitution:.6g}"
    if isinstance(system, RockingFrame):
        return [
            *HOW_SURE,
            "late    largest error of the first five impact times, times p",
            f"ratio   velocity after over before an impact, the median; the exact {eta}",
            "parting largest difference of two columns' rotations; beam: its largest rotation",
            f"valid   {frame_validity(system, posed, exact)}",
        ]
    return [
        *HOW_SURE,
        "late    largest error of the first five impact times, times p",
        f"ratio   velocity after over before an impact, the median; Housner's {eta}",
        f"valid   {validity(exact)}",
    ]


def frame_validity(frame: RockingFrame, posed: Posed, exact: Response) -> str:
    """Say what the exact solution of a frame needs of its contacts, or what fails in it."""
    if exact.outcome is Outcome.FAILED:
        return "unknown: there is no exact solution to tell"
    spacing, depth = SPACING * frame.height, BEAM_DEPTH * frame.height
    needs = frame_demands(frame, posed.motion, posed.start, spacing=spacing, depth=depth)
    if needs.spacing >= spacing:
        return f"not here: the beam would tip: L = {spacing:g} m, needs {needs.spacing:.3g}"
    if needs.pressing <= 0.0:
        return "not here: a contact would open, and an engine is right to differ"
    return (
        f"with friction of {needs.base:.3g} at the feet and {needs.top:.3g} under the beam, or "
        f"more; every contact presses with {needs.pressing:.3g} of its weight at least"
    )


def slip_error(response: Response, exact: Response) -> float:
    """Return the largest difference of a slip over the largest; nan where their numbers differ."""
    if not exact.slips or len(response.slips) != len(exact.slips):
        return math.nan
    pairs = zip(response.slips, exact.slips, strict=True)
    return max(abs(one - other) for one, other in pairs) / max(map(abs, exact.slips))


def _slips(response: Response) -> str:
    shown = [f"{slip:+.6f}" for slip in response.slips[:4]]
    more = len(response.slips) - len(shown)
    return " ".join(shown) + (f" … {more} more" if more else "") or "-"


def _stop(response: Response) -> str:
    return f"{response.slip_times[-1][1]:.6f}" if response.slip_times else "-"


def _lag(metres: float) -> str:
    """Return how far a floor lagged, where that is more than its numbers' rounding."""
    return part(metres) if metres > SEEN_M else "-"


def _observed(observables: Mapping[str, float], name: str) -> str:
    return part(observables.get(name, math.nan))


def _figures(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"


def _peak(row: Row, scale: float) -> str:
    return f"{scale * row['peak_ratio']:.6f}" if math.isfinite(row["peak_ratio"]) else "-"


def _difference(row: Row) -> str:
    value = row["error"]
    return ("" if value < 0 else "+") + scientific(value) if math.isfinite(value) else "-"


def valid(exact: Response) -> bool | None:
    """Say whether the pivot stays on the base in the exact solution; None if there is none."""
    if math.isnan(exact.min_normal):
        return None
    return exact.min_normal >= 0.0


def validity(exact: Response) -> str:
    """Say what the exact solution needs to be one: no slip, no lift-off of the pivot."""
    holds = valid(exact)
    if holds is None:
        return "unknown: there is no exact solution to tell"
    if not holds:
        return "not here: the pivot would lift off, and an engine is right to differ"
    least = f"the normal force stays above {exact.min_normal:.3g} of the weight"
    return f"with friction of {exact.friction_needed:.3g} or more; {least}"


def fixed(value: float) -> str:
    """Return a number with six places."""
    return "-" if math.isnan(value) else f"{value:.6f}"


def part(value: float) -> str:
    """Return a part of one as readers write it."""
    return "-" if math.isnan(value) else scientific(value)


def duration(seconds: float) -> str:
    """Return a time in a unit that suits it."""
    return f"{seconds * 1e6:.0f} µs" if seconds < 1e-3 else f"{seconds * 1e3:.1f} ms"
