"""A ground motion known by equally spaced samples, and straight between them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.accelerograms import read
from analytic.checks import finite, finite_result, measurable, positive
from analytic.motion import FloatArray

LEFT_OF_TREND = 1e-12
"""Part of a record that taking away its trend may leave of one that is nothing else."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """Ground acceleration that is linear between its samples.

    The first sample is taken at time zero, before which the base is at rest; the last one ends the
    motion, after which the base keeps its velocity. Where one of them is not zero the acceleration
    jumps there. Velocity and displacement are the exact integrals of the interpolant.

    Parameters
    ----------
    dt : float
        Time between samples [s].
    samples : array_like, shape (n,)
        Ground acceleration [m/s2], two samples at least; kept as an array that cannot be written.

    Raises
    ------
    ValueError
        If dt is not positive and finite, or there are not two finite samples; also where the
        displacement of the ground or the slope between two samples overflows.

    Examples
    --------
    >>> record = Record(dt=0.01, samples=[0.0, 4.0, -4.0, 0.0])
    >>> record.duration, float(record.acceleration(0.005))
    (0.03, 2.0)
    """

    dt: float
    samples: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", measurable("dt", self.dt))
        samples = np.array(self.samples, dtype=np.float64)
        if samples.ndim != 1 or samples.size < 2:
            raise ValueError(
                f"samples have the shape {samples.shape}; they must be a list of two or more"
            )
        bad = np.flatnonzero(~np.isfinite(samples))
        if bad.size:
            raise ValueError(f"samples[{bad[0]}] is {samples[bad[0]]}; it must be a finite number")
        most = float(np.abs(samples).max())
        cause = f"dt is {self.dt!r} and a sample {most!r}"
        finite_result("the displacement of the ground", most * (self.dt * samples.size) ** 2, cause)
        finite_result("the slope between samples", 2.0 * most / self.dt, cause)
        samples.flags.writeable = False
        object.__setattr__(self, "samples", samples)

    @classmethod
    def read(
        cls,
        path: str | Path,
        units: str | None = None,
        dt: float | None = None,
        *,
        insist: bool = True,
    ) -> "Record":
        """Read a recorded ground acceleration.

        Parameters
        ----------
        path : str or Path
            A PEER AT2 file, known by a header that says NPTS and DT; an ASC file of ESM or ITACA;
            samples alone, their number and step on a line "npts dt" above or their step given; or a
            table of two columns, time [s] and acceleration, separated by commas, semicolons or
            blanks, with or without a line of names, the first time becoming zero. Comments begin
            with # or %.
        dt : float, optional
            Time [s] between samples of a file that does not state its own.
        units : {"g", "mg", "m/s2", "cm/s2", "mm/s2", "gal"}, optional
            Needed where the file does not state its own.
        insist : bool, optional
            Whether a file must not state another step or unit than the given one; without, what it
            states holds.

        Raises
        ------
        ValueError
            If the file cannot be read or is of another format, its units are not known, a number is
            not finite, the count is not the stated one, steps are missing or not equal, or anything
            else in it leaves a doubt.
        """
        try:
            step, samples = read(Path(path), units, dt, insist)
            return cls(dt=step, samples=samples)
        except ValueError as problem:
            raise ValueError(f"path is {str(path)!r}; {problem}") from problem

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record):
            return NotImplemented
        return self.dt == other.dt and np.array_equal(self.samples, other.samples)

    def __hash__(self) -> int:
        return hash((self.dt, self.samples.tobytes()))

    @property
    def peak(self) -> float:
        """Largest absolute acceleration [m/s2]."""
        return float(np.abs(self.samples).max())

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return (self.samples.size - 1) * self.dt

    @property
    def final_velocity(self) -> float:
        """Velocity [m/s] that the base keeps after the record."""
        return float(self._velocities()[-1])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times of the samples [s]."""
        return tuple(self._times().tolist())

    def scaled(self, factor: float) -> "Record":
        """Return the record with its acceleration multiplied; a negative factor mirrors it."""
        with np.errstate(over="ignore"):
            return Record(dt=self.dt, samples=finite("factor", factor) * self.samples)

    def scaled_to(self, peak: float) -> "Record":
        """Return the record scaled to a largest absolute acceleration [m/s2], more than 0."""
        if self.peak == 0.0:
            raise ValueError("the record is zero throughout; it cannot be scaled to a peak")
        return self.scaled(positive("peak", peak) / self.peak)

    def detrended(self, kind: Literal["constant", "linear"]) -> "Record":
        """Return the record without its mean, or without the straight line that fits it best.

        By `scipy.signal.detrend`; ValueError if nothing but rounding is left. The first and the
        last sample become jumps, and the velocity need not end at zero exactly.
        """
        from scipy.signal import detrend

        left = Record(dt=self.dt, samples=detrend(self.samples / (self.peak or 1.0), type=kind))
        if left.peak <= LEFT_OF_TREND:
            raise ValueError(f"the record is its own {kind} trend; nothing is left without it")
        return left.scaled(self.peak)

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Ground acceleration [m/s2] at the times `t` [s]; zero before and after the record."""
        t = np.asarray(t, dtype=np.float64)
        i, since = self._place(t)
        during = (t >= 0.0) & (t <= self.duration)
        return np.where(during, self.samples[i] + self._slopes()[i] * since, 0.0)

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]; constant after the record."""
        i, since = self._place(np.asarray(t, dtype=np.float64))
        gained = since * (self.samples[i] + 0.5 * since * self._slopes()[i])
        return np.asarray(self._velocities()[i] + gained)

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]; linear after the record."""
        t = np.asarray(t, dtype=np.float64)
        i, since = self._place(t)
        velocities, a = self._velocities(), self.samples
        # over a step the mean of a'' s^2/2 of a straight line weighs its ends 2 to 1
        steps = self.dt * (velocities[:-1] + self.dt * (2.0 * a[:-1] + a[1:]) / 6.0)
        moved = np.concatenate(([0.0], np.cumsum(steps)))
        bend = 0.5 * since * since * (a[i] + since * self._slopes()[i] / 3.0)
        coasting = velocities[-1] * np.maximum(t - self.duration, 0.0)
        return np.asarray(moved[i] + velocities[i] * since + bend + coasting)

    def segments(self) -> FloatArray:
        """Rows of `SEGMENT_COLUMNS`: a straight line from each sample to the next."""
        times = self._times()
        rows = np.zeros((times.size - 1, 7))
        rows[:, 0], rows[:, 1] = times[:-1], times[1:]
        rows[:, 5], rows[:, 6] = self.samples[:-1], self._slopes()
        return rows

    def _times(self) -> FloatArray:
        return self.dt * np.arange(self.samples.size, dtype=np.float64)

    def _slopes(self) -> FloatArray:
        return np.diff(self.samples) / self.dt

    def _velocities(self) -> FloatArray:
        """Velocities at the samples: the trapezoidal rule is exact for straight lines."""
        steps = 0.5 * self.dt * (self.samples[:-1] + self.samples[1:])
        return np.concatenate(([0.0], np.cumsum(steps)))

    def _place(self, t: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Return the step that each time falls in, and the time [s] since its begin."""
        within = np.clip(t, 0.0, self.duration)
        i = np.minimum((within / self.dt).astype(np.intp), self.samples.size - 2)
        return i, within - i * self.dt
