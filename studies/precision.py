"""Error against run time: every method along its own setting, on the same cases."""

import functools
import json
import math
import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pandas as pd

from analytic import peak_ratios, simulate
from analytic.response import Outcome, Response
from studies import provenance
from studies.arguments import Positive
from studies.cases import Case, free_rocking_window, sweep_cases
from studies.differences import scientific
from studies.energy import flights
from studies.executors import Local
from studies.jobs import Job, ask, summary
from studies.journal import Row
from studies.methods import METHODS, Method
from studies.runner import exit_code, fill_folder
from studies.sources import Source

PRODUCTS = ("precision.csv", "work-precision.csv", "precision.png", "findings.txt")
TARGETS = (1e-2, 1e-3, 1e-4, 1e-6)
CASE = ("figure", "aspect", "width_m", "omega_over_p")
"""Columns that tell one case from another."""
SAMPLES = 400
"""Samples of a history, from which the drift of energy is read."""
COMPARED_IMPACTS = 3
BUDGET_S, QUICK_BUDGET_S = 0.2, 0.02
"""Time [s] spent on timing one case with one setting."""


def command(
    *,
    out: Path,
    quick: bool = False,
    time_limit: Positive = 60.0,
) -> int:
    """Report error against run time.

    Every method along its own setting (tolerance, step, solver iterations) on 12 cases of the
    paper whose peaks lie before or after impacts, and 12 near overturning. Timing is serial, on
    one thread, warm, the best of several runs; building and compiling are apart.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    quick
        Fewer cases and settings: less than a minute on 2 cores.
    time_limit
        Wall-clock time [s] after which one case with one setting is given up.
    """
    rows = fill_folder(
        out,
        "precision",
        precision_jobs(quick),
        executor=Local(
            workers=1,
            time_limit_s=time_limit,
            ask=functools.partial(measure, budget_s=QUICK_BUDGET_S if quick else BUDGET_S),
        ),
        reduce=reduce,
        settings={"quick": quick},
        growing={},
        products=PRODUCTS,
    )
    print(report(out))
    return exit_code(rows)


def precision_cases(quick: bool) -> dict[str, list[Case]]:
    """Return the cases of each set: "typical", with peaks near 0.3, and "near overturning".

    Of each of the paper's figures and aspect ratios one case each; quick takes two figures.
    """
    chosen: dict[str, list[Case]] = {"typical": [], "near overturning": []}
    for figure in (6, 8) if quick else (6, 7, 8, 9):
        for aspect in (2, 3, 4):
            cases = [
                case
                for case in sweep_cases([figure])
                if case.aspect == aspect and case.width_m == 0.5
            ]
            peaks = np.array([_exact_peak(case) for case in cases])
            survivors = np.where(np.isfinite(peaks), peaks, -1.0)
            chosen["typical"].append(cases[int(np.argmin(np.abs(survivors - 0.3)))])
            chosen["near overturning"].append(cases[int(np.argmax(survivors))])
    return chosen


def _exact_peak(case: Case) -> float:
    block = case.block
    half_cycles = case.motion.half_cycles
    peak, _ = peak_ratios(block.alpha, case.amplitude_g, case.omega_over_p, half_cycles)
    return float(peak)


