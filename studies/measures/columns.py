"""What every column of every table means, once; tables of it are made for readers from here."""

from typing import NamedTuple

from studies.measures.wrongness import MEANINGS, WORDS


class Column(NamedTuple):
    """The unit of a column, empty for words, "-" for numbers without one, and its meaning."""

    unit: str
    meaning: str


CASES = {
    "figure": Column("", "figure of the paper; all: all of them together"),
    "panel": Column("", "panel of a figure of the paper"),
    "pulse": Column("", "half-sine or full-sine"),
    "half_cycles": Column("-", "half cycles of the pulse"),
    "excess_g": Column("g", "amplitude of the pulse above B/H"),
    "amplitude_g": Column("g", "amplitude of the pulse"),
    "omega_over_p": Column("-", "frequency of the pulse over the block's p"),
    "onsets": Column("-", "amplitude over the onset, g tan α"),
    "intensity": Column("-", "largest acceleration of a motion over g tan α"),
    "strength": Column("-", "factor of the motion: 1, or 1.01 for the motion 1 % stronger"),
    "family": Column("", "kind of motion: noise, pulses, the user's records"),
    "motion": Column("", "number or name of the motion"),
    "aspect": Column("-", "H/B"),
    "width_m": Column("m", "B"),
    "height_m": Column("m", "H"),
    "alpha": Column("rad", "atan(B/H), the critical rotation θcr"),
    "tilt": Column(
        "-", "rotation from which the block falls, over θcr; of a frame the beam's largest"
    ),
    "columns": Column("-", "columns of the frame"),
    "load": Column("-", "mass of its beam over that of all columns"),
    "omega": Column("rad/s", "frequency of the pulse"),
    "case": Column("", "number or name of the case"),
    "set": Column(
        "",
        "typical, or near overturning; in releases.csv figure 8, or random; in drawn.csv all that "
        "were drawn, kept, left out near the limit, or with a pivot that lifts; in estimates.csv "
        "calibrate (the factors come from these cases), or test",
    ),
    "group": Column("", "what is extreme in the case"),
    "grid": Column("", "the paper's grid, or a wider one"),
    "x": Column("-", "abscissa of an overturning map: ω/p, slenderness or size"),
    "friction_factor": Column(
        "-", "friction given over the friction needed; nan: the preset's own"
    ),
}

ANSWERS = {
    "source": Column("", "who answered: a model, solver, or engine with its preset"),
    "model": Column("", "the model of an overturning map"),
    "engine": Column("", "the engine"),
    "preset": Column("", "naive: as documented; naive-base-at-rest; fixed; landing"),
    "exact": Column("-", "peak of the exact solution"),
    "parting": Column("-", "largest difference of two columns' rotations, over θcr"),
    "drift_m": Column("m", "how far the beam slid on the columns"),
    "frames": Column("-", "frames that were asked about"),
    "largest_error": Column("-", "the largest error of the peak"),
    "beyond_2_percent": Column("-", "frames whose peak is off by more than 2 %"),
    "ms_a_frame": Column("ms", "mean time of a frame"),
    "slides": Column("-", "slides that were asked about"),
    "slips": Column("-", "slips that were seen"),
    "exact_slips": Column("-", "slips of the exact solution"),
    "slip_error_m": Column("m", "largest error of a slip; of a block that is held, its creep"),
    "largest_slip_error_m": Column("m", "the largest of them"),
    "creep_m": Column("m", "how far a block crept at nine tenths of its friction"),
    "floor": Column("", "how a floor that moves is moved"),
    "rest_s": Column("s", "for how long all is at rest before the motion"),
    "carried": Column("-", "way over which a floor carries a block, over its own"),
    "carried_after_rest": Column("-", "the same after a second of rest"),
    "floor_lag_m": Column("m", "how far a moving floor was from where it should be, at most"),
    "own_exact": Column("-", "exact peak on the floor as the engine moved it"),
    "median_own_error": Column("-", "the median of own_error"),
    "blocks": Column("-", "blocks that were asked about"),
    "place_m": Column("m", "where a block ended, relative to its base"),
    "lift_m": Column("m", "how high a block that slides was seen above where it rests"),
    "turn_rad": Column("rad", "how far it was seen to turn"),
    "ms_a_slide": Column("ms", "mean time of a slide"),
    "outcome": Column("", "at rest, rocked, overturned, failed; left: it slid or flew away"),
    "peak_ratio": Column("-", "largest |θ|/θcr; 0 at rest, inf when overturned, nan when failed"),
    "impacts": Column("-", "impacts until the peak was decided"),
    "steps": Column("-", "steps of the integrator or engine"),
    "wall_s": Column("s", "time of the steps alone"),
    "setup_s": Column("s", "time before the first step; in releases.csv to make an environment"),
    "step_s": Column("s", "time of one step; in shares.csv the whole of it"),
    "message": Column("", "why a row failed, or what should be known about it"),
    "time_s": Column("s", "time on the ground's clock"),
    "ground_g": Column("g", "acceleration of the ground"),
    "theta_ratio": Column("-", "θ/θcr"),
    "velocity_rad_s": Column("rad/s", "angular velocity"),
    "slip_widths": Column("-", "largest slide of the pivot over B"),
    "sink_widths": Column("-", "largest depth of a corner in the base over B"),
    "hop_widths": Column("-", "largest height of the pivot above the base over B"),
    "friction": Column("-", "coefficient of friction that the source used"),
}

