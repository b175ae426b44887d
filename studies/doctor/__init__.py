"""What is here, and whether it works."""

from studies.old.study import Study

STUDY = Study(
    name="doctor",
    help="""Whether this installation works, in some ten lines to paste into a report.

Versions, where compiled functions are kept, cores, threads and disk; and one block in each engine
that is here, in a process of its own. Exit code 1 when something fails; its line says what to
do.""",
)
