"""What no reference can take is refused, in one line that names it, its value and what may be."""

import math
import re
from functools import partial

import pytest
from given import BLOCK, G

from analytic import Delayed, Record, RigidBlock, RockingFrame, SinePulse, SlidingBlock, Still
from analytic.cases import peak_ratios
from analytic.maps import overturning_modes
from analytic.motion import BothWays
from analytic.simulate import simulate
from analytic.steppers import integrate
from engines import Scene

INF, NAN = math.inf, math.nan
HALF_SINE = SinePulse(amplitude=0.4 * G, omega=2.0 * math.pi)
BOX = SlidingBlock(width=1.0, height=0.5, friction=0.2)
ARRAYS = {"alpha": 0.3, "amplitude_g": 0.4, "omega_over_p": 1.0, "half_cycles": 1}
SIZE = {"width": 0.5, "height": 1.5}
SHAKEN = {"block": BLOCK, "motion": HALF_SINE}
ROUTES = (simulate, integrate)
RELEASED = {"motion": Still(), "start": (0.1, 0.0), "duration": 1.0}

USUAL = {
    RigidBlock: SIZE,
    RockingFrame: {**SIZE, "load": 1.0},
    SlidingBlock: {"width": 1.0, "height": 0.5, "friction": 0.2},
    SinePulse: {"amplitude": 4.0, "omega": 6.0, "half_cycles": 1},
    Record: {"dt": 0.1, "samples": [1.0, 2.0]},
    Delayed: {"motion": HALF_SINE, "rest_s": 1.0},
    BothWays: {"upward": HALF_SINE},
    Record.read: {"path": "nowhere.txt"},
    simulate: SHAKEN,
    integrate: SHAKEN,
    peak_ratios: ARRAYS,
    overturning_modes: ARRAYS,
}
"""What can be asked, and with what it is answered."""

NEVER = ({"model": "housner"}, {"block": BOX}, {"block": RockingFrame(**SIZE, load=1.0)})
DROP = SinePulse.in_g(1.1, omega=9.0, half_cycles=2)
LONG = SinePulse(amplitude=1.0, omega=1.0, half_cycles=10**7)
NO_SIZE = (0, -1, INF, NAN, "wide", None)
WRONG = {
    RigidBlock: {
        "width": (*NO_SIZE, 5e-324),
        "height": (*NO_SIZE, 1e308),
        "gravity": (*NO_SIZE, 1e-310),
        "restitution": (-0.1, 1.1, INF, NAN),
        "offset": (0.25, NAN),
        "inertia": (0.0,),
    },
    RockingFrame: {
        "columns": (1, 2.5, 101, 1e8),
        "load": (0.0, -1.0),
        "width": (0.0,),
        "restitution": (1.1, NAN),
    },
    SlidingBlock: {"friction": (2.0, 0.0)},
    SinePulse: {
        "amplitude": (NAN,),
        "omega": (0, -2, 1e-308, 1e200),
        "phase": (INF, 1.1e6, -1e17),
        "half_cycles": (0, 1.5, 10**16),
    },
    Record: {"dt": (0.0, NAN, 1e200, 1e-320, 1e308)},
    Delayed: {"rest_s": (0.0, -1.0, INF, NAN, "x")},
    simulate: {"tolerance": (0.0, 1e-17, 0.1, NAN), "duration": (0.1,)},
    integrate: {
        "method": ("euler",),
        "model": ("none",),
        "step": (0.0,),
        "event_tolerance": (-1.0,),
    },
    peak_ratios: {
        "alpha": (0.0,),
        "amplitude_g": (NAN,),
        "half_cycles": (1.5,),
        "restitution": (1.5,),
        "model": ("linear",),
        "threads": (0, 2.5, 1e9),
    },
    overturning_modes: {
        "alpha": (0.0,),
        "omega_over_p": (0.0,),
        "half_cycles": (0.5,),
        "threads": (0, -1),
    },
}
"""Values, of one argument at a time, that are refused by its name and their own."""