REFERENCE = {
    "exact_outcome": Column("", "outcome of the exact solution"),
    "exact_peak": Column("-", "largest |θ|/θcr of the exact solution"),
    "agrees": Column("", "whether the outcome is the exact one; else it is wrong"),
    "error": Column(
        "-",
        "peak over the exact one, less 1; nan unless both rocked; in random.csv its size, 0 where "
        "both overturn or stay at rest, inf where the outcome is another",
    ),
    "difference": Column("-", "peak_ratio less the exact one"),
    "false_overturning": Column("", "overturned, and the exact solution survives"),
    "missed_overturning": Column("", "survived, and the exact solution overturns"),
    "kappa": Column("-", "κ = ∂ln θmax/∂ln a_p of the exact solution"),
    "kappa_eta": Column("-", "κη = ∂ln θmax/∂ln η of the exact solution"),
    "sensitivity": Column(
        "-",
        "largest relative change of the exact peak over that of a_p or η, when one of these moves "
        "by ±1e-4 or ±1e-6; inf where that changes the outcome",
    ),
    "min_normal": Column(
        "-", "least normal force over the weight in the exact solution, before its fall"
    ),
    "friction_needed": Column(
        "-", "friction that the exact solution needs not to slide, before its fall"
    ),
    "invalid": Column("", "why the reference does not hold here; empty where it does"),
    "verdict": Column("", "what an answer is worth, or what the pivot did"),
    "reason": Column("", "why, with the numbers"),
    "failure": Column("", "kind of failure, where there is no result (analytic.response.Reason)"),
    "remedy": Column("", "first setting of those tried that avoids a failure"),
}

