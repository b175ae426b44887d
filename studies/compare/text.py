"""A comparison as text: the case, what the columns mean, the table, and notes below it."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from analytic.frame import RockingFrame
from analytic.frame_forces import frame_demands
from analytic.motion import Motion, SinePulse, Still
from analytic.response import Outcome, Response
from analytic.simulate import strongest
from analytic.slide import SlidingBlock
from engines.layouts import System
from engines.run.drive import LAG
from studies.cases.paper import PULSES
from studies.compare.rows import is_valid, sizes_of
from studies.kit.jobs import Question, Row
from studies.kit.say import duration
from studies.measures.differences import scientific
from studies.measures.halving import NO_BOUND

OF_A_FRAME = {"parting": "parting/θcr", "tilt": "beam/θcr", "drift_m": "drift [m]"}
"""Observable of a frame -> its column."""
UNKNOWN = "unknown: there is no exact solution to tell"


def table_text(
    case: Question, rows: Sequence[Row], note: str = "", edge: str = "", *, degrees: bool = False
) -> str:
    """Return the table with its head, a note on the motion, and what an answer hangs on.

    Rotations are in units of alpha, or in degrees.
    """
    start = [f"start   {_start(case, degrees)}"] if case.start != (0.0, 0.0) else []
    return "\n".join(
        [
            _standing(case.system, degrees),
            f"ground  {_ground(case)}; observed for {case.duration:.4g} s",
            *start,
            *([f"base    {note}"] if note else []),
            *_meanings(case, rows[0]["exact"]),
            "time    one interpreted run; a study compiles its functions and takes less a case",
            "",
            _aligned([_cells(case.system, row, degrees) for row in rows]),
            *(f"{row['source']}: {row['message']}" for row in rows if row["message"]),
            *([edge] if edge else []),
        ]
    )


def _standing(system: System, degrees: bool) -> str:
    sizes = f"B = {system.width:g} m, H = {system.height:g} m"
    if isinstance(system, SlidingBlock):
        return f"slide   {sizes}, friction {system.friction:g}"
    alpha = f"{math.degrees(system.alpha):.5g}°" if degrees else f"{system.alpha:.5g} rad"
    numbers = f"α = θcr = {alpha}, p = {system.p:.5g} rad/s"
    if isinstance(system, RockingFrame):
        return f"frame   {system.columns} columns of {sizes}, load {system.load:g}: {numbers}"
    return f"block   {sizes}: {numbers}"


def _ground(case: Question) -> str:
    motion, name = case.motion, motion_name(case.motion)
    if isinstance(motion, Still):
        return name
    if isinstance(motion, SinePulse):
        phase = f", phase {motion.phase:g} rad" if motion.phase else ""
        details = f"{motion.omega:g} rad/s{phase}"
    else:
        times = np.array(motion.breakpoints)
        speed = float(np.abs(motion.velocity(times)).max())
        step = motion.duration / (times.size - 1)
        details = f"{speed:.3g} m/s, {times.size} samples every {step:.4g} s"
    peak = strongest(motion) / case.system.gravity
    return f"{name}, {peak:.6g} g, {details}, {motion.duration:.4g} s"


def motion_name(motion: Motion) -> str:
    """Return what a motion of the base is called."""
    if not isinstance(motion, SinePulse):
        return "at rest" if isinstance(motion, Still) else "record"
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(motion.half_cycles, f"{motion.half_cycles} half cycles")


def _start(case: Question, degrees: bool) -> str:
    (theta, rate), system = case.start, case.system
    if degrees:
        return f"θ = {math.degrees(theta):.6g}°, θ' = {math.degrees(rate):.6g}°/s"
    return f"θ = {theta / system.alpha:.6g} α, θ' = {rate / (system.alpha * system.p):.6g} αp"


def _meanings(case: Question, exact: Response) -> list[str]:
    """Return what the columns mean, and what the exact solution needs, a line each."""
    system = case.system
    if isinstance(system, SlidingBlock):
        return ["vs      largest difference of a slip, over the largest slip"]
    frame = isinstance(system, RockingFrame)
    whose = "the exact" if frame else "Housner's"
    parting = "parting largest difference of two columns' rotations; beam: its largest rotation"
    return [
        "κ       per cent of the exact peak for one of the amplitude; sens: the sensitivity",
        "late    largest error of the first five impact times, times p",
        f"ratio   velocity after over before an impact, the median; {whose} η = "
        f"{system.restitution:.6g}",
        *[parting] * frame,
        f"valid   {_validity(case, exact)}",
    ]


def _validity(case: Question, exact: Response) -> str:
    """Say what the exact solution needs of its contacts, or what fails in it."""
    if exact.outcome is Outcome.FAILED:
        return UNKNOWN
    if isinstance(case.system, RockingFrame):
        sizes = sizes_of(case.system)
        needs = frame_demands(case.system, case.motion, case.start, **sizes)
        if needs.spacing >= (spacing := sizes["spacing"]):
            return f"not here: the beam would tip: L = {spacing:g} m, needs {needs.spacing:.3g}"
        if needs.pressing <= 0.0:
            return "not here: a contact would open, and an engine is right to differ"
        return (
            f"with friction of {needs.base:.3g} at the feet and {needs.top:.3g} under the beam, or "
            f"more; every contact presses with {needs.pressing:.3g} of its weight at least"
        )
    if (valid := is_valid(exact)) is None:
        return UNKNOWN
    if not valid:
        return "not here: the pivot would lift off, and an engine is right to differ"
    least = f"the normal force stays above {exact.min_normal:.3g} of the weight"
    return f"with friction of {exact.friction_needed:.3g} or more; {least}"


def _cells(system: System, row: Row, degrees: bool) -> dict[str, str]:
    """Return what the columns show of one source, by their titles."""
    answer: Response = row["response"]
    lag = answer.observables.get(LAG, math.nan)
    shown = {"source": row["source"], "outcome": row["outcome"]}
    effort = {"steps": str(row["steps"]), "time": duration(row["wall_s"])}
    if isinstance(system, SlidingBlock):
        stop = answer.slip_times[-1][1] if answer.slip_times else math.nan
        return {
            **shown,
            "slips [m]": _slips(answer.slips),
            "vs exact": scientific(row["error"]),
            "stops [s]": _number(stop, ".6f"),
            "lift [m]": scientific(answer.observables.get("lift_m", math.nan)),
            **effort,
        }
    observed = OF_A_FRAME.items() if isinstance(system, RockingFrame) else ()
    peak = row["peak_ratio"] * (math.degrees(system.alpha) if degrees else 1.0)
    return {
        **shown,
        "θmax [°]" if degrees else "θmax/θcr": _number(peak, ".6f"),
        "vs exact": "+" * (row["error"] >= 0.0) + scientific(row["error"]),
        "κ": _number(row["kappa"], ".2g"),
        "sens": _number(row["sensitivity"], ".2g"),
        **_estimates(row),
        "impacts": str(row["impacts"]),
        "late·p": scientific(row["impact_error"]),
        "ratio": _number(row["velocity_ratio"], ".6f"),
        "slip/B": scientific(answer.slip_m / system.width),
        "lag [m]": scientific(lag if lag > 1e-6 else math.nan),  # less cannot be seen
        **{title: scientific(answer.observables.get(name, math.nan)) for name, title in observed},
        **effort,
    }


def _estimates(row: Row) -> dict[str, str]:
    if "estimate" not in row:
        return {}
    blind = math.isnan(row["bound"]) and not math.isnan(row["estimate"])
    bound = NO_BOUND if blind else scientific(row["bound"])
    return {"estimate": scientific(row["estimate"]), "bound 95 %": bound}


def _slips(slips: Sequence[float]) -> str:
    first = " ".join(f"{slip:+.6f}" for slip in slips[:4])
    return f"{first} … {len(slips) - 4} more" if len(slips) > 4 else first or "-"


def _number(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "-"


def _aligned(rows: Sequence[Mapping[str, str]]) -> str:
    """Return the rows under their titles, two columns only where some source has a number."""
    columns = [[title, *(row[title] for row in rows)] for title in rows[0]]
    perhaps = ("slip/B", "lag [m]")
    kept = [each for each in columns if each[0] not in perhaps or set(each[1:]) != {"-"}]
    widths = [max(map(len, column)) for column in kept]
    lines = (zip(line, widths, strict=True) for line in zip(*kept, strict=True))
    return "\n".join(" ".join(text.rjust(width) for text, width in line) for line in lines)
