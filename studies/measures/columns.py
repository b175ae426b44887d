"""What the columns mean that tables of several studies have."""

from typing import NamedTuple

from studies.measures.wrongness import MEANINGS, WORDS


class Column(NamedTuple):
    """The unit of a column and its meaning.

    The unit is empty for text, "?" for what is True or False, "#" for a whole number that counts,
    "-" for any other number without one.
    """

    unit: str
    meaning: str

    @property
    def told(self) -> tuple[str, str, str]:
        """Type (text, boolean, integer or number), unit and meaning, as a reader is told them."""
        kind = {"": "text", "?": "boolean", "#": "integer"}.get(self.unit, "number")
        return kind, self.unit.strip("?#"), self.meaning


CASES = {
    "figure": Column("", "figure of the paper; all: all of them together"),
    "panel": Column("", "panel of a figure of the paper"),
    "pulse": Column("", "half-sine or full-sine"),
    "half_cycles": Column("#", "half cycles of the pulse"),
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
    "tilt": Column("-", "rotation from which the block falls, over θcr"),
    "columns": Column("#", "columns of the frame"),
    "load": Column("-", "mass of its beam over that of all columns"),
    "omega": Column("rad/s", "frequency of the pulse"),
    "case": Column("", "number or name of the case"),
    "set": Column("", "which cases: typical, or near overturning"),
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
    "frames": Column("#", "frames that were asked about"),
    "largest_error": Column("-", "the largest error of the peak"),
    "beyond_2_percent": Column("#", "frames whose peak is off by more than 2 %"),
    "ms_a_frame": Column("ms", "mean time of a frame"),
    "slides": Column("#", "slides that were asked about"),
    "slips": Column("#", "slips that were seen"),
    "exact_slips": Column("#", "slips of the exact solution"),
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
    "blocks": Column("#", "blocks that were asked about"),
    "place_m": Column("m", "where a block ended, relative to its base"),
    "lift_m": Column("m", "how high a block that slides was seen above where it rests"),
    "turn_rad": Column("rad", "how far it was seen to turn"),
    "ms_a_slide": Column("ms", "mean time of a slide"),
    "outcome": Column("", "at rest, rocked, overturned, failed; left: it slid or flew away"),
    "peak_ratio": Column("-", "largest |θ|/θcr; 0 at rest, inf when overturned, nan when failed"),
    "impacts": Column("#", "impacts until the peak was decided"),
    "steps": Column("#", "steps of the integrator or engine"),
    "wall_s": Column("s", "time of the steps alone"),
    "setup_s": Column("s", "time before the first step"),
    "step_s": Column("s", "time of one step"),
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
    "agrees": Column("?", "whether the outcome is the exact one; else it is wrong"),
    "error": Column("-", "peak over the exact one, less 1; nan unless both rocked"),
    "difference": Column("-", "peak_ratio less the exact one"),
    "false_overturning": Column("?", "overturned, and the exact solution survives"),
    "missed_overturning": Column("?", "survived, and the exact solution overturns"),
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
    "verdict": Column("", "what an answer is worth"),
    "reason": Column("", "what kind of failure an answer is, if it is one"),
    "failure": Column("", "kind of failure, where there is no result (analytic.response.Reason)"),
    "remedy": Column("", "first setting of those tried that avoids a failure"),
}

SUMMARIES = {
    "cases": Column("#", "cases"),
    "failed": Column("#", "cases without a usable result"),
    "wrong": Column("#", "outcomes that are not the exact ones, those without an answer apart"),
    **{kind: Column("#", f"how many: {name} ({MEANINGS[kind]})") for kind, name in WORDS.items()},
    "right": Column("#", "outcomes that are the exact ones"),
    "close": Column("#", "of these, peaks within a tenth, and overturnings"),
    "far": Column("#", "of these, peaks off by more than a tenth"),
    "agree": Column("#", "outcomes that are the exact ones"),
    "false": Column("#", "false overturnings"),
    "missed": Column("#", "missed overturnings"),
    "false_overturnings": Column("#", "how many"),
    "missed_overturnings": Column("#", "how many"),
    "survivors": Column("#", "cases that survive in both"),
    "median_error": Column("-", "median of |error|"),
    "p90_error": Column("-", "nine tenths of |error| are below"),
    "max_error": Column("-", "largest |error|"),
    "rms_error": Column("-", "root of the mean square of the error"),
    "rms_difference": Column("-", "root of the mean square of the difference"),
    "max_difference": Column("-", "largest |difference|"),
    "max_error_over_kappa": Column(
        "-", "largest |error| over the largest of |κ|, |κη|, sensitivity and 1"
    ),
    "statement": Column("", "a statement of the paper, or about its cases"),
    "holds": Column("?", "whether it holds; nan: a source was not asked"),
    "numbers": Column("", "the numbers that say so"),
    "title": Column("", "the linearization in words"),
    "changed": Column("", "onset, frequency, saddle: 1 where not Housner's"),
    "by": Column("", "what the cases are divided by: the exact peak over θcr, or κ"),
    "band": Column("", "between which values of it"),
    "quantile": Column("-", "part of the cases whose |error| is below"),
}

ESTIMATES = {
    "half": Column("#", "1 for the run at half the step, 0 for that at the step itself"),
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
    "told": Column("#", "wrong outcomes with another one at half the step"),
    "tested": Column("#", "other cases that survive, on which factor_95_high is tried"),
    "bounded": Column("#", "of these, errors that factor_95_high bounds"),
}
