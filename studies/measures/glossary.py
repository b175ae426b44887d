"""What every column of every table means, once; tables of it are made for readers from here."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.measures.columns import ANSWERS, CASES, ESTIMATES, REFERENCE, SUMMARIES, Column

SYMPTOMS = {
    "symptom": Column("", "what a user of an engine sees"),
    "measure": Column("", "column of variants.csv that measures it"),
    "shown_by": Column("", "settings that show it"),
    "before": Column("-", "the measure with these; inf where there is no result"),
    "setting": Column("", "the one setting that helps most; empty where none halves it"),
    "formula": Column("", "lines of an exported script that go (-) and come (+), by its step DT"),
    "literal": Column("", "the same at the step dt_s, B = 0.5 m, H = 1.5 m"),
    "after": Column("-", "the measure with this setting alone"),
    "tuned": Column("-", "the measure with a tuned contact and a fixed step"),
    "landing": Column("-", "the measure with steps that land on impacts"),
    "before_own": Column("-", "before, at the library's own step"),
    "after_own": Column("-", "after, at the library's own step"),
    "asked_in": Column("", "threads of trackers in which it is asked"),
    "command": Column("", "what makes the table that says so"),
}

RESTITUTION = {
    "way": Column("", "how the coefficient of restitution is asked for"),
    "varied": Column("", "what differs from the strike that stands first"),
    "wanted": Column("-", "coefficient of restitution that is asked for"),
    "phase": Column("-", "part of a step after which the corner meets the base"),
    "p_dt": Column("-", "step in units of 1/p"),
    "rate_over_alpha_p": Column("-", "angular rate of a block at its impact, over α p"),
    "kept_ratio": Column("-", "1 - 3/2 (1 + e) sin² α, what the block should keep of its rate"),
    "rate_ratio": Column("-", "angular rate after over before the impact"),
    "corner_ratio": Column(
        "-", "upward speed of the striking corner over that of its approach; nan: it went wrong"
    ),
    "slide_ratio": Column("-", "its speed along the base over that of its approach"),
    "off": Column("-", "largest difference of a ratio after over before from what it should be"),
    "off_p_dt": Column("-", "the same at other steps"),
    "off_rate_over_alpha_p": Column("-", "the same at other rates"),
    "off_height_m": Column("-", "the same at other heights"),
    "off_aspect": Column("-", "the same at another slenderness"),
    "off_over_all": Column("-", "the largest of all these"),
    "slide": Column("-", "largest |slide_ratio|"),
    "broken": Column("#", "strikes that the library did not survive"),
}

VERSIONS = {
    "release": Column("", "version of the engine's package"),
    "moved_cases": Column("#", "peaks that moved by more than 1e-6 from the release before"),
    "turned": Column("#", "outcomes that are others than in the release before"),
    "disk_mib": Column("MiB", "room that the release's environment takes"),
    "presets": Column("", "presets with an answer that changed"),
    "note": Column("", "what the release notes say, of each release in between"),
    "link": Column("", "where they say it"),
}

ADVICE = {
    "target": Column("-", "error of the peak that is to be kept"),
    "dt_s": Column("s", "step for the block of the advice; nan where an engine chooses its own"),
    "random_cases": Column("#", "random cases that were run at this very setting"),
    "random_off": Column("#", "of these, other outcomes, or errors above the target"),
    "random_calm_off": Column("#", "of these, cases with κ and κη below 10"),
    "condition": Column(
        "-",
        "the larger of |κ|, |κη| and 1; of a case that overturns 1, or inf where it would not with "
        "one per cent less or more of the pulse",
    ),
    "extreme_cases": Column(
        "#", "extreme cases where the reference holds; 0 if they were run at another setting"
    ),
    "extreme_off": Column("#", "of these, other outcomes, or errors above the target"),
    "cheapest": Column("?", "whether it is the cheapest of the engine's presets"),
}

METHODS = {
    "method": Column("", "the method of a work-precision diagram"),
    "value": Column("-", "setting of the method: tolerance, p dt or iterations"),
    "own_error": Column("-", "difference of the peak from the method's own finest one"),
    "impact_error": Column("1/p", "largest error of the first impact times"),
    "impact_times": Column("1/p", "times of the first impacts"),
    "energy_drift": Column("-", "largest change of energy between impacts, over its scale"),
    "energy_growth": Column("-", "rise of energy in free rocking, over its largest value"),
    "real_time_factor": Column("-", "length of the pulse over the time it took"),
    "period_error": Column("-", "largest relative error of the time between two impacts"),
    "decay_error": Column("-", "largest relative error of the rotation after an impact"),
    "timed_impacts": Column("#", "impacts whose times were compared"),
    "drift_p": Column("1/p", "drift of the time of the last of them"),
    "swings": Column("#", "swings that were compared"),
    "quantity": Column("", "what was perturbed"),
    "delta": Column("-", "relative size of the perturbation"),
    "exact_change": Column("-", "change of ln(peak) of the exact solution"),
    "change": Column("-", "change of ln(peak)"),
    "growth": Column("-", "|change| over delta"),
    "growth_over_kappa": Column("-", "growth over |κ|"),
    "change_over_exact": Column("-", "|change| over that of the exact solution"),
    "factor": Column("", "setting that differs from the preset"),
    "level": Column("", "what it is set to"),
    "own_step": Column("?", "whether the step is the library's own, not that of all"),
    "trap": Column("", "why a setting goes wrong without a word"),
    "moved": Column("-", "largest relative change of a peak from that of the preset"),
    "ratio_over_eta": Column("-", "velocity ratio at impacts over Housner's η, the median"),
    "ratio_moved": Column("-", "relative change of that from the preset's"),
    "velocity_ratio": Column("-", "velocity after over before an impact, the median"),
    "newton_e": Column("-", "Newton's coefficient that gives this ratio"),
    "worse": Column("?", "failed, or more outcomes wrong than with the preset"),
    "contact_s": Column("1/p", "time that the contact has of its own"),
    "largest_stable": Column("1/p", "largest step that stays stable"),
    "largest_accurate": Column("1/p", "largest step from which on peaks are right to 1 %"),
    "stable_over_contact": Column("-", "largest_stable over contact_s"),
    "accurate_over_contact": Column("-", "largest_accurate over contact_s"),
    "runs": Column("#", "runs of which the time is the best"),
    "scene": Column("", "what was put back into a scene, or left out of the exact solution"),
    "memory_kib": Column("KiB", "memory of a process with the scene"),
    "engine_s": Column("s", "of a step, the engine's own"),
    "adapter_s": Column("s", "of a step, the adapter around it"),
    "pose_s": Column("s", "of a step, reading the pose"),
    "driver": Column("", "who takes one step after the other: Python, or a compiled loop"),
    "look_s": Column("s", "of a step, seeing the pose and choosing the next step"),
    "threads": Column("#", "threads"),
    "seconds": Column("s", "time of all cases"),
    "cases_a_second": Column("1/s", "cases a second"),
    "us_a_case_and_core": Column("µs", "time of a case on one core"),
    "busy": Column("-", "part of the time that the cores of all threads worked"),
    "times_exact": Column("-", "time over that of the exact solution on one thread"),
}

MAPS = {
    "low": Column("onsets", "lower end of an interval"),
    "high": Column("onsets", "upper end of it"),
    "mode": Column("#", "impacts before overturning; -1: it survives"),
    "below": Column("#", "mode below an edge of the map"),
    "above": Column("#", "mode above it"),
    "found": Column("", "how an edge was found: by the grid, its mode or its margin"),
    "other_mode": Column("-", "part of the map overturned after other impacts than exactly"),
    "cells": Column("#", "cells of a coarse grid"),
    "false_from": Column("-", "abscissa below which a twentieth of the false part lies"),
    "false_to": Column("-", "abscissa above which a twentieth of it lies"),
    "missed_from": Column("-", "abscissa below which a twentieth of the missed part lies"),
    "missed_to": Column("-", "abscissa above which a twentieth of it lies"),
    "table": Column("", "the table that a row belongs to"),
    "hint": Column("", "what landing steps are told: true, or false by so much"),
    "still": Column("#", "outcomes that are the exact ones, of pulses too weak to lift the block"),
    "over_kappa": Column("-", "largest |error| over the largest of |κ|, |κη|, sensitivity and 1"),
    "edge": Column("onsets", "amplitude of an exact edge"),
    "overturns": Column("", "above or below the edge"),
    "offset": Column("-", "relative distance from the edge"),
    "shift": Column("-", "threshold of the source over the exact one, less 1"),
    "check": Column("", "what is checked"),
    "against": Column("", "what against"),
    "expected": Column("-", "number expected"),
}

STATISTICS = {
    "capacity": Column("onsets", "median of the fitted overturning intensity"),
    "capacity_low": Column("onsets", "lower bound of it, by resampling motions"),
    "capacity_high": Column("onsets", "upper bound of it"),
    "capacity_ratio": Column("-", "capacity over the exact one of the same cases"),
    "ratio_low": Column("-", "lower bound of it, by resampling motions"),
    "ratio_high": Column("-", "upper bound of it"),
    "capacity_at_edge": Column("?", "whether one lies at an end of the intensities, or beyond"),
    "ratio_at_edge": Column("?", "whether one of either capacity does"),
    "resamples": Column("#", "samples of the motions that the bounds are of"),
    "beta": Column("-", "logarithmic standard deviation of the fitted intensity"),
    "predicted": Column("-", "part of single responses right within 10 %"),
    "ks": Column("-", "largest distance between the distributions of peaks"),
    "ks_p": Column("-", "its p-value by Kolmogorov and Smirnov's test"),
    "ks_tests": Column("#", "intensities tested"),
    "ks_rejected": Column("#", "of these with p < 0.05"),
    "mcnemar_p": Column("-", "p-value of as many overturnings too many as too few"),
    "overturned": Column("#", "motions that overturn"),
    "share": Column("-", "part of the motions that overturn"),
    "share_low": Column("-", "lower bound of it"),
    "share_high": Column("-", "upper bound of it"),
    "median_peak": Column("-", "median of peak_ratio"),
    "probability": Column("-", "fitted probability of overturning"),
}

PRINTS = {
    "problem": Column("", "what was printed, in a word"),
    "side": Column("#", "0 for the first number, 1 for the other side, or a rate beside a time"),
    "of": Column("", "whose number is printed: a theory's, or a test's, which is a measurement"),
    "why": Column("", "why a print does not come out"),
    "work": Column("", "who printed it"),
    "where": Column("", "the place in the work, or what it says of the block"),
    "printed": Column("", "the print, digit by digit; a bracket of two"),
    "measured": Column("", "what an experiment beside it measured"),
    "other_side": Column("-", "the answer for the other side"),
    "miss": Column("-", "how far outside the print's digits, relative; 0 inside"),
    "from_exact": Column("-", "relative difference from the exact solution"),
}

STEADY = {
    "larger_ratio": Column("-", "largest steady rotation over θcr, on its larger side"),
    "smaller_ratio": Column("-", "the same on the other side"),
    "period": Column("#", "forcing periods after which the response repeats; 0 if it does not"),
    "starts": Column("#", "starts of the grid that end there; 0: followed from the next point"),
    "start_share": Column("-", "part of the grid's starts that end there"),
    "larger_exact": Column("-", "larger_ratio of the exact orbit on which an engine starts"),
    "smaller_exact": Column("-", "smaller_ratio of that orbit"),
    "period_exact": Column("#", "period of that orbit"),
}

SCENE = Column("", "frame: a beam on columns; slide: a block that slides; floor, block: on a floor")
FREQUENCY = Column("-", "frequency of the motion over the block's p")

BY_TABLE = {
    "ensemble/curves": {
        "low": Column("-", "lower bound of the probability"),
        "high": Column("-", "upper bound of it"),
    },
    "estimate/estimates": {
        "set": Column("", "calibrate (the factors come from these cases), or test")
    },
    "harmonic/engines": {"x": FREQUENCY},
    "harmonic/harmonic": {"x": FREQUENCY},
    "literature/agreement": {
        "quantity": Column("", "what was printed, with its unit"),
        "value": Column("-", "the answer to the print, in the unit of quantity"),
        "low": Column("-", "lower end of the print, in the unit of quantity"),
        "high": Column("-", "upper end of it"),
        "agrees": Column("?", "whether the answer lies within the print's digits"),
    },
    "literature/literature": {"value": Column("-", "the answer to the print, in its unit")},
    "overturning/checks": {"found": Column("-", "number found")},
    "overturning/differences": {
        "false": Column("-", "part of the map that overturns falsely"),
        "missed": Column("-", "part of the map in which overturning is missed"),
    },
    "overturning/thresholds": {"runs": Column("#", "runs that the search took")},
    "precision/shares": {"step_s": Column("s", "time of one step, the whole of it")},
    "precision/work-precision": {
        "max_error": Column("-", "largest |error|; inf where an outcome is wrong"),
        "steps": Column("-", "steps of the integrator or engine, the mean of the cases"),
    },
    "scenes/block": {
        "scene": SCENE,
        "own_error": Column("-", "peak over own_exact, less 1"),
    },
    "scenes/floor": {"scene": SCENE},
    "scenes/frame": {
        "scene": SCENE,
        "phase": Column("#", "number of the step tried; with each an impact falls elsewhere in it"),
        "right": Column("?", "whether the outcome is the exact one"),
        "tilt": Column("-", "largest rotation of the beam"),
    },
    "scenes/frame-summary": {"tilt": Column("-", "largest rotation of the beam")},
    "scenes/slide": {"scene": SCENE},
    "stability/stability": {"reason": Column("", "why the verdict, with the numbers")},
    "stability/steps": {
        "factor": Column("-", "factor between two steps"),
        "runs": Column("#", "runs that the search took"),
    },
    "steps/random": {
        "error": Column(
            "-",
            "size of the peak's error; 0 where both overturn or stay at rest, inf where the "
            "outcome is another",
        )
    },
    "throughput/throughput": {"steps": Column("-", "steps of a case, the mean")},
    "validate/drawn": {
        "set": Column(
            "", "drawn: all; kept; left out near the limit, or as a pivot would be lifted"
        ),
        "overturned": Column("#", "cases that overturn"),
        "share": Column("-", "part of the cases that overturn"),
        "why": Column("", "why cases are left out"),
    },
    "validity/compared": {"verdict": Column("", "what the pivot did")},
    "validity/validity": {"verdict": Column("", "what the pivot did")},
    "versions/changes": {
        "before": Column("", "the release before"),
        "moved": Column("-", "largest relative change of a peak from the release before"),
    },
    "versions/releases": {
        "set": Column("", "figure 8 of the paper, or random"),
        "moved": Column("-", "largest relative change of a peak from the release before"),
        "setup_s": Column("s", "time to make the environment"),
    },
}
"""Study and table -> the columns that mean something else there."""

PARTS = (
    *(CASES, ANSWERS, REFERENCE, SUMMARIES, ESTIMATES, SYMPTOMS, RESTITUTION, VERSIONS, ADVICE),
    *(METHODS, MAPS, STATISTICS, PRINTS, STEADY),
)

COLUMNS = {name: column for part in PARTS for name, column in part.items()}
"""Name -> unit and meaning, but for what means something else in one table."""


def column_of(table: str, name: str) -> Column:
    """Return what a column of a table, called as its study's folder and file, means there."""
    return BY_TABLE.get(table, {}).get(name) or COLUMNS[name]


def dictionary(published: Path) -> pd.DataFrame:
    """Return a line for each column of every published table: its type, unit and meaning."""
    lines = [
        (f"{path.parent.name}/{path.name}", name, *column_of(table, str(name)).told)
        for path in sorted(published.glob("*/*.csv*"))
        for table in [f"{path.parent.name}/{path.name.partition('.')[0]}"]
        for name in pd.read_csv(path, nrows=0)
    ]
    return pd.DataFrame(lines, columns=["table", "column", "type", "unit", "meaning"])
