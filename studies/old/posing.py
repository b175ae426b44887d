"""From the options of a command line to how the base moves, and the start on it."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from cyclopts import Parameter

from analytic.block import GRAVITY
from analytic.checks import LEAST, MOST
from analytic.motion import Motion, SinePulse, Still
from analytic.record import Record
from analytic.simulate import strongest
from analytic.start import LEAST_TILT
from engines.layouts import System
from studies.cases.accelerograms import Baseline, Units, read_record
from studies.cases.paper import PULSES
from studies.old.arguments import (
    BadInputError,
    Finite,
    HalfCycles,
    Place,
    Positive,
    as_bad_input,
    one_of,
    refuse_both,
    refuse_given,
    required,
)

OF_A_PULSE = ("amplitude", "omega", "pulse", "half_cycles", "phase")
OF_A_RECORD = ("units", "scale", "pga", "baseline")

MOST_TIME, MOST_STEPS = 1e6, 1e9
"""How long a block is watched at most, in units of 1/p, and in how many steps: 1e9 take the fastest
solver minutes and an engine hours."""

MOST_DEGREES = 90.0
"""Tilt beyond which it was not meant in degrees either."""

Pulse = Literal["half-sine", "full-sine"]


class Posed(NamedTuple):
    """A motion of the base, and theta [rad] and its rate [rad/s] at t = 0."""

    motion: Motion
    start: tuple[float, float]


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Excitation:
    """What happens to a block: a pulse or a record, or a release on ground that does not move.

    Attributes
    ----------
    amplitude
        Amplitude of the ground acceleration [g of 9.81 m/s²], positive: the mirror image of a pulse
        has the mirror image of its response.
    omega
        Circular frequency of the pulse [rad/s].
    pulse
        half-sine or full-sine; full-sine unless --half-cycles is given.
    half_cycles
        Number of half cycles, instead of --pulse.
    phase
        Phase [rad] of the pulse at its begin; 1.5708 makes it a cosine.
    record
        A recorded accelerogram instead of a pulse: a PEER AT2 file, an ASC file of ESM or ITACA, or
        a table of time [s] and acceleration. It is straight between its samples.
    units
        Of the record's acceleration: needed where the file does not state them, refused where it
        states others. g is 9.81 m/s².
    scale
        Factor on the record's acceleration.
    pga
        Scale the record to this largest absolute acceleration [g].
    baseline
        Correct the record, before it is scaled, by what scipy.signal.detrend takes away: its mean
        (constant) or the line that fits it best (linear). By default it is taken as it is, and what
        velocity it leaves the base with is reported.
    tilt
        Rotation from which the block starts, in units of α; it stands on the corner that it leans
        towards, to the right where positive. Without a pulse or record it is released on ground
        that does not move.
    rate
        Angular velocity with which it starts, in units of αp; that of an upright block says about
        which corner it turns.
    degrees
        Angles in degrees: --tilt, --rate [°/s] and --phase, and the rotations in a table.
    """

    amplitude: Positive | None = None
    omega: Positive | None = None
    pulse: Annotated[Pulse, one_of(Pulse)] | None = None
    half_cycles: HalfCycles | None = None
    phase: Finite | None = None
    record: Place | None = None
    units: Annotated[Units, one_of(Units)] | None = None
    scale: Positive | None = None
    pga: Positive | None = None
    baseline: Annotated[Baseline, one_of(Baseline)] | None = None
    tilt: Finite | None = None
    rate: Finite | None = None
    degrees: bool = False

    def pose(self, block: System) -> Posed:
        """Return the motion and the start that the options mean for a block.

        Raises
        ------
        BadInputError
            If they contradict one another, or a value is not allowed.
        """
        motion = self._motion()
        return Posed(motion, self._start(block, motion))

    def refuse(self, allowed: str) -> None:
        """Raise BadInputError if an option was given a value, which is allowed otherwise."""
        refuse_given(self._given(each.name for each in fields(self)), allowed)

    def _given(self, names: Iterable[str]) -> dict[str, object]:
        given = {name.replace("_", "-"): getattr(self, name) for name in names}
        return {name: None if value is False else value for name, value in given.items()}

    def _motion(self) -> Motion:
        if self.record is not None:
            refuse_given(self._given(OF_A_PULSE), "only without --record")
            return self._recorded(self.record)
        refuse_given(self._given(OF_A_RECORD), "only with --record")
        pulse = any(value is not None for value in self._given(OF_A_PULSE).values())
        released = (self.tilt or self.rate) and not pulse
        return Still() if released else self._pulse()

    def _recorded(self, path: Path) -> Record:
        refuse_both(scale=self.scale, pga=self.pga)
        record = read_record(path, self.units, self.baseline)
        factor = "" if self.scale is None else f" times --scale {self.scale:g}"
        peak = "" if self.pga is None else f" scaled to --pga {self.pga:g}"
        with as_bad_input(f"--record{factor}{peak}: "):
            if self.pga is not None:
                return record.scaled_to(self.pga * GRAVITY)
            return record.scaled(1.0 if self.scale is None else self.scale)

    def _pulse(self) -> SinePulse:
        refuse_both(half_cycles=self.half_cycles, pulse=self.pulse)
        words = "a pulse requires both, or give --record, --tilt or --rate"
        amplitude_g, omega = required(words, amplitude=self.amplitude, omega=self.omega)
        with as_bad_input():
            return SinePulse.in_g(
                amplitude_g,
                omega=omega,
                half_cycles=self.half_cycles or PULSES[self.pulse or "full-sine"],
                phase=self._angle(self.phase or 0.0, 1.0),
            )

    def _start(self, block: System, motion: Motion) -> tuple[float, float]:
        theta = self._angle(self.tilt or 0.0, block.alpha)
        rate = self._angle(self.rate or 0.0, block.alpha * block.p)
        if not abs(theta) < 0.5 * math.pi:
            tilt = self.tilt or 0.0
            side = f"{90.0 if self.degrees else 0.5 * math.pi / block.alpha:.6g}"
            unit = "°" if self.degrees else "α"
            asked = not self.degrees and abs(tilt) < MOST_DEGREES
            meant = f"; {tilt:g}°? --tilt {tilt:g} --degrees" if asked else ""
            raise BadInputError(
                f"--tilt is {tilt:g}; it must lie between -{side} and {side} {unit}, "
                f"where the side of the block lies on the ground{meant}"
            )
        starts = (
            ("tilt", self.tilt, theta, LEAST_TILT * block.alpha),
            ("rate", self.rate, rate, LEAST),
        )
        for name, given, value, least in starts:
            if given and not least <= abs(value) <= MOST:
                allowed = f"0, or of a size {least:.3g} to {MOST:g} in rad and s"
                raise BadInputError(f"--{name} is {given:g}; it must be {allowed}")
        if abs(theta) == block.alpha and rate == 0.0 == strongest(motion):
            raise BadInputError(
                f"--tilt is {self.tilt:g} and nothing moves; it must not be where a block at rest "
                "balances"
            )
        return theta, rate

    def _angle(self, value: float, unit: float) -> float:
        return math.radians(value) if self.degrees else value * unit


DEFAULT_EXCITATION = Excitation()
"""Nothing is given."""


def refuse_endless(
    block: System,
    watched_s: float,
    *,
    duration: float | None = None,
    step: float | None = None,
    dt: float | None = None,
) -> None:
    """Refuse what no computer sees the end of.

    Parameters
    ----------
    block : RigidBlock
    watched_s : float
        How long it is watched [s].
    duration, step, dt : float, optional
        What was given of that, p dt, and a step [s].

    Raises
    ------
    BadInputError
    """
    most_s = MOST_TIME / block.p
    if watched_s > most_s:
        asked = (
            f"--width is {block.width:g} and --height {block.height:g}; what moves the block"
            if duration is None
            else f"--duration is {duration:g}; it"
        )
        raise BadInputError(
            f"{asked} must last at most {most_s:.4g} s, {MOST_TIME:g} times 1/p, "
            f"and the block is watched for {watched_s:.4g} s"
        )
    for name, given, unit in (("step", step, 1.0 / block.p), ("dt", dt, 1.0)):
        if given is not None and watched_s > MOST_STEPS * given * unit:
            least = watched_s / (MOST_STEPS * unit)
            raise BadInputError(
                f"--{name} is {given:g}; it must be at least {least:.4g} for a run of "
                f"{watched_s:.4g} s, so that this takes at most {MOST_STEPS:g} steps"
            )
