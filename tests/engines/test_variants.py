"""Every variant of a contact answers, and what it sets is read back."""

import functools
from dataclasses import replace

import pytest
from declared import run

from analytic.response import Outcome, Reason
from engines import ENGINES, Scene, installed_engines
from engines.factors import BEST, OWN_STEPS
from engines.mujoco import TUNED
from engines.mujoco.build import MujocoSettings
from engines.pybullet.build import BulletSettings
from studies.cases.paper import chosen_cases
from studies.contact import variants

CASE = chosen_cases(True)["typical"][3]
VARIANTS = [variant for engine in installed_engines() for variant in variants(engine)]
LEFT = (Reason.SANK, Reason.THROWN, Reason.SLID)  # no longer a rocking block
MUJOCO_TUNED = functools.partial(replace, TUNED)


def scene(**options):
    return Scene(system=CASE.block, motion=CASE.motion, **{"step": 5e-3, **options})


FIRST = {(v.engine, v.factor): v for v in reversed(VARIANTS)}.values()
"""Of each engine one variant of each factor."""


@pytest.mark.parametrize(
    "variant",
    [pytest.param(v, marks=[] if v in FIRST else pytest.mark.slow) for v in VARIANTS],
    ids=lambda v: f"{v.engine}-{v.preset}-{v.factor}: {v.level}",
)
def test_every_variant_answers(variant):
    """Builds, reads back what it set, and gives a response; only a declared trap may fail."""
    asked = scene(preset=variant.preset, settings=variant.settings, **variant.scene)
    response = run(variant.engine, asked)
    if response.outcome is Outcome.FAILED:
        assert variant.trap and response.reason in LEFT, response.message  # no setting was refused
    elif response.outcome is Outcome.AT_REST:
        assert variant.trap  # it slid, and never rocked; steps this coarse may overturn a block
    else:
        assert response.peak_ratio > 0.0
        assert response.sink_m >= 0.0


def test_a_variant_differs_from_its_preset():
    """What a variant sets is not what its preset sets already, or it would compare nothing."""
    for variant in VARIANTS:
        plain = ENGINES[variant.engine].preset(variant.preset).settings
        if variant.factor and not variant.scene and variant.factor != OWN_STEPS:
            asked = scene(preset=variant.preset, settings=variant.settings)
            assert ENGINES[variant.engine].use(asked).settings != plain, variant


@pytest.mark.parametrize(
    ("settings", "values", "message"),
    [
        (BulletSettings, {"solver": "Lemke"}, "solver is 'Lemke'; it must be one of sequential"),
        (BulletSettings, {"base_geometry": "sea"}, "base_geometry is 'sea'; it must be one of"),
        (BulletSettings, {"warm_starting": 1.5}, "warm_starting is 1.5; it must be from 0 to 1"),
        (BulletSettings, {"contact_stiffness": 1.0}, "contact_damping are .* given together"),
        (
            BulletSettings,
            {"contact_stiffness": -1.0, "contact_damping": 1.0},
            "contact_stiffness is -1.0; it must be positive",
        ),
        (MujocoSettings, {"integrator": "Heun"}, "integrator is 'Heun'; it must be one of Euler"),
        (MujocoSettings, {"margin": -1.0}, "margin is -1.0; it must be 0 or more"),
        (MujocoSettings, {"margin": "wide"}, "margin is 'wide'; it must be 0 or more"),
        (MujocoSettings, {"noslip_iterations": -1}, "noslip_iterations is -1; it must be 0"),
        (MUJOCO_TUNED, {"solref": (2.0, 1.0)}, "solref is .* it must be None"),
        (MUJOCO_TUNED, {"impedance": None}, "impedance is None"),
        (MUJOCO_TUNED, {"damping": 0.0}, "damping is 0.0; it must be positive"),
        (MUJOCO_TUNED, {"stiffness": None}, "stiffness are .* given together"),
    ],
)
def test_what_is_not_allowed_is_named(settings, values, message):
    with pytest.raises(ValueError, match=message):
        settings(**values)


def test_stiffness_reads_back_where_the_library_tells(monkeypatch):
    settings = {"multibody": True, "contact_stiffness": 1e6, "contact_damping": 1e5}
    assert run("pybullet", scene(preset=BEST, settings=settings)).outcome is Outcome.ROCKED
    library = pytest.importorskip("pybullet")
    change = library.changeDynamics

    def forgetful(contactStiffness=0.0, contactDamping=0.0, **named):
        return change(**named)

    monkeypatch.setattr(library, "changeDynamics", forgetful)
    response = run("pybullet", scene(preset=BEST, settings=settings))
    assert response.message.startswith("contactDamping was set to")
