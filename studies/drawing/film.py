"""Moving pictures of what stands on a base: the bodies above, how they move below."""

import math
from collections.abc import Iterator, Sequence
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from PIL import Image
from tqdm import tqdm

from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from engines.scene import System, layout_of
from studies.drawing.block import outlines
from studies.drawing.styles import line_of, style_of
from studies.kit.jobs import Row
from studies.kit.tables import draft

HELD_S = 1.5
"""How long a film stays at its end [s], where its verdicts are read."""
POSTS = 9
"""Posts that stand still behind the base, so that its motion is seen."""


def write_film(
    path: Path,
    system: System,
    motion: Motion,
    times: FloatArray,
    rows: Sequence[Row],
    frames_a_second: int,
) -> None:
    """Write a .gif or .mp4 in one piece, a frame for each of the equally spaced times [s].

    A row has its source, outcome and "theta": the rotation [rad] at each time, or the place [m] of
    what slides.
    """
    stage = Stage(system, motion, times, rows, dpi=80 if path.suffix == ".gif" else 120)
    with draft(path) as part:
        (_write_gif if path.suffix == ".gif" else _write_mp4)(part, stage, frames_a_second)


def _write_gif(path: Path, stage: "Stage", rate: int) -> None:
    """Write a film with one palette, undithered: others would flicker, and take long to find."""
    seen = [stage.picture(frame) for frame in (0, stage.count // 2, stage.count - 1)]
    sheet = Image.fromarray(np.concatenate(seen))
    plain = Image.Dither.NONE
    palette = sheet.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=plain)
    first, *others = (
        Image.fromarray(picture).quantize(palette=palette, dither=plain)
        for picture in stage.pictures()
    )
    each = 1000 // rate
    times = [each] * len(others) + [each + round(1000 * HELD_S)]
    first.save(path, save_all=True, append_images=others, duration=times, loop=0)


def _write_mp4(path: Path, stage: "Stage", rate: int) -> None:
    from imageio_ffmpeg import write_frames

    last = stage.picture(stage.count - 1)
    film = write_frames(path, last.shape[1::-1], fps=rate, bitrate="1800k", macro_block_size=2)
    film.send(None)
    for picture in chain(stage.pictures(), repeat(last, round(HELD_S * rate))):
        film.send(np.ascontiguousarray(picture))
    film.close()


class Stage:
    """A figure that can show any time of the responses; what stands still is drawn once.

    Bodies that rock together are drawn as the first one turns.
    """

    def __init__(
        self, system: System, motion: Motion, times: FloatArray, rows: Sequence[Row], dpi: int = 80
    ) -> None:
        self._times, self._shift = times, motion.displacement(times)
        self.count = len(times)
        self.figure = Figure(figsize=(2.1 * max(len(rows), 3), 5.2), dpi=dpi, layout="constrained")
        upper, lower = self.figure.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.1))[:, 0]
        self._panels = _panels(upper, system, rows)
        self._clock = _graph(lower.subplots(), system, motion, times, rows)
        self._moving = [*chain(*(panel.moving for panel in self._panels)), self._clock]
        for artist in self._moving:
            artist.set_animated(True)
        self._canvas = FigureCanvasAgg(self.figure)
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self.figure.bbox)

    def pictures(self) -> Iterator[NDArray[np.uint8]]:
        """Yield the picture of every time, and show how far it is."""
        for frame in tqdm(range(self.count), disable=None, unit="frame"):
            yield self.picture(frame)

    def picture(self, frame: int) -> NDArray[np.uint8]:
        """Return the colours of a time, shape (height, width, 3)."""
        for panel in self._panels:
            panel.show(frame, float(self._shift[frame]))
        self._clock.set_xdata([self._times[frame]] * 2)
        self._canvas.restore_region(self._still)
        for artist in self._moving:
            artist.draw(self._canvas.get_renderer())
        return np.array(self._canvas.buffer_rgba())[..., :3]


