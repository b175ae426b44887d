"""Options of a scene: what stands on the base, how that moves, and from which start."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from cyclopts import Parameter

from analytic.accelerograms import Units
from analytic.block import GRAVITY, RigidBlock
from analytic.checks import LEAST, MOST
from analytic.frame import RockingFrame
from analytic.motion import Motion, SinePulse, Still, both_ways
from analytic.record import Record
from analytic.slide import SlidingBlock
from analytic.start import LEAST_TILT, check_vertical, strongest
from engines.scene import System, free_rocking_window
from studies.cases.paper import PULSES
from studies.cases.refusal import BadInputError
from studies.kit import arguments

MOST_TIME, MOST_STEPS = 1e6, 1e9
"""How long a block is watched at most, in units of 1/p, and in how many steps."""

Pulse = Literal["half-sine", "full-sine"]
Baseline = Literal["none", "constant", "linear"]
"""How a record is corrected: not at all, or by what its samples lose."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Excitation:
    """What happens to a block: a pulse or a record, or a release on ground that does not move."""

    amplitude: arguments.Positive | None = None
    """Amplitude of the ground acceleration [g = 9.81 m/s²]; it must be positive, since a mirrored
    pulse mirrors the response."""
    omega: arguments.Positive | None = None
    """Circular frequency of the pulse [rad/s]."""
    pulse: Annotated[Pulse, arguments.one_of(Pulse)] | None = None
    """half-sine or full-sine; full-sine unless --half-cycles is given."""
    half_cycles: arguments.HalfCycles | None = None
    """Number of half cycles, instead of --pulse."""
    phase: arguments.Finite | None = None
    """Phase [rad] at the start of the pulse; 1.5708 makes it a cosine."""
    record: arguments.Place | None = None
    """A recorded accelerogram instead of a pulse: a PEER AT2 file, an ASC file of ESM or ITACA, a
    table of time [s] and acceleration, or one column of acceleration."""
    record_dt: arguments.Positive | None = None
    """Time [s] between samples, for a file of one column."""
    units: Annotated[Units, arguments.one_of(Units)] | None = None
    """Unit of the record's acceleration, for a file that does not state it; one that contradicts
    the file is refused. g is 9.81 m/s²."""
    scale: arguments.Positive | None = None
    """Factor on the record's acceleration."""
    pga: arguments.Positive | None = None
    """Scale the record to this largest absolute acceleration [g]."""
    baseline: Annotated[Baseline, arguments.one_of(Baseline)] | None = None
    """Before scaling, subtract the record's mean (constant) or best-fitting line (linear) with
    scipy.signal.detrend. By default nothing is subtracted, and the velocity of the base at the end
    is reported."""
    vertical: arguments.Place | None = None
    """A recorded acceleration of the base upwards, in a file as of --record; one that says DWN or
    DOWN is turned. --scale and --pga leave it alone. The exact model and engines take it, but
    presets that land do not."""
    vertical_amplitude: arguments.Finite | None = None
    """Amplitude of a pulse of the base upwards [g], instead of --vertical; it may be negative."""
    vertical_omega: arguments.Positive | None = None
    """Circular frequency of that pulse [rad/s]."""
    vertical_half_cycles: arguments.HalfCycles | None = None
    """Its number of half cycles, 2 by default."""
    tilt: arguments.Finite | None = None
    """Initial rotation in units of α; a block with a positive one leans to the right. Without a
    pulse or record the block is released on ground at rest."""
    rate: arguments.Finite | None = None
    """Initial angular velocity in units of αp; for an upright block its sign selects the corner
    about which it turns."""

    def pose(self, block: System) -> tuple[Motion, tuple[float, float]]:
        """Return the motion that the options mean, and θ [rad] and its rate [rad/s] at t = 0."""
        if isinstance(block, SlidingBlock):
            arguments.refuse_given(self._given("tilt", "rate"), "only where something rocks")
        motion, upward = self._motion(), self._upward()
        if upward is not None:
            with arguments.as_bad_input("--"):
                motion = both_ways(motion, upward)
                check_vertical(block, motion, linear=False)
        return motion, self._start(block, motion)

    def _given(self, *names: str) -> dict[str, object]:
        return {name: getattr(self, name) for name in names}

    def _motion(self) -> Motion:
        pulse = self._given("amplitude", "omega", "pulse", "half_cycles", "phase")
        if self.record is not None:
            arguments.refuse_given(pulse, "only without --record")
            return self._recorded(self.record)
        arguments.refuse_given(self._given("scale", "pga"), "only with --record")
        reading = self._given("record_dt", "units", "baseline")
        if self.vertical is None:
            arguments.refuse_given(reading, "only with --record")
        released = (self.tilt or self.rate) and set(pulse.values()) == {None}
        return Still() if released else self._pulse()

    def _recorded(self, path: Path) -> Record:
        arguments.refuse_both(scale=self.scale, pga=self.pga)
        record = read_record(path, self.units, self.baseline, self.record_dt)
        factor = "" if self.scale is None else f" times --scale {self.scale:g}"
        peak = "" if self.pga is None else f" scaled to --pga {self.pga:g}"
        with arguments.as_bad_input(f"--record{factor}{peak}: "):
            if self.pga is not None:
                return record.scaled_to(self.pga * GRAVITY)
            return record.scaled(1.0 if self.scale is None else self.scale)

    def _pulse(self) -> SinePulse:
        arguments.refuse_both(half_cycles=self.half_cycles, pulse=self.pulse)
        words = "a pulse requires both, or give --record, --tilt or --rate"
        amplitude_g, omega = arguments.required(words, amplitude=self.amplitude, omega=self.omega)
        with arguments.as_bad_input():
            return SinePulse.in_g(
                amplitude_g,
                omega=omega,
                half_cycles=self.half_cycles or PULSES[self.pulse or "full-sine"],
                phase=self.phase or 0.0,
            )

    def _upward(self) -> Motion | None:
        pulse = self._given("vertical_amplitude", "vertical_omega", "vertical_half_cycles")
        if self.vertical is not None:
            arguments.refuse_given(pulse, "only without --vertical")
            how = self.units, self.baseline, self.record_dt
            return read_record(self.vertical, *how, option="--vertical")
        if set(pulse.values()) == {None}:
            return None
        amplitude_g, omega = arguments.required(
            "a vertical pulse requires both",
            vertical_amplitude=self.vertical_amplitude,
            vertical_omega=self.vertical_omega,
        )
        cycles = self.vertical_half_cycles or PULSES["full-sine"]
        with arguments.as_bad_input("--vertical-"):
            return SinePulse.in_g(amplitude_g, omega=omega, half_cycles=cycles)

    def _start(self, block: System, motion: Motion) -> tuple[float, float]:
        theta, rate = (self.tilt or 0.0) * block.alpha, (self.rate or 0.0) * block.alpha * block.p
        if not abs(theta) < 0.5 * math.pi:
            side = f"{0.5 * math.pi / block.alpha:.6g}"
            raise BadInputError(
                f"--tilt is {self.tilt:g}; it must lie between -{side} and {side} α, "
                "where the side of the block lies on the ground"
            )
        for name, given, value, least in (
            ("tilt", self.tilt, theta, LEAST_TILT * block.alpha),
            ("rate", self.rate, rate, LEAST),
        ):
            if given and not least <= abs(value) <= MOST:
                allowed = f"0, or of a size {least:.3g} to {MOST:g} in rad and s"
                raise BadInputError(f"--{name} is {given:g}; it must be {allowed}")
        if abs(theta) == block.alpha and rate == 0.0 == strongest(motion):
            words = "it must not be where a block at rest balances"
            raise BadInputError(f"--tilt is {self.tilt:g} and nothing moves; {words}")
        return theta, rate


