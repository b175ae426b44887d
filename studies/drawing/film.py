"""Moving pictures of what stands on a base."""

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from tqdm import tqdm

from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from engines.scene import System, layout_of
from studies.drawing.block import outlines
from studies.drawing.styles import style_of
from studies.kit.jobs import Row
from studies.kit.pictures import lay_out
from studies.kit.tables import draft

HELD_S = 1.0
"""How long a film stays at its end [s], where its verdicts are read."""
POST_M = 0.5
"""Distance [m] of posts that stand still behind the base, so that its motion is seen."""


def write_film(
    path: Path, system: System, motion: Motion, times: FloatArray, rows: Sequence[Row], rate: int
) -> None:
    """Write a .gif or .mp4 in one piece, a frame for each of the times [s], `rate` of them 1/s."""
    stage = Stage(system, motion, times, rows)
    writer: AbstractMovieWriter = PillowWriter(fps=rate)
    if path.suffix == ".mp4":
        from imageio_ffmpeg import get_ffmpeg_exe

        mpl.rcParams["animation.ffmpeg_path"] = get_ffmpeg_exe()
        writer = FFMpegWriter(fps=rate)
    with draft(path) as part, writer.saving(stage.figure, str(part), dpi=80):
        for frame in tqdm(range(len(times)), disable=None, unit="frame"):
            stage.show(frame)
            writer.grab_frame()
        for _ in range(round(HELD_S * rate)):
            writer.grab_frame()


class Stage:
    """A figure that can show any time of the responses: a panel for each, and the clock."""

    def __init__(
        self, system: System, motion: Motion, times: FloatArray, rows: Sequence[Row]
    ) -> None:
        self._times, self._shift = times, motion.displacement(times)
        self.figure = Figure(figsize=(2.1 * max(len(rows), 3), 2.9), layout="constrained")
        most = 0.0 if turns(system) else max(float(np.abs(row["theta"]).max()) for row in rows)
        right, high = outlines(system, 0.0).max(axis=(0, 1))
        spare = 1.15 * math.hypot(system.width, system.height)
        reach = float(right) - 0.5 * system.width + spare + most
        top = float(high) - system.height + 1.2 * spare
        look = {"xlim": (-reach, reach), "ylim": (-0.25 * reach, top), "aspect": "equal"}
        grid = self.figure.subplots(1, len(rows), sharey=True, squeeze=False, subplot_kw=look)[0]
        exact = next((row["theta"] for row in rows if row["source"] == "exact"), None)
        self._panels = [
            Panel(axes, system, row, None if row["source"] == "exact" else exact)
            for axes, row in zip(grid, rows, strict=True)
        ]
        self._clock = self.figure.supxlabel("time", fontsize=9)
        lay_out(self.figure)

    def show(self, frame: int) -> None:
        """Set the figure to a frame."""
        for panel in self._panels:
            panel.show(frame, float(self._shift[frame]))
        self._clock.set_text(f"{self._times[frame]:.2f} s")


class Panel:
    """One source: its bodies, the exact outline over them, and its verdict, above the ground."""

    def __init__(self, axes: Axes, system: System, row: Row, exact: FloatArray | None) -> None:
        self._axes, self._system, self._reach = axes, system, axes.get_xlim()[1]
        colour, top = style_of(row["source"]).colour, axes.get_ylim()[1]
        axes.set_axis_off()
        axes.set_title(row["source"], fontsize=9)
        posts = POST_M * np.arange(-200.0, 201.0)
        axes.vlines(posts, 0.0, top, color="#e4e4e4", lw=2, zorder=0)
        axes.axhspan(-self._reach, 0.0, color="#9a9a9a")
        own = PolyCollection([], facecolor=colour, edgecolor="#222222", alpha=0.8, zorder=3)
        self._bodies = [(own, row["theta"])]
        if exact is not None:
            ghost = PolyCollection([], facecolor="none", edgecolor="#000000", ls="--", zorder=4)
            self._bodies.append((ghost, exact))
        for bodies, _ in self._bodies:
            axes.add_collection(bodies)
        self._since, self._words = verdict(row, system)
        self._verdict = axes.text(0.5, 0.98, "", transform=axes.transAxes, ha="center", va="top",
                                  fontsize=9, color=colour, fontweight="bold")  # fmt: skip

    def show(self, frame: int, shift: float) -> None:
        """Set the panel to a frame, in which the ground is off by a shift [m]."""
        for bodies, theta in self._bodies:
            bodies.set_verts(outlines(self._system, float(theta[frame])) + np.array([shift, 0.0]))
        self._axes.set_xlim(shift - self._reach, shift + self._reach)
        self._verdict.set_text(self._words if frame >= self._since else "")


def turns(system: System) -> bool:
    """Return whether what is shown turns, and does not slide."""
    return bool(layout_of(system, 1.0, None, (0.0, 0.0)).rocking)


def verdict(row: Row, system: System) -> tuple[int, str]:
    """Return from which frame on it is known what becomes of a block, and what is written then."""
    theta, last = row["theta"], len(row["theta"]) - 1
    if not turns(system):
        return last, f"lies at {1e3 * theta[-1]:+.1f} mm"
    size = np.abs(theta) / system.alpha
    if row["outcome"] == Outcome.OVERTURNED.value:
        since = int(max(np.flatnonzero(size < 1.0), default=-1)) + 1
        return min(since, last), "overturned"
    return (int(size.argmax()), f"peak {size.max():.2f} θcr") if size.any() else (last, "at rest")
