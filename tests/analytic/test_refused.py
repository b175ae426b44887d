"""What no reference can take is refused, in one line that names it, its value and what may be."""

import math
from functools import partial

import pytest
from given import BLOCK, G

from analytic import (
    CartBlock,
    Delayed,
    Record,
    RigidBlock,
    RockingFrame,
    RollingCylinder,
    SinePulse,
    SlidingBlock,
    Still,
    first_mode,
    integrate,
    kanai_tajimi,
    near_fault,
    overturning_modes,
    peak_ratios,
    ricker,
    simulate,
)
from analytic.criteria import frictionless_fall, overturning_amplitude
from analytic.orbits import orbit_limits
from engines import Scene

HALF_SINE = SinePulse(amplitude=0.4 * G, omega=2.0 * math.pi)
BOX = SlidingBlock(width=1.0, height=0.5, friction=0.2)
ARRAYS = {"alpha": 0.3, "amplitude_g": 0.4, "omega_over_p": 1.0, "half_cycles": 1}
SIZE = {"width": 0.5, "height": 1.5}
SHAKEN = {"block": BLOCK, "motion": HALF_SINE}
RELEASED = {"motion": Still(), "start": (0.1, 0.0), "duration": 1.0}

USUAL = {
    RigidBlock: SIZE,
    RockingFrame: {**SIZE, "load": 1.0},
    CartBlock: {**SIZE, "mass_ratio": 0.3},
    SlidingBlock: {"width": 1.0, "height": 0.5, "friction": 0.2},
    RollingCylinder: {"radius": 0.5, "height": 0.5, "tilt": 0.2},
    SinePulse: {"amplitude": 4.0, "omega": 6.0, "half_cycles": 1},
    Record: {"dt": 0.1, "samples": [1.0, 2.0]},
    Delayed: {"motion": HALF_SINE, "rest_s": 1.0},
    ricker: {"amplitude": 1.0, "frequency": 1.0},
    near_fault: {"velocity": 1.0, "frequency": 1.0, "gamma": 2.0},
    kanai_tajimi: {"seed": 1, "peak": 1.0},
    simulate: SHAKEN,
    integrate: SHAKEN,
    peak_ratios: ARRAYS,
    overturning_modes: ARRAYS,
    overturning_amplitude: {"omega_over_p": 1.0},
    first_mode: {"amplitude_g": 1.0, "friction": 0.5, "aspect": 2.0},
    orbit_limits: {"restitution": 0.9, "omega_over_p": 4.0, "n": 1},
    frictionless_fall: {"block": BLOCK, "theta": 0.5},
}
"""What can be asked, and with what it is answered."""