TOGETHER = [
    (RigidBlock, {"width": 1e-100, "height": 1e60}, "width is 1e-100 and height 1e+60; alpha"),
    (RigidBlock, {"width": 1e60, "height": 1e-100}, "width is 1e+60 and height 1e-100; alpha"),
    (RigidBlock, {"offset": 0.1, "restitution": 0.5}, "restitution is 0.5; it must"),
    (SinePulse, {"amplitude": 1e200, "omega": 1e-100}, "amplitude is 1e+200 and omega 1e-100; "),
    (SinePulse, {"half_cycles": 10**400}, "half_cycles is 1000"),
    (Record, {"samples": [1.0]}, "two or more"),
    (Record, {"samples": [[1.0, 2.0]]}, "shape"),
    (Record, {"samples": [0.0, 1.0, NAN]}, "samples[2] is nan"),
    (Record, {"samples": [INF, 1.0]}, "samples[0] is inf"),
    (Record, {"samples": [1e307, -1e307], "dt": 0.01}, "a sample 1e+307; "),
    (Record, {"dt": 1e100, "samples": [0.0, 1e200]}, "dt is 1e+100 and a sample 1e+200; the disp"),
    (Record, {"dt": 1e-100, "samples": [0.0, 1e250]}, "dt is 1e-100 and a sample 1e+250; the slop"),
    (Record.read, {}, "path is 'nowhere.txt'; it must be a file that can be read"),
    (Record.read, {"units": "feet"}, "units must be among g, mg, m/s2"),
    (simulate, {"times": [1.0, 0.5]}, "increasing"),
    *((ask, {**RELEASED, "times": [-0.5, 0.5]}, "times begin at -0.5") for ask in ROUTES),
    (simulate, {"vertical": DROP}, "falls to -10.791 m/s2"),
    *((simulate, {"vertical": HALF_SINE, **it}, "only the exact model of a R") for it in NEVER),
    (BothWays, {"level": LONG}, "half_cycles is 1e+07"),
    (integrate, {"motion": BothWays(HALF_SINE, HALF_SINE)}, "vertical is given; only the exact"),
    (simulate, {"block": BOX, "model": "housner"}, "a SlidingBlock has only 'exact'"),
    (simulate, {"block": BOX, "start": 3}, "start is 3; it must be x"),
    (simulate, {"block": BOX, "duration": 0.1}, "duration is 0.1"),
    (peak_ratios, {"omega_over_p": [1.0, -2.0]}, "omega_over_p is -2.0"),
    (Record(dt=1.0, samples=[0.0, 0.0]).scaled_to, {"peak": 1.0}, "zero throughout"),
    (Record(dt=1.0, samples=[0.0, 1.0]).scaled_to, {"peak": -1.0}, "peak is -1"),
    (Record(dt=0.1, samples=[3.1] * 7).detrended, {"kind": "constant"}, "its own constant trend"),
    (Record(dt=0.1, samples=range(7)).detrended, {"kind": "linear"}, "its own linear trend"),
]
"""What is refused of several, or of what is in an argument, and what the refusal says."""


def refuses(ask, named):
    with pytest.raises(ValueError, match=re.escape(named)) as raised:
        ask()
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(("ask", "name"), [(ask, name) for ask in WRONG for name in WRONG[ask]])
def test_what_cannot_be_is_refused_in_one_line(ask, name):
    for value in WRONG[ask][name]:
        with pytest.raises(ValueError, match=rf"\b{name} is ") as raised:
            ask(**{**USUAL[ask], name: value})
        said = str(raised.value)
        assert (repr(value) in said, " must " in said, "\n" in said) == (True, True, False), said


@pytest.mark.parametrize(("ask", "change", "named"), TOGETHER)
def test_what_cannot_be_together_is_refused_in_one_line(ask, change, named):
    refuses(partial(ask, **{**USUAL.get(ask, {}), **change}), named)


@pytest.mark.parametrize("ask", [simulate, integrate, Scene])
@pytest.mark.parametrize(
    ("start", "named"),
    [
        ((0.5 * math.pi, 0.0), "theta of the start is 1.57"),
        ((-2.0, 1.0), "theta of the start is -2.0; it must be between -pi/2 and pi/2 rad"),
        ((math.nan, 0.0), "theta of the start is nan; it must be a finite number"),
        ((0.0, math.inf), "rate of the start is inf"),
        ((BLOCK.alpha, 0.0), "; it must not be the unstable equilibrium"),
        ((-BLOCK.alpha, 0.0), "unstable equilibrium"),
        (0.1, "start is 0.1; it must be theta"),
        ((0.1, 0.2, 0.3), "it must be theta"),
        (("far", 0.0), "theta of the start is 'far'"),
        ((0.0, 1e-300), "rate of the start is 1e-300; it must be 0, or of a size 1e-150 to"),
        ((0.0, -5e-324), "rate of the start is -5e-324"),
        ((1e-160, 0.0), "theta of the start is 1e-160; it must be 0, or of a size"),
    ],
)
def test_bad_starts_are_refused_everywhere_in_the_same_words(ask, start, named):
    body = "system" if ask is Scene else "block"
    for motion in (Still(), SinePulse(amplitude=0.0, omega=3.0)):
        refuses(partial(ask, **{body: BLOCK}, motion=motion, start=start), named)


def test_a_tilt_whose_first_impact_no_step_sees_is_refused():
    """From 1e-100 of alpha the block rocked up to 1.8 of it."""
    still = {"motion": Still(), "duration": 3.0}
    kept = simulate(BLOCK, start=(1e-30 * BLOCK.alpha, 0.0), **still)
    assert kept.peak_ratio == pytest.approx(1e-30, rel=1e-12)
    refuses(partial(simulate, BLOCK, start=(1e-31 * BLOCK.alpha, 0.0), **still), "theta of the")
