"""A scene written out for an engine alone."""

from studies.old.study import Study

STUDY = Study(
    name="export",
    help="""A script that needs an engine's library alone: block, shaking, settings, expected peak.

For presets with equal steps. It is Python, with the model beside it where the library has a format
for one, and the ground motion; it says whether it found the peak that this project finds.""",
)