class Panel:
    """One source: its bodies, the exact outline over them, and its verdict, above a ground.

    Posts behind it pass as the ground moves.
    """

    def __init__(self, axes: Axes, system: System, row: Row, exact: FloatArray | None) -> None:
        reach, self._top = axes.get_xlim()[1], axes.get_ylim()[1]
        self._system, self._spacing = system, 2.0 * reach / (POSTS - 1)
        colour, at_rest = style_of(row["source"]).colour, [*outlines(system, 0.0)]
        axes.set_axis_off()
        axes.set_title(row["source"], fontsize=9)
        self._posts: Any = axes.vlines(self._places(0.0), 0.0, self._top, color="#e4e4e4", lw=2,
                                       zorder=0)  # fmt: skip
        low = (-2.0 * reach, -0.25 * reach), 4.0 * reach, 0.25 * reach
        ground = axes.add_patch(Rectangle(*low, color="#9a9a9a"))
        bodies = PolyCollection(at_rest, facecolor=colour, edgecolor="#222222", alpha=0.8, zorder=3)
        self._shown: list[tuple[Any, FloatArray]] = [(bodies, row["theta"])]
        if exact is not None:
            ghost = PolyCollection(at_rest, facecolor="none", edgecolor="#000000", linewidth=1.2,
                                   linestyle=(0, (3, 2)), zorder=4)  # fmt: skip
            self._shown.append((ghost, exact))
        self._since, self._words = verdict(row, exact, system)
        self._verdict = axes.text(0.5, 0.98, "", transform=axes.transAxes, ha="center", va="top",
                                  fontsize=9, color=colour, fontweight="bold")  # fmt: skip
        shown = [axes.add_collection(bodies) for bodies, _ in self._shown]
        # the ground hides the feet of the posts
        self.moving: list[Artist] = [self._posts, ground, *shown, self._verdict]

    def _places(self, shift: float) -> FloatArray:
        places = (np.arange(POSTS + 2, dtype=np.float64) - 0.5 * (POSTS + 1)) * self._spacing
        moved: FloatArray = places - math.fmod(shift, self._spacing)
        return moved

    def show(self, frame: int, shift: float) -> None:
        """Set the panel to a frame, in which the ground is off by a shift [m]."""
        for bodies, theta in self._shown:
            bodies.set_verts(outlines(self._system, float(theta[frame])))
        self._posts.set_segments([[(x, 0.0), (x, self._top)] for x in self._places(shift)])
        self._verdict.set_text(self._words if frame >= self._since else "")


def _panels(place: SubFigure, system: System, rows: Sequence[Row]) -> list[Panel]:
    most = 0.0 if turns(system) else max(float(np.abs(row["theta"]).max()) for row in rows)
    right, high = outlines(system, 0.0).max(axis=(0, 1))
    spare = 1.15 * math.hypot(system.width, system.height)
    reach = float(right) - 0.5 * system.width + spare + most
    top = float(high) - system.height + 1.2 * spare
    look = {"xlim": (-reach, reach), "ylim": (-0.25 * reach, top), "aspect": "equal"}
    grid = place.subplots(1, len(rows), sharey=True, squeeze=False, subplot_kw=look)[0]
    exact = next((row["theta"] for row in rows if row["source"] == "exact"), None)
    return [
        Panel(axes, system, row, None if row["source"] == "exact" else exact)
        for axes, row in zip(grid, rows, strict=True)
    ]


def _graph(
    axes: Axes, system: System, motion: Motion, times: FloatArray, rows: Sequence[Row]
) -> Any:
    """Draw how everything moves; return the line that marks the time."""
    rocks = turns(system)
    for row in rows:
        source, style = row["source"], style_of(row["source"])
        axes.plot(times, row["theta"] / (system.alpha if rocks else 1.0), line_of(source),
                  linewidth=style.width, color=style.colour, alpha=0.9, label=source)  # fmt: skip
    axes.set_xlim(0.0, float(times[-1]))
    if motion.duration:
        axes.axvspan(0.0, motion.duration, color="#f2f2f2", zorder=-1, label="ground shakes")
    if rocks:
        axes.set_ylim(-1.6, 1.6)
        for side in (1.0, -1.0):
            axes.axhline(side, color="#aaaaaa", linewidth=0.8)
    words = "rotation  θ/θcr  [–]" if rocks else "place on the base  [m]"
    axes.set(xlabel="time  [s]", ylabel=words)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
    return axes.axvline(0.0, color="#cc0000", linewidth=1.0)


def turns(system: System) -> bool:
    """Return whether what is shown turns, and does not slide."""
    return bool(layout_of(system, 1.0, None, (0.0, 0.0)).rocking)


def verdict(row: Row, exact: FloatArray | None, system: System) -> tuple[int, str]:
    """Return from which frame on it is known what becomes of a block, and what is written then.

    Of a block that overturns, when it passes θcr for the last time; of others, at their peak; of
    what slides, where it lies in the end. `exact` is the exact rotation at the same times.
    """
    theta, last = row["theta"], len(row["theta"]) - 1
    beside = exact if exact is not None and row["source"] != "exact" else None
    if not turns(system):
        off = 1e3 * (theta[-1] - (0.0 if beside is None else beside[-1]))
        words = f"lies at {off:+.1f} mm" if beside is None else f"{off:+.2g} mm off"
        return last, words.replace("-", "−")
    size = np.abs(theta)
    if row["outcome"] == Outcome.OVERTURNED.value:
        within = np.flatnonzero(size < system.alpha)
        return min(int(within[-1]) + 1 if within.size else 0, last), "overturned"
    peak = float(size.max())
    if peak == 0.0:
        return last, "at rest"
    right = 0.0 if beside is None else float(np.abs(beside).max())
    if not 0.0 < right < system.alpha:
        return int(size.argmax()), f"peak {peak / system.alpha:.2f} θcr"
    off = peak / right - 1.0
    if abs(off) <= 1e-3:  # all that frames can tell
        return int(size.argmax()), "peak within 0.1 %"
    return int(size.argmax()), f"peak {off:+.1%}".replace("%", " %").replace("-", "−")
