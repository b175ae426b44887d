"""Bodies as outlines: moving pictures of what stands on a base, and that of the front page."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from tqdm import tqdm

from analytic import Outcome, RigidBlock
from analytic.motion import FloatArray, Motion
from engines.scene import System, layout_of
from studies.drawing.styles import full_name, style_of
from studies.kit.jobs import Row
from studies.kit.pictures import lay_out
from studies.kit.say import signed
from studies.kit.tables import draft
from studies.measures.presets import is_engine, look_of, preset_of

INK, SOFT, GROUND, GHOST = "#1b1b1b", "#666666", "#d9d9d4", "#c9c9c9"
MAGNIFIED = 2.5
"""How many times their size the rotations of the outlines are drawn."""
HELD_S = 1.0
"""How long a film stays at its end [s], where its verdicts are read."""
POST_M = 0.5
"""Distance [m] of posts that stand still behind the base, so that its motion is seen."""


def outlines(system: System, at: float) -> FloatArray:
    """Return the corners [m] of every body, (bodies, 4, 2), at a rotation [rad] or a place [m]."""
    corners = []
    for body in layout_of(system, 1.0, None, (at, 0.0)).bodies:
        x, z = 0.5 * body.width, 0.5 * body.height
        sine, cosine = math.sin(body.at.theta), math.cos(body.at.theta)
        box = np.array([[-x, -z], [x, -z], [x, z], [-x, z]])
        turned = box @ np.array([[cosine, -sine], [sine, cosine]])
        corners.append(turned + np.array([body.at.x, body.at.z]))
    return np.array(corners)


def draw_hero(block: RigidBlock, samples: pd.DataFrame, lines: pd.DataFrame) -> Figure:
    """Draw the outlines at the exact solution's largest rotation, above all histories."""
    drawing = Figure(figsize=(10.0, 6.0), layout="constrained")
    upper, lower = drawing.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.25))[:, 0]
    wide = samples.pivot(index="time_s", columns="source", values="theta_ratio")
    instant = wide.index[int(wide["exact"].abs().to_numpy().argmax())]
    at: dict[str, float] = wide.ffill().loc[instant].to_dict()
    others = lines[lines["source"] != "exact"].to_dict("records")
    for axes, line in zip(upper.subplots(1, len(others), sharey=True), others, strict=True):
        source, colour = line["source"], style_of(line["source"]).colour
        axes.set(xlim=(-1.15, 1.15), ylim=(-0.12, 1.75), aspect="equal")
        axes.set_axis_off()
        axes.add_patch(Rectangle((-1.15, -0.1), 2.3, 0.1, color=GROUND, linewidth=0))
        looks: list[tuple[float, dict[str, Any]]] = [
            (at["exact"], {"facecolor": GHOST, "edgecolor": "#8a8a8a", "linewidth": 0.8}),
            (at[source], {"fill": False, "edgecolor": colour, "linewidth": 2.2}),
        ]
        for ratio, look in looks:
            theta = np.clip(MAGNIFIED * ratio * block.alpha, -0.5 * math.pi, 0.5 * math.pi)
            axes.add_patch(Polygon(outlines(block, float(theta))[0], **look))
        axes.set_title(_title(source), fontsize=10, fontweight="bold")
        axes.text(0.5, -0.03, _verdict(line), transform=axes.transAxes, ha="center", va="top",
                  fontsize=11)  # fmt: skip
    axes = lower.subplots()
    for source in samples["source"].unique():
        axes.plot(wide.index, wide[source], **_look(source))
    top = max(1.15 * float(wide["exact"].abs().max()), 0.62)
    axes.set(xlim=(0.0, wide.index.max()), ylim=(-top, top), xlabel="time  [s]",
             ylabel="rotation  θ/θcr  [–]")  # fmt: skip
    axes.axvline(instant, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)))
    words = f" outlines above: rotations drawn {MAGNIFIED:g} times as large; exact in grey"
    axes.text(instant, -0.95 * top, words, fontsize=8.5, color=SOFT)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.grid(alpha=0.2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper right", fontsize=9, frameon=False, ncols=3)
    return drawing


def _verdict(line: dict[Any, Any]) -> str:
    return f"peak {signed(line['error'])}" if line["outcome"] == "rocked" else str(line["outcome"])


def _title(source: str) -> str:
    """Return the name of a source on this picture, whose floors are all at rest."""
    if source == "housner":
        return "Housner's linearization"
    return full_name(source).removesuffix(", floor at rest")


def _look(source: str) -> dict[str, Any]:
    """Return how a history is drawn: the exact one as a band on which tuned ones lie."""
    look = {"color": style_of(source).colour, "linewidth": 1.7, "label": _title(source)}
    if source == "exact":
        return look | {"color": GHOST, "linewidth": 7.0, "label": "exact", "zorder": 1}
    if not is_engine(source):
        return look | {"linestyle": "--"}
    return look | {"linestyle": look_of(preset_of(source)).line}


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
