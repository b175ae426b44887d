"""What each engine answered in the releases before the one that is pinned."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="versions",
    help="""What each engine answers in its other releases, and what changed between them.

The 240 cases of the paper's figure 8 and the first 50 random ones, by every preset, in each release
that runs on this Python; changes of a peak above 1e-6 are marked, beside what the release notes say
of them. Each release but the installed one, which is always among them, is fetched into an
environment of its own, with the engine alone in it (10 s and 2 to 300 MB; numpy and all else are
shared), and gets a folder of its own for its rows (one to four minutes, half of one with --quick);
what is there is not made again, and can be named without a network.""",
    tables=("releases.csv", "changes.csv", "answers.csv"),
    texts=("release", "before", "source", "set", "note", "link"),
    claims=("releases", "changes"),
    drawings={"versions": ("draw_versions", "releases", "changes")},
    captions={
        "versions": (
            "Median (line) and largest error (points) of each preset by release, a panel for each "
            "engine; a grey line stands where an answer moved by more than 1e-6."
        ),
    },
    chapter=Chapter(
        question="Does the release of an engine matter?",
        tables=("changes.csv",),
        quick=("--quick",),
        full=(
            *("--releases", "minor", "--quick"),
            *("--engines", "mujoco", "pybullet", "pymunk", "box2d", "dart", "rapier"),
        ),
        minutes=(0.3, 20.0),
        weaker="The releases that are installed, and no others.",
    ),
)