MOST_M = 200.0
"""Size [m] up to which a block may be one; 300 are a narrow cabinet in millimetres."""

Width = Annotated[
    arguments.Positive, Parameter(help="Full width B of the block or of each column [m].")
]
Height = Annotated[
    arguments.Positive, Parameter(help="Full height H of the block or of each column [m].")
]

SceneName = Literal["block", "frame", "slide"]


def block_of(width: float, height: float) -> RigidBlock:
    """Return the block of --width and --height [m], or refuse one that was meant in millimetres."""
    for name, size in (("width", width), ("height", height)):
        if size > MOST_M:
            meant = f"in metres, as --{name} {1e-3 * size:g} for {size:g} mm"
            raise BadInputError(f"--{name} is {size:g}; it must be at most {MOST_M:g}, {meant}")
    with arguments.as_bad_input():
        return RigidBlock(width=width, height=height)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Standing:
    """What stands on the base."""

    scene: Annotated[SceneName, arguments.one_of(SceneName)] = "block"
    """block: one block that rocks. frame: a beam on columns that rock, of --width and --height
    each, with --load. slide: one block that slides, by a --friction below B/H."""
    columns: arguments.Count | None = None
    """Number of columns of a frame, from 2 to 100."""
    load: arguments.Positive | None = None
    """Mass of a frame's beam over the mass of all columns."""
    offset: arguments.Finite | None = None
    """Distance [m] of a block's mass to the right of the middle."""

    def system(self, width: float, height: float, friction: float | None) -> System:
        """Return the system that the options mean; of --friction only what slides knows."""
        beam = {"columns": self.columns, "load": self.load}
        if self.scene != "frame":
            arguments.refuse_given(beam, "only with --scene frame")
        if self.scene != "block":
            arguments.refuse_given({"offset": self.offset}, "only with --scene block")
        block = block_of(width, height)
        sizes = {"width": width, "height": height}
        with arguments.as_bad_input():
            if self.scene == "frame":
                words = "a frame requires the mass of its beam, over that of all columns"
                (load,) = arguments.required(words, load=self.load)
                return RockingFrame(**sizes, columns=self.columns or 2, load=load)
            if self.scene == "slide":
                words = "a block that slides requires one below B/H"
                (friction,) = arguments.required(words, friction=friction)
                return SlidingBlock(**sizes, friction=friction)
            return RigidBlock(**sizes, offset=self.offset) if self.offset else block


