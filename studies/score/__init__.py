"""One engine, on one page: outcomes, errors and time, extreme cases, what it is helped by."""

from studies.kit.study import Study

STUDY = Study(
    name="score",
    help="""One engine on one page, registered or at MODULE:ENGINE or MODULE:build.

The paper's cases with each of its presets, its errors along the step beside the published
engines, its verdicts on extreme cases, what it is helped by, and whether its velocities hold at the
`Moment` that its world declares; slides, and frames where it declares that it holds several bodies.
Writes score-sweep.csv, score-steps.csv, score-extremes.csv, score-moments.csv, score-frame.csv,
score-slide.csv, score.txt, two figures and provenance.json; resumable.""",
    table="score-sweep.csv",
    tables=(
        *("score-sweep.csv", "score-steps.csv", "score-extremes.csv", "score-moments.csv"),
        *("score-frame.csv", "score-slide.csv"),
    ),
    others=("score.txt",),
    captions={
        "score": "The engine's presets along their steps, largest error against run time; grey "
        "behind them the published engines.",
        "extremes": "Extreme cases, a column for each preset: what its answer is worth.",
    },
)
