"""The paper's sensitivity analysis, figures 6 to 9."""

from studies.kit.study import Chapter, Study

PULSES = {6: "half-sine", 7: "half-sine", 8: "full-sine", 9: "full-sine"}
"""Figure of the paper -> its pulses."""

STUDY = Study(
    name="sweep",
    help="""The paper's sensitivity analysis, figures 6 to 9.

240 cases a figure, which are 120 problems in two sizes that similarity makes alike, through every
named source. Finished cases are stored at once: a run that was interrupted goes on where it stopped
when the same command is given again.""",
    tables=("sweep.csv", "summary.csv", "findings.csv"),
    chapters=(
        Chapter(
            question="Do the engines and the linearizations get the paper's cases right?",
            tables=("summary.csv",),
            quick=("--accuracy", "loose"),
            minutes=(0.1, 0.6),
            weaker=(
                "The engines step at the accuracy loose instead of standard, and err more for it."
            ),
        ),
        Chapter(
            folder="presets",
            question="And engines as they come, or tuned at a fixed step?",
            tables=("summary.csv",),
            quick=("--figure", "8", "--sources", "exact", "core:naive"),
            full=(
                *("--sources", "exact", "engines:naive", "engines:naive-base-at-rest"),
                *("engines:recommended", "engines:fixed", "engines"),
            ),
            minutes=(0.1, 35.0),
            weaker=(
                "Figure 8 stands for all four, and no preset with a tuned contact and a fixed "
                "step is asked."
            ),
        ),
    ),
    captions={
        "overview": (
            "For each engine and preset the error of the peak from its median to the largest, how "
            "many outcomes are wrong, and the run time of a case."
        ),
        **{
            f"figure-{number}": f"The same for the {pulse} pulses of figure {number}."
            for number, pulse in PULSES.items()
        },
        "figure-6": (
            "The largest rotation over the frequency of the half-sine pulses of figure 6, who "
            "overturns (band), and below the error; a column for each H/B."
        ),
        **{
            f"presets-{number}": f"The same for the {pulse} pulses of figure {number}."
            for number, pulse in PULSES.items()
        },
        "presets-6": (
            "Error of the peak over the frequency of the half-sine pulses of figure 6 as colour; "
            "in red the fall wrong (square), at rest for rocked (dash), no answer (cross)."
        ),
    },
)