def precision_jobs(quick: bool) -> list[Job]:
    """Return a job for every method, setting and case."""
    return [
        Job(
            labels={"method": name, "value": value, "set": kind, **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=method.source,
            duration=free_rocking_window(case.block, case.motion),
            times=np.linspace(0.0, free_rocking_window(case.block, case.motion), SAMPLES),
            options=method.options_at(value),
        )
        for name, method in METHODS.items()
        for value in (quick_values(method) if quick else method.values)
        for kind, cases in precision_cases(quick).items()
        for case in cases
    ]


def quick_values(method: Method) -> tuple[float, ...]:
    """Return every other setting of a method without its two dearest."""
    return method.values[: max(len(method.values) - 2, 1) : 2]


def measure(job: Job, source: Source, *, budget_s: float) -> Response:
    """Run a job once with all records, then time it without any: to its peak only.

    Returns
    -------
    Response
        The recorded one with the outcome, peak and steps of the timed ones, the shortest of their
        run times and of their set-up times.
    """
    recorded = ask(job, source)
    plain = replace(job, duration=None, times=None)
    began = time.perf_counter()
    timed: list[Response] = []
    setups: list[float] = []
    while not timed or time.perf_counter() - began < budget_s:
        start = time.perf_counter()
        timed.append(ask(plain, source))
        setups.append(time.perf_counter() - start - timed[-1].wall_s)
    best = min(timed, key=lambda response: response.wall_s)
    if Outcome.FAILED in (recorded.outcome, best.outcome):
        return best if best.outcome is Outcome.FAILED else recorded
    return replace(
        recorded,
        outcome=best.outcome,
        peak_ratio=best.peak_ratio,
        steps=best.steps,
        wall_s=best.wall_s,
        setup_s=min(setups),
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the summary, the set-up time, the first impact times and the drift of energy."""
    times = [impact.time * job.block.p for impact in response.impacts[:COMPARED_IMPACTS]]
    return {
        **summary(job, response),
        "setup_s": round(response.setup_s, 9),
        "impact_times": json.dumps(times),
        "energy_drift": energy_drift(job, response),
    }


def energy_drift(job: Job, response: Response) -> float:
    """Return how much the energy of free rocking varies between two impacts, relative; or nan.

    The largest over the flights after the ground motion; the energy is the exact model's, over its
    value at the flight's end, and the samples next to an impact are left out.
    """
    if response.outcome is not Outcome.ROCKED:
        return math.nan
    drifts = (float(np.ptp(e) / e[-1]) for e in flights(job.block, job.motion, response))
    return max(drifts, default=math.nan)


def with_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Add to every row its errors: of the peak, against its method's own finest run, of impacts.

    A wrong outcome is an infinite error, so that it cannot pass unseen; a failed row has none.
    """
    exact = {}
    for case in (case for cases in precision_cases(quick=False).values() for case in cases):
        window = free_rocking_window(case.block, case.motion)
        exact[tuple(asdict(case)[name] for name in CASE)] = (
            simulate(case.block, case.motion, duration=window),
            case,
        )
    names = list(rows[list(CASE)].itertuples(index=False, name=None))
    peaks = np.array([exact[name][0].peak_ratio for name in names])
    failed = rows["outcome"] == Outcome.FAILED.value
    error = (rows["peak_ratio"] / peaks - 1.0).abs()
    finest = rows.groupby(["method", "figure", "aspect", "set"])["peak_ratio"].transform("last")
    own = (rows["peak_ratio"] / finest - 1.0).abs()
    late = [
        _impact_error(json.loads(found), *exact[name])
        for found, name in zip(rows["impact_times"], names, strict=True)
    ]
    return rows.assign(
        error=error.mask(failed),
        own_error=own.mask(failed),
        impact_error=pd.Series(late, index=rows.index).mask(failed),
        failed=failed,
        pulse_s=[exact[name][1].motion.duration for name in names],
    )


def _impact_error(found: list[float], response: Response, case: Case) -> float:
    """Return the largest error of the first impact times [1/p]; inf where one is missing."""
    wanted = [impact.time * case.block.p for impact in response.impacts[:COMPARED_IMPACTS]]
    if len(found) < len(wanted):
        return math.inf
    pairs = zip(found, wanted, strict=False)
    return max((abs(a - b) for a, b in pairs), default=0.0)


def work_precision(compared: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each method, setting and set: errors over the cases, cost of one case."""
    groups = compared.groupby(["set", "method", "value"], sort=False)
    table = groups.agg(
        cases=("error", "size"),
        failed=("failed", "sum"),
        median_error=("error", "median"),
        max_error=("error", "max"),
        own_error=("own_error", "median"),
        impact_error=("impact_error", "median"),
        energy_drift=("energy_drift", "median"),
        steps=("steps", "mean"),
        wall_s=("wall_s", "mean"),
        setup_s=("setup_s", "mean"),
        pulse_s=("pulse_s", "mean"),
    ).reset_index()
    table["real_time_factor"] = table["pulse_s"] / table["wall_s"]
    return table.drop(columns="pulse_s")


def observed_order(line: pd.DataFrame, method: Method) -> tuple[float, float]:
    """Return the order of the median error in the step with its standard error; nan if unclear.

    A line through the logarithms, over the settings whose error is above three times the floor.
    """
    usable = line[(line["failed"] == 0) & np.isfinite(line["median_error"])]
    usable = usable[usable["median_error"] > 3.0 * usable["median_error"].min()]
    usable = usable[usable["median_error"] < 0.3]
    if not method.stepping or len(usable) < 3:
        return math.nan, math.nan
    x, y = np.log(usable["value"]), np.log(usable["median_error"])
    (slope, _), covariance = np.polyfit(x, y, 1, cov="unscaled")
    residual = y - np.polyval(np.polyfit(x, y, 1), x)
    spread = math.sqrt(float((residual**2).sum()) / max(len(x) - 2, 1) * covariance[0, 0])
    return float(slope), spread


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """Return, for each method and target, the cheapest setting whose largest error is below it.

    Costs are over that of the Taylor series at its tightest tolerance.
    """
    unit = table[table["method"] == "Taylor series"]["wall_s"].iloc[-1]
    lines = []
    for name, group in table.groupby("method", sort=False):
        line: dict[str, object] = {"method": name}
        for target in TARGETS:
            good = group[(group["failed"] == 0) & (group["max_error"] <= target)]
            if good.empty:
                line[f"{target:.0e}"] = "-"
                continue
            best = good.sort_values("wall_s").iloc[0]
            setting = f" at {best['value']:.0e}" if METHODS[str(name)].setting else ""
            line[f"{target:.0e}"] = f"{best['wall_s'] / unit:.3g} x{setting}"
        lines.append(line)
    return pd.DataFrame(lines)


def report(folder: Path) -> str:
    """Reduce and draw a folder's precision.csv; return tables and findings as text."""
    from studies.diagrams import draw_precision
    from studies.figures import save

    rows = pd.read_csv(folder / "precision.csv", dtype={"message": str})
    table = work_precision(with_errors(rows))
    provenance.write_text(folder / "work-precision.csv", table.to_csv(index=False, na_rep="nan"))
    save(draw_precision(table), folder / "precision.png")
    typical = table[table["set"] == "typical"]
    text = "\n".join(
        [
            "Cheapest setting whose largest error of the peak stays below a target, typical cases;",
            "cost over that of the Taylor series at its tightest:",
            cheapest(typical).to_string(index=False),
            "\nErrors at the finest setting, where they stop falling, and the observed order:",
            floor_text(typical),
            "",
            findings(typical),
        ]
    )
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def floor_text(table: pd.DataFrame) -> str:
    """Return for each method its smallest median error, its order and the errors beside it."""
    lines = []
    for name, group in table.groupby("method", sort=False):
        best = group.sort_values("median_error").iloc[0]
        order, spread = observed_order(group, METHODS[str(name)])
        lines.append(
            {
                "method": name,
                "best setting": f"{best['value']:.0e}" if METHODS[str(name)].setting else "-",
                "median": scientific(best["median_error"]),
                "max": scientific(best["max_error"]),
                "impact times": scientific(best["impact_error"]),
                "energy": scientific(best["energy_drift"]),
                "order": "-" if math.isnan(order) else f"{order:.2f} ± {spread:.2f}",
                "steps": f"{best['steps']:.0f}",
                "time": f"{best['wall_s'] * 1e6:.0f} µs",
                "set-up": f"{best['setup_s'] * 1e6:.0f} µs",
                "failed": int(group["failed"].sum()),
            }
        )
    return pd.DataFrame(lines).to_string(index=False)


def findings(table: pd.DataFrame) -> str:
    """Return the findings in a few sentences, from the numbers."""
    engines = table[table["method"].str.contains("pybullet|mujoco")]
    sentences = []
    for target in TARGETS[:3]:
        good = engines[(engines["failed"] == 0) & (engines["max_error"] <= target)]
        if good.empty:
            sentences.append(f"No engine reaches {target:.0e} on every case.")
            continue
        best = good.sort_values("wall_s").iloc[0]
        sentences.append(
            f"The cheapest engine below {target:.0e} on every case is {best['method']} at "
            f"{best['value']:.0e}: {best['wall_s'] * 1e3:.2g} ms a case, "
            f"{best['real_time_factor']:.0f} times faster than real time."
        )
    exact = table[table["method"] == "Taylor series"].iloc[-1]
    sentences.append(
        f"The exact solution takes {exact['wall_s'] * 1e6:.0f} µs a case to "
        f"{scientific(exact['max_error'])}."
    )
    return " ".join(sentences)
