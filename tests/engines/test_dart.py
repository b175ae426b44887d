"""DART: the traps that it sets without a word."""

from dataclasses import replace

import pytest
from uses import HERE, SHAKEN, error, rocked

from analytic.response import Reason

pytestmark = pytest.mark.skipif("dart" not in HERE, reason="dartpy is not installed")


def peak(sign=1.0, **options):
    return rocked("dart", replace(SHAKEN, amplitude=sign * SHAKEN.amplitude), **options).peak_ratio


def test_friction_that_has_no_mass_is_left_to_another_solver():
    """Out of the plane nothing moves a planar block on a base of its own plane: the response is no
    longer the mirror image of its mirror's, unless the base can slide aside."""
    assert peak(1.0) == pytest.approx(peak(-1.0), rel=1e-12)
    there, back = (peak(sign, settings={"aside": False}) for sign in (1.0, -1.0))
    assert abs(there / back - 1.0) > 1e-5


def test_a_mass_brings_no_inertia():
    """Set by its mass alone, a block keeps the moments of inertia of 1 kg m2 and hardly rocks."""
    assert peak(preset="naive", settings={"exact_inertia": False}) < 0.1 * peak(preset="naive")


def test_corrections_go_by_the_unit_of_length():
    """In metres a pivot is pushed out of its margin at up to 1 mm/s, in 1e-5 m at 1e-8 m/s."""
    fine, coarse = (error("dart", settings={"unit": unit}) for unit in (1e5, 1.0))
    assert fine < 1e-4 < 1e-3 < coarse


def test_a_release_without_an_option_has_it_off(monkeypatch):
    """One that cannot split impulses does as one that does not, and not as one that does."""
    import dartpy

    as_it_is = peak(preset="fixed")
    solver = dartpy.constraint.ConstraintSolver
    for name in ("isSplitImpulseEnabled", "setSplitImpulseEnabled"):
        monkeypatch.delattr(solver, name)
    for name in ("getDeactivationOptions", "setDeactivationOptions"):
        monkeypatch.delattr(dartpy.simulation.World, name)
    assert peak(preset="fixed") == as_it_is
    asked = rocked("dart", preset="fixed", settings={"split_impulse": True})
    assert asked.reason is Reason.FAULT
    assert "split impulse" in asked.message
