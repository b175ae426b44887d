"""The list of the studies; nothing else names them all."""

from studies import (
    advise,
    animate,
    blocks,
    compare,
    contact,
    defaults,
    doctor,
    estimate,
    export,
    histories,
    linearizations,
    overturning,
    precision,
    restitution,
    scenes,
    score,
    stability,
    sweep,
    symptoms,
    validate,
    validity,
)
from studies.old.study import Chapter, Study

STUDIES: tuple[Study, ...] = (
    *(advise.STUDY, compare.STUDY, blocks.STUDY, animate.STUDY, export.STUDY, sweep.STUDY),
    *(defaults.STUDY, histories.STUDY, linearizations.STUDY, scenes.STUDY),
    *(validate.STUDY, advise.STEPS, estimate.STUDY),
    *(precision.STUDY, precision.COST, contact.STUDY, symptoms.STUDY, restitution.STUDY),
    *(stability.STUDY, overturning.STUDY, validity.STUDY),
    *(score.STUDY, doctor.STUDY),
)
"""In the order in which the help lists them and a report shows them."""

CHAPTERS: tuple[tuple[Study, Chapter], ...] = tuple(
    (study, chapter) for study in STUDIES for chapter in study.chapters
)
"""Every study's places in a report, in its order."""