REFUSED = {
    RigidBlock: [
        *(
            ({name: value}, f"{name} is .*; it must be")
            for name in ("width", "height", "gravity")
            for value in (0, -1, math.inf, math.nan, "wide", None)
        ),
        *(({"restitution": value}, "restitution is") for value in (-0.1, 1.1, math.inf)),
        # what floating point does not hold
        ({"width": 5e-324}, "width is 5e-324; it must be from 1e-150 to 1e\\+150"),
        ({"height": 1e308}, r"height is 1e\+308"),
        ({"gravity": 1e-310}, "gravity is 1e-310"),
        ({"width": 1e-100, "height": 1e60}, r"width is 1e-100 and height 1e\+60; alpha"),
        ({"width": 1e60, "height": 1e-100}, r"width is 1e\+60 and height 1e-100; alpha"),
    ],
    RockingFrame: [
        ({"columns": 1}, "columns is 1; it must be a whole number of 2 or more"),
        ({"columns": 2.5}, "columns is 2.5"),
        ({"load": 0.0}, "load is 0.0; it must be positive"),
        ({"load": -1.0}, "load is -1.0; it must be positive"),
        ({"width": 0.0}, "width is 0.0"),
        ({"restitution": 1.1}, "restitution is 1.1"),
    ],
    CartBlock: [
        ({"mass_ratio": 0.0}, "mass_ratio is 0.0; it must be between 0 and 1"),
        ({"mass_ratio": 1.0}, "mass_ratio is 1.0"),
        ({"stiffness": -1.0}, "stiffness is -1.0; it must not be negative"),
        ({"width": math.inf}, "width is inf"),
    ],
    SlidingBlock: [
        ({"friction": 2.0}, r"friction is 2\.0; it must be below width/height, 2\.0"),
        ({"friction": 0.0}, r"friction is 0\.0; it must be positive"),
    ],
    RollingCylinder: [
        ({"tilt": 0.0}, "tilt is 0.0; it must be positive"),
        ({"tilt": 1.6}, "tilt is 1.6; it must be below pi/2"),
        ({"height": 2.0, "tilt": 0.6}, "tilt is 0.6; it must be below 0.46"),
        ({"radius": -1.0}, "radius is -1.0"),
        ({"height": math.nan}, "height is nan"),
    ],
    SinePulse: [
        ({"amplitude": math.nan}, "amplitude is"),
        ({"omega": 0}, "omega is"),
        ({"omega": -2}, "omega is"),
        ({"phase": math.inf}, "phase is"),
        ({"half_cycles": 0}, "half_cycles is"),
        ({"half_cycles": 1.5}, "half_cycles is"),
        # what floating point does not hold
        ({"omega": 1e-308}, "omega is 1e-308; it must be from 1e-150"),
        ({"omega": 1e200}, r"omega is 1e\+200"),
        ({"amplitude": 1e200, "omega": 1e-100}, r"amplitude is 1e\+200 and omega 1e-100; the disp"),
        ({"half_cycles": 10**400}, "half_cycles is 1000"),
        ({"half_cycles": 10**16}, r"half_cycles is 1\d*; it must be a whole number from 1 to 1e"),
    ],
    Record: [
        ({"dt": 0.0}, "dt is 0.0; it must be positive"),
        ({"dt": math.nan}, "dt is nan"),
        ({"samples": [1.0]}, "two or more"),
        ({"samples": [[1.0, 2.0]]}, "shape"),
        ({"samples": [0.0, 1.0, math.nan]}, r"samples\[2\] is nan"),
        ({"samples": [math.inf, 1.0]}, r"samples\[0\] is inf"),
        # what floating point does not hold
        ({"samples": [1e307, -1e307], "dt": 0.01}, "a sample 1e\\+307; .* must be finite"),
        ({"dt": 1e308, "samples": [0.0, 0.0, 0.0]}, "dt is 1e\\+308; it must be from"),
        ({"dt": 1e200}, "must be from"),
        ({"dt": 1e-320}, "must be from"),
        ({"dt": 1e100, "samples": [0.0, 1e200]}, r"dt is 1e\+100 and a sample 1e\+200; the disp"),
        ({"dt": 1e-100, "samples": [0.0, 1e250]}, r"dt is 1e-100 and a sample 1e\+250; the slope"),
    ],
    Delayed: [({"rest_s": rest}, "rest_s is") for rest in (0.0, -1.0, math.inf, math.nan, "x")],
    ricker: [
        ({"amplitude": math.nan}, "amplitude is nan"),
        ({"frequency": 0.0}, "frequency is 0.0; it must be positive"),
        ({"dt": -1.0}, "dt is -1.0"),
    ],
    near_fault: [
        ({"gamma": 1.0}, "gamma is 1.0; it must be more than 1"),
        ({"phase": math.inf}, "phase is inf"),
    ],
    kanai_tajimi: [
        ({"peak": 0.0}, "peak is 0.0"),
        ({"damping": 1.0}, "damping is 1.0"),
        ({"rise": 9.0}, "rise is 9.0 and fall 8.0; 0 < rise"),
        ({"duration": 5.0}, "fall 8.0"),
    ],
    simulate: [
        *(({"tolerance": value}, "tolerance is") for value in (0.0, 1e-17, 0.1, math.nan)),
        ({"duration": 0.1}, r"duration is 0\.1; it must be at least"),
        ({"times": [1.0, 0.5]}, "increasing"),
        ({**RELEASED, "times": [-0.5, 0.5]}, r"times begin at -0\.5"),
        ({"block": CartBlock(**SIZE, mass_ratio=0.3), "model": "housner"}, "has only 'exact'"),
        ({"block": BOX, "model": "housner"}, "a SlidingBlock has only 'exact'"),
        ({"block": BOX, "start": 3}, "start is 3; it must be x"),
        ({"block": BOX, "duration": 0.1}, r"duration is 0\.1"),
    ],
    integrate: [
        ({"method": "euler"}, "method is 'euler'; it must be one of rk4"),
        ({"step": 0.0}, "step is 0.0"),
        ({"event_tolerance": -1.0}, "event_tolerance is -1.0"),
        ({"model": "none"}, "model is 'none'"),
        ({**RELEASED, "times": [-0.5, 0.5]}, r"times begin at -0\.5"),
    ],
    peak_ratios: [
        ({"alpha": 0.0}, "alpha is 0.0"),
        ({"omega_over_p": [1.0, -2.0]}, "omega_over_p is -2.0"),
        ({"amplitude_g": math.nan}, "amplitude_g is nan"),
        ({"half_cycles": 1.5}, "half_cycles is 1.5"),
        ({"restitution": 1.5}, "restitution is 1.5"),
        ({"model": "linear"}, "model is 'linear'; it must be one of exact, housner"),
    ],
    overturning_modes: [
        ({"alpha": 0.0}, "alpha"),
        ({"omega_over_p": 0.0}, "omega"),
        ({"half_cycles": 0.5}, "half"),
    ],
    overturning_amplitude: [({"half_cycles": 3}, "half_cycles is 3")],
    first_mode: [
        ({name: value}, "it must be")
        for name, value in (("amplitude_g", math.nan), ("friction", 0.0), ("aspect", -2.0))
    ],
    orbit_limits: [
        ({"restitution": 1.0}, "restitution"),
        ({"omega_over_p": 0.0}, "omega_over_p"),
        ({"n": 2}, "n is 2"),
    ],
    frictionless_fall: [({"theta": BLOCK.alpha}, "theta")],
}
"""What is asked instead, and what the refusal says."""