SUMMARIES = {
    "cases": Column("-", "cases"),
    "failed": Column("-", "cases without a usable result"),
    "wrong": Column("-", "outcomes that are not the exact ones, those without an answer apart"),
    **{kind: Column("-", f"how many: {name} ({MEANINGS[kind]})") for kind, name in WORDS.items()},
    "right": Column("-", "outcomes that are the exact ones"),
    "close": Column("-", "of these, peaks within a tenth, and overturnings"),
    "far": Column("-", "of these, peaks off by more than a tenth"),
    "agree": Column("-", "outcomes that are the exact ones"),
    "false": Column("-", "false overturnings; in differences.csv their part of the map"),
    "missed": Column("-", "missed overturnings; in differences.csv their part of the map"),
    "false_overturnings": Column("-", "how many"),
    "missed_overturnings": Column("-", "how many"),
    "survivors": Column("-", "cases that survive in both"),
    "median_error": Column("-", "median of |error|"),
    "p90_error": Column("-", "nine tenths of |error| are below"),
    "max_error": Column("-", "largest |error|; inf where an outcome is wrong (work-precision.csv)"),
    "rms_error": Column("-", "root of the mean square of the error"),
    "rms_difference": Column("-", "root of the mean square of the difference"),
    "max_difference": Column("-", "largest |difference|"),
    "max_error_over_kappa": Column(
        "-", "largest |error| over the largest of |κ|, |κη|, sensitivity and 1"
    ),
    "statement": Column("", "a statement of the paper, or about its cases"),
    "holds": Column("", "whether it holds; nan: a source was not asked"),
    "numbers": Column("", "the numbers that say so"),
    "title": Column("", "the linearization in words"),
    "changed": Column("", "onset, frequency, saddle: 1 where not Housner's"),
    "by": Column("", "what the cases are divided by: the exact peak over θcr, or κ"),
    "band": Column("", "between which values of it"),
    "quantile": Column("-", "part of the cases whose |error| is below"),
}

ESTIMATES = {
    "half": Column("-", "1 for the run at half the step"),
    "estimate": Column("-", "relative difference of the peak from that at half the step"),
    "bound": Column("-", "the estimate times its published factor_95_high; nan: no bound"),
    "over": Column("-", "|error| over the estimate; 0 where the error is below 1e-9"),
    "median_estimate": Column("-", "median of the estimates"),
    "factor_50": Column("-", "factor on the estimates that bounds half of the errors"),
    "factor_95": Column("-", "factor on the estimates that bounds 95 % of the errors"),
    "factor_95_low": Column("-", "lower end of its 95 % interval"),
    "factor_95_high": Column("-", "upper end of it, which is used; inf: too few cases"),
    "factor_all": Column("-", "factor on the estimates that bounds all errors"),
    "within_3": Column("-", "part of the errors that three estimates bound"),
    "within_10": Column("-", "part of the errors that ten estimates bound"),
    "told": Column("-", "wrong outcomes with another one at half the step"),
    "tested": Column("-", "other cases that survive, on which factor_95_high is tried"),
    "bounded": Column("-", "of these, errors that factor_95_high bounds"),
}

SYMPTOMS = {
    "symptom": Column("", "what a user of an engine sees"),
    "measure": Column("", "column of variants.csv that measures it"),
    "shown_by": Column("", "settings that show it"),
    "before": Column(
        "-", "the measure with these; inf where there is no result; in changes.csv a release"
    ),
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
    "broken": Column("-", "strikes that the library did not survive"),
}

VERSIONS = {
    "release": Column("", "version of the engine's package"),
    "moved_cases": Column("-", "peaks that moved by more than 1e-6 from the release before"),
    "turned": Column("-", "outcomes that are others than in the release before"),
    "disk_mib": Column("MiB", "room that the release's environment takes"),
    "presets": Column("", "presets with an answer that changed"),
    "note": Column("", "what the release notes say, of each release in between"),
    "link": Column("", "where they say it"),
}

ADVICE = {
    "target": Column("-", "error of the peak that is to be kept"),
    "dt_s": Column("s", "step for the block of the advice; nan where an engine chooses its own"),
    "random_cases": Column("-", "random cases that were run at this very setting"),
    "random_off": Column("-", "of these, other outcomes, or errors above the target"),
    "random_calm_off": Column("-", "of these, cases with κ and κη below 10"),
    "condition": Column(
        "-",
        "the larger of |κ|, |κη| and 1; of a case that overturns 1, or inf where it would not with "
        "one per cent less or more of the pulse",
    ),
    "extreme_cases": Column(
        "-", "extreme cases where the reference holds; 0 if they were run at another setting"
    ),
    "extreme_off": Column("-", "of these, other outcomes, or errors above the target"),
    "cheapest": Column("", "whether it is the cheapest of the engine's presets"),
}

