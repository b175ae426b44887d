"""From the options of a command line to a block and the motion of its base."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analytic.block import STANDARD_GRAVITY, RigidBlock
from analytic.motion import Motion, SinePulse
from analytic.record import Record
from studies.cases.accelerograms import Baseline, corrected, read_record
from studies.cases.paper import PULSES
from studies.kit.arguments import BadInputError, as_bad_input, refuse_given


def _half_cycles(pulse: str | None, half_cycles: int | None) -> int:
    if pulse and half_cycles:
        raise BadInputError(
            f"--half-cycles is {half_cycles} and --pulse is {pulse}; give one or the other"
        )
    return half_cycles or PULSES[pulse or "full-sine"]


def posed_block(width: float, height: float) -> RigidBlock:
    """Return the block of --width and --height."""
    with as_bad_input():
        return RigidBlock(width=width, height=height)


def posed_pulse(
    amplitude: float | None, omega: float | None, pulse: str | None, half_cycles: int | None
) -> SinePulse:
    """Return the pulse of --amplitude, --omega and either --pulse or --half-cycles."""
    number = _half_cycles(pulse, half_cycles)
    if amplitude is None or omega is None:
        missing = " and ".join(
            name for name, value in (("--amplitude", amplitude), ("--omega", omega)) if not value
        )
        raise BadInputError(f"{missing} missing; a pulse requires both, or give --record instead")
    with as_bad_input():
        return SinePulse.in_g(amplitude, omega=omega, half_cycles=number)


def posed_motion(pulse: Mapping[str, Any], record: Mapping[str, Any]) -> Motion:
    """Return the motion of the options of a pulse, or of a record where one is named.

    Parameters
    ----------
    pulse, record : mapping
        Option -> its value: amplitude, omega, pulse, half-cycles; record, units, scale, pga,
        baseline.
    """
    path, *rest = record.values()
    if path is None:
        refuse_given({name: record[name] for name in list(record)[1:]}, "only with --record")
        return posed_pulse(*pulse.values())
    refuse_given(pulse, "only without --record")
    return posed_record(path, *rest)


def posed_record(
    path: Path,
    units: str | None,
    scale: float | None,
    pga: float | None,
    baseline: Baseline | None = None,
) -> Record:
    """Return the record of --record and --units, corrected, then scaled by --scale or to --pga."""
    if scale is not None and pga is not None:
        raise BadInputError(f"--scale is {scale:g} and --pga is {pga:g}; give one or the other")
    record = read_record(path, units)
    with as_bad_input("--record: "):
        record = corrected(record, baseline)
        if pga is not None:
            return record.scaled_to(pga * STANDARD_GRAVITY)
        return record.scaled(1.0 if scale is None else scale)
