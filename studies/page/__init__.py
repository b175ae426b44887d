"""Every study on one page."""

from studies.old.study import Study

REPORT = Study(
    name="report",
    module="studies.page.report",
    help="""Every study, and one self-contained page (report.html) about them.

The quick studies take some six minutes on two cores, the full ones two and a half hours. A report
that was interrupted goes on where it stopped when the same command is given again.""",
)
README = Study(
    name="readme",
    module="studies.page.readme",
    help="Write README.md and the pages of the published results from their tables.",
)