METHODS = {
    "method": Column("", "the method of a work-precision diagram"),
    "value": Column(
        "-", "of a method, its setting: tolerance, p dt or iterations; of a print, the answer to it"
    ),
    "own_error": Column(
        "-",
        "difference of the peak from the method's own finest one; of a block on a floor that "
        "moves from own_exact",
    ),
    "impact_error": Column("1/p", "largest error of the first impact times"),
    "impact_times": Column("1/p", "times of the first impacts"),
    "energy_drift": Column("-", "largest change of energy between impacts, over its scale"),
    "energy_growth": Column("-", "rise of energy in free rocking, over its largest value"),
    "real_time_factor": Column("-", "length of the pulse over the time it took"),
    "period_error": Column("-", "largest relative error of the time between two impacts"),
    "decay_error": Column("-", "largest relative error of the rotation after an impact"),
    "timed_impacts": Column("-", "impacts whose times were compared"),
    "drift_p": Column("1/p", "drift of the time of the last of them"),
    "swings": Column("-", "swings that were compared"),
    "quantity": Column("", "what was perturbed; of a print, what was printed, with its unit"),
    "delta": Column("-", "relative size of the perturbation"),
    "exact_change": Column("-", "change of ln(peak) of the exact solution"),
    "change": Column("-", "change of ln(peak)"),
    "growth": Column("-", "|change| over delta"),
    "growth_over_kappa": Column("-", "growth over |κ|"),
    "change_over_exact": Column("-", "|change| over that of the exact solution"),
    "factor": Column("", "setting that differs from the preset; in steps.csv between two steps"),
    "level": Column("", "what it is set to"),
    "own_step": Column("", "whether the step is the library's own, not that of all"),
    "trap": Column("", "why a setting goes wrong without a word"),
    "moved": Column(
        "-", "largest relative change of a peak of the preset; in releases.csv from the one before"
    ),
    "ratio_over_eta": Column("-", "velocity ratio at impacts over Housner's η, the median"),
    "ratio_moved": Column("-", "relative change of that from the preset's"),
    "velocity_ratio": Column("-", "velocity after over before an impact, the median"),
    "newton_e": Column("-", "Newton's coefficient that gives this ratio"),
    "worse": Column("", "failed, or more outcomes wrong than with the preset"),
    "contact_s": Column("1/p", "time that the contact has of its own"),
    "largest_stable": Column("1/p", "largest step that stays stable"),
    "largest_accurate": Column("1/p", "largest step from which on peaks are right to 1 %"),
    "stable_over_contact": Column("-", "largest_stable over contact_s"),
    "accurate_over_contact": Column("-", "largest_accurate over contact_s"),
    "runs": Column("-", "runs that a search took; of a time, runs of which it is the best"),
    "scene": Column(
        "",
        "what was put back into a scene, or left out of the exact solution; or frame (a beam on "
        "columns), slide (a block that slides), floor (a block on a floor that moves)",
    ),
    "memory_kib": Column("KiB", "memory of a process with the scene"),
    "engine_s": Column("s", "of a step, the engine's own"),
    "adapter_s": Column("s", "of a step, the adapter around it"),
    "pose_s": Column("s", "of a step, reading the pose"),
    "driver": Column("", "who takes one step after the other: Python, or a compiled loop"),
    "look_s": Column("s", "of a step, seeing the pose and choosing the next step"),
    "threads": Column("-", "threads"),
    "seconds": Column("s", "time of all cases"),
    "cases_a_second": Column("1/s", "cases a second"),
    "us_a_case_and_core": Column("µs", "time of a case on one core"),
    "busy": Column("-", "part of the time that the cores of all threads worked"),
    "times_exact": Column("-", "time over that of the exact solution on one thread"),
}

