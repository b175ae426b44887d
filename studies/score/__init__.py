"""One engine, on one page: outcomes, errors and time, extreme cases, what it is helped by."""

from studies.old.study import Study

STUDY = Study(
    name="score",
    help="""One engine on one page, by ENGINE or ENGINE:PRESET, MODULE:ENGINE or MODULE:build.

The paper's cases with each of its presets, its errors along the step beside the published engines,
its verdicts on extreme cases, what it is helped by, and whether its velocities hold at the `Moment`
that its world declares; slides, and frames where it declares that it holds several bodies. With a
requirement or an earlier result, the exit code is 1 where a requirement falls short, and 0 whatever
else failed; it is 1 where the engine's world declares another `Moment` than the one at which its
velocities hold, or where an error that does not shrink with the step tells of a wrong inertia, size
or gravity. Resumable.""",
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
