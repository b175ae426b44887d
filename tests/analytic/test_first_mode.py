"""The first mode of a block against its equations of motion in the first instant."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from analytic import FirstMode, first_mode, rocking_friction


def friction_at_lift(a, aspect):
    """Return abs(horizontal)/normal force at the corner about which a block begins to turn.

    Unit mass, width and gravity; unknowns are the turning acceleration and the two forces.
    """
    width, height = 1.0, aspect
    inertia = (width**2 + height**2) / 12.0
    # the centre is half a height above and half a width from the corner, which does not move;
    # turning leaves the base behind: relative to it the centre gains -h/2 and rises b/2
    matrix = [
        [-0.5 * height, -1.0, 0.0],
        [0.5 * width, 0.0, -1.0],
        [inertia, -0.5 * height, 0.5 * width],
    ]
    turning, across, normal = np.linalg.solve(matrix, [-a, -1.0, 0.0])
    assert turning > 0.0
    return abs(across) / normal


@given(st.floats(0.5, 8.0), st.floats(1.001, 10.0))
def test_the_boundary_is_the_force_of_the_first_instant(aspect, over):
    """Linear equations of condition 1e2: to 1e-13."""
    a = over / aspect
    assert rocking_friction(a, aspect) == pytest.approx(friction_at_lift(a, aspect), rel=1e-11)


def test_printed_boundaries():
    assert rocking_friction(0.75, 4.0) == pytest.approx(0.364865, abs=5e-7)
    assert rocking_friction(1.0, 2.0) == pytest.approx(0.608696, abs=5e-7)


@given(st.floats(-5.0, 5.0), st.floats(0.01, 3.0), st.floats(0.3, 8.0))
def test_modes_are_what_their_forces_allow(a, friction, aspect):
    assume(abs(abs(a) * aspect - 1.0) > 1e-9)
    mode, size = first_mode(a, friction, aspect), abs(a)
    slides_flat = size > friction and friction * aspect < 1.0
    lifts = size * aspect > 1.0 and friction * aspect >= 1.0
    if not slides_flat and not lifts:
        assert mode is FirstMode.REST
    elif slides_flat:
        assert mode is FirstMode.SLIDE
    else:
        sticks = friction_at_lift(size, aspect) <= friction
        assume(not math.isclose(rocking_friction(size, aspect), friction, rel_tol=1e-9))
        assert mode is (FirstMode.ROCK if sticks else FirstMode.SLIDE_AND_ROCK)
