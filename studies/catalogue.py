"""The list of the studies; nothing else names them all."""

from typing import TYPE_CHECKING

from studies import (
    advise,
    animate,
    blocks,
    compare,
    contact,
    defaults,
    doctor,
    ensemble,
    estimate,
    export,
    free,
    harmonic,
    histories,
    linearizations,
    literature,
    overturning,
    precision,
    restitution,
    scenes,
    score,
    stability,
    sweep,
    symptoms,
    throughput,
    validate,
    validity,
    versions,
)
from studies.kit.study import Chapter, Study

STUDIES: tuple[Study, ...] = (
    advise.STUDY,
    compare.STUDY,
    blocks.STUDY,
    animate.STUDY,
    export.STUDY,
    sweep.STUDY,
    defaults.STUDY,
    histories.STUDY,
    linearizations.STUDY,
    free.STUDY,
    scenes.STUDY,
    harmonic.STUDY,
    literature.STUDY,
    validate.STUDY,
    advise.STEPS,
    estimate.STUDY,
    precision.STUDY,
    precision.COST,
    contact.STUDY,
    symptoms.STUDY,
    restitution.STUDY,
    versions.STUDY,
    stability.STUDY,
    overturning.STUDY,
    validity.STUDY,
    ensemble.STUDY,
    throughput.STUDY,
    score.STUDY,
    doctor.STUDY,
)
"""In the order in which the help lists them and a report shows them."""

CHAPTERS: tuple[tuple[Study, Chapter], ...] = tuple(
    (study, chapter) for study in STUDIES for chapter in study.chapters
)
"""Every study's places in a report, in its order."""

if TYPE_CHECKING:
    from studies.advise import steps as _steps
    from studies.advise import study as _advise
    from studies.blocks import study as _blocks
    from studies.contact import study as _contact
    from studies.defaults import study as _defaults
    from studies.ensemble import study as _ensemble
    from studies.estimate import study as _estimate
    from studies.free import study as _free
    from studies.harmonic import study as _harmonic
    from studies.histories import study as _histories
    from studies.kit.study import StudyModule
    from studies.linearizations import study as _linearizations
    from studies.literature import study as _literature
    from studies.overturning import study as _overturning
    from studies.precision import cost as _cost
    from studies.precision import study as _precision
    from studies.restitution import study as _restitution
    from studies.scenes import study as _scenes
    from studies.score import study as _score
    from studies.stability import study as _stability
    from studies.sweep import study as _sweep
    from studies.symptoms import study as _symptoms
    from studies.validate import study as _validate
    from studies.validity import study as _validity
    from studies.versions import study as _versions

    # what `Study.load` promises, held against every module by the type checker
    _KEPT: tuple[StudyModule, ...] = (
        *(_sweep, _histories, _linearizations, _free, _validate, _precision, _cost),
        *(
            _advise,
            _steps,
            _scenes,
            _defaults,
            _estimate,
            _symptoms,
            _restitution,
            _score,
            _versions,
        ),
        *(_harmonic, _literature, _contact, _stability, _overturning, _validity, _ensemble),
        *(_blocks, _scenes),
    )