def window_of(
    block: System,
    motion: Motion,
    duration: float | None = None,
    *,
    p_dt: float | None = None,
    dt: float | None = None,
) -> float:
    """Return how long a block is watched [s]: as given, or the motion and 8/p."""
    if duration is not None and duration < motion.duration:
        least = f"the length of the motion, {motion.duration:.6g} s"
        raise BadInputError(f"--duration is {duration:g}; it must be at least {least}")
    watched_s = free_rocking_window(block, motion) if duration is None else duration
    most_s = MOST_TIME / block.p
    if watched_s > most_s:
        asked = f"--width is {block.width:g} and --height {block.height:g}; what moves the block"
        asked = asked if duration is None else f"--duration is {duration:g}; it"
        raise BadInputError(
            f"{asked} must last at most {most_s:.4g} s, {MOST_TIME:g} times 1/p, "
            f"and the block is watched for {watched_s:.4g} s"
        )
    for name, given, unit in (("p-dt", p_dt, 1.0 / block.p), ("dt", dt, 1.0)):
        if given is not None and watched_s > MOST_STEPS * given * unit:
            smallest = watched_s / (MOST_STEPS * unit)
            raise BadInputError(
                f"--{name} is {given:g}; it must be at least {smallest:.4g} for a run of "
                f"{watched_s:.4g} s, so that this takes at most {MOST_STEPS:g} steps"
            )
    return watched_s


def read_record(
    path: Path,
    units: str | None = None,
    baseline: Baseline | None = None,
    dt: float | None = None,
    *,
    insist: bool = True,
    option: str = "--record",
) -> Record:
    """Read a recorded ground acceleration [m/s2], as `Record.read` does, and correct it."""
    try:
        record = Record.read(path, units, dt, insist=insist)
    except ValueError as error:
        problem = re.sub(r"; units(?= must)", "; --units", str(error).removeprefix("path"))
        problem = re.sub(r"; dt(?=,| must not)", "; --record-dt", problem)
        raise BadInputError(f"{option}{problem}") from error
    with arguments.as_bad_input(f"{option} is {str(path)!r}; "):
        if baseline == "constant" or baseline == "linear":
            record = record.detrended(baseline)
        if record.peak == 0.0:
            raise ValueError("it is zero throughout, and must not be")
    down = re.search(r",\s*(DWN|DOWN)\b", path.read_text(errors="replace")[:999], re.IGNORECASE)
    return record.scaled(-1.0) if down and option == "--vertical" else record


def baseline_note(record: Record, baseline: str | None) -> str:
    """Say how a record was corrected, and what velocity it leaves the base with, if any."""
    words = [] if baseline in (None, "none") else [f"baseline corrected by detrend, {baseline}"]
    largest = float(np.abs(record.velocity(record.breakpoints)).max())
    if abs(record.final_velocity) > 1e-6 * largest:  # less is rounding
        part = abs(record.final_velocity) / largest
        words.append(
            f"the record's velocity ends at {record.final_velocity:.3g} m/s, {part:.2g} of its "
            "largest, and the base keeps it" + ("" if words else "; --baseline corrects it")
        )
    return "; ".join(words)