MAPS = {
    "low": Column("onsets", "lower end of an interval; in curves.csv of a probability"),
    "high": Column("onsets", "upper end of it"),
    "mode": Column("-", "impacts before overturning; -1: it survives"),
    "below": Column("-", "mode below an edge of the map"),
    "above": Column("-", "mode above it"),
    "found": Column("", "how an edge was found; in checks.csv the number found"),
    "other_mode": Column("-", "part of the map overturned after other impacts than exactly"),
    "cells": Column("-", "cells of a coarse grid"),
    "false_from": Column("-", "abscissa below which a twentieth of the false part lies"),
    "false_to": Column("-", "abscissa above which a twentieth of it lies"),
    "missed_from": Column("-", "abscissa below which a twentieth of the missed part lies"),
    "missed_to": Column("-", "abscissa above which a twentieth of it lies"),
    "table": Column("", "the table that a row belongs to"),
    "hint": Column("", "what landing steps are told: true, or false by so much"),
    "still": Column("-", "outcomes that are the exact ones, of pulses too weak to lift the block"),
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
    "capacity_at_edge": Column("-", "whether one lies at an end of the intensities, or beyond"),
    "ratio_at_edge": Column("-", "whether one of either capacity does"),
    "resamples": Column("-", "samples of the motions that the bounds are of"),
    "beta": Column("-", "logarithmic standard deviation of the fitted intensity"),
    "predicted": Column("-", "part of single responses right within 10 %"),
    "ks": Column("-", "largest distance between the distributions of peaks"),
    "ks_p": Column("-", "its p-value by Kolmogorov and Smirnov's test"),
    "ks_tests": Column("-", "intensities tested"),
    "ks_rejected": Column("-", "of these with p < 0.05"),
    "mcnemar_p": Column("-", "p-value of as many overturnings too many as too few"),
    "overturned": Column("-", "motions that overturn; in drawn.csv cases"),
    "share": Column("-", "part of the motions, or of the cases, that overturn"),
    "share_low": Column("-", "lower bound of it"),
    "share_high": Column("-", "upper bound of it"),
    "median_peak": Column("-", "median of peak_ratio"),
    "probability": Column("-", "fitted probability of overturning"),
}

PRINTS = {
    "problem": Column("", "what was printed, in a word"),
    "side": Column("-", "0 for the first number, 1 for the other side, or a rate beside a time"),
    "of": Column("", "theory, or test: a measurement"),
    "why": Column("", "why a print does not come out; in drawn.csv why cases are left out"),
    "work": Column("", "who printed it"),
    "where": Column("", "the place in the work, or what it says of the block"),
    "printed": Column("", "the print, digit by digit; a bracket of two"),
    "measured": Column("", "what an experiment beside it measured"),
    "other_side": Column("", "the answer for the other side"),
    "miss": Column("-", "how far outside the print's digits, relative; 0 inside"),
    "from_exact": Column("-", "relative difference from the exact solution"),
}

STEADY = {
    "larger_ratio": Column("-", "largest steady rotation over θcr, on its larger side"),
    "smaller_ratio": Column("-", "the same on the other side"),
    "period": Column("-", "forcing periods after which the response repeats; 0 if it does not"),
    "starts": Column("-", "starts of the grid that end there; 0: followed from the next point"),
    "start_share": Column("-", "part of the grid's starts that end there"),
    "larger_exact": Column("-", "larger_ratio of the exact orbit on which an engine starts"),
    "smaller_exact": Column("-", "smaller_ratio of that orbit"),
    "period_exact": Column("-", "period of that orbit"),
}

GROUPS = {
    "Cases": CASES,
    "Answers": ANSWERS,
    "Beside the exact solution": REFERENCE,
    "Summaries": SUMMARIES,
    "Estimates": ESTIMATES,
    "Symptoms": SYMPTOMS,
    "Restitution": RESTITUTION,
    "Versions": VERSIONS,
    "Advice": ADVICE,
    "Methods and settings": METHODS,
    "Maps": MAPS,
    "Statistics": STATISTICS,
    "Printed numbers": PRINTS,
    "Steady states": STEADY,
}
"""Heading -> the columns under it."""

COLUMNS = {name: column for group in GROUPS.values() for name, column in group.items()}
"""Name -> unit and meaning."""