def refuses(ask, named):
    with pytest.raises(ValueError, match=named) as raised:
        ask()
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("ask", "change", "named"),
    [
        pytest.param(ask, *row, id=f"{ask.__name__}-{row[1]}-{number}")
        for ask, rows in REFUSED.items()
        for number, row in enumerate(rows)
    ],
)
def test_what_cannot_be_is_refused_in_one_line(ask, change, named):
    refuses(partial(ask, **{**USUAL[ask], **change}), named)


@pytest.mark.parametrize("ask", [simulate, integrate, Scene])
@pytest.mark.parametrize(
    ("start", "named"),
    [
        ((0.5 * math.pi, 0.0), "theta of the start is 1.57"),
        ((-2.0, 1.0), "theta of the start is -2.0; it must be between -pi/2 and pi/2 rad"),
        ((math.nan, 0.0), "theta of the start is nan; it must be a finite number"),
        ((0.0, math.inf), "rate of the start is inf"),
        ((BLOCK.alpha, 0.0), "start is .*; it must not be the unstable equilibrium"),
        ((-BLOCK.alpha, 0.0), "unstable equilibrium"),
        (0.1, "start is 0.1; it must be theta"),
        ((0.1, 0.2, 0.3), "it must be theta"),
        (("far", 0.0), "theta of the start is 'far'"),
    ],
)
def test_bad_starts_are_refused_everywhere_in_the_same_words(ask, start, named):
    body = "system" if ask is Scene else "block"
    for motion in (Still(), SinePulse(amplitude=0.0, omega=3.0)):
        refuses(partial(ask, **{body: BLOCK}, motion=motion, start=start), named)


def test_a_record_of_which_nothing_is_left_is_refused():
    refuses(lambda: Record(dt=1.0, samples=[0.0, 0.0]).scaled_to(1.0), "zero throughout")
    refuses(lambda: Record(dt=1.0, samples=[0.0, 1.0]).scaled_to(-1.0), "peak is -1")
    for kind, samples in (("constant", [3.1] * 7), ("linear", range(7))):
        left = Record(dt=0.1, samples=samples)
        refuses(partial(left.detrended, kind), f"its own {kind} trend; nothing is left")
