"""Moving pictures of what stands on a base: the bodies above, how they move below."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image
from tqdm import tqdm

from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from engines.layouts import System, layout_of
from studies.drawing.block import outlines
from studies.drawing.styles import line_of, style_of
from studies.old.arguments import BadInputError, check_writable
from studies.old.drafts import draft_place
from studies.old.journal import Row

HELD_S = 1.5
"""How long a film stays at its end [s], where its verdicts are read."""

UNDITHERED = Image.Dither.NONE
"""Every pixel in the colour nearest to it: mixed of dots it would flicker from frame to frame."""

POSTS = 9
"""Posts that stand still behind the base, so that its motion is seen."""


def check_film(path: Path) -> None:
    """Raise BadInputError unless a film can be written to `path`."""
    if path.suffix not in (".gif", ".mp4"):
        raise BadInputError(f"--out is {str(path)!r}; it must end in .gif or .mp4")
    if not path.parent.is_dir():
        raise BadInputError(f"--out is {str(path)!r}; its folder must exist")
    check_writable("--out", path)
    if path.suffix == ".mp4":
        _ffmpeg()


def _ffmpeg() -> str:
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise BadInputError(
            "--out is an .mp4; that needs the extra [video]: pip install imageio-ffmpeg"
        ) from error
    return str(get_ffmpeg_exe())


def write_film(
    path: Path,
    block: System,
    motion: Motion,
    times: FloatArray,
    rows: Sequence[Row],
    frames_a_second: int,
) -> None:
    """Write the film in one piece, a frame for each time.

    Parameters
    ----------
    path : Path
        A .gif or .mp4.
    block, motion
        What is shown.
    times : ndarray, shape (n,)
        Ground times [s], equally spaced.
    rows : sequence of Row
        Each with its source, outcome, and "theta", shape (n,): the rotation [rad], or the place
        [m] of what slides.
    frames_a_second : int
    """
    stage = Stage(block, motion, times, rows)
    with draft_place(path) as part:
        if path.suffix == ".gif":
            _roll(stage, GifWriter(fps=frames_a_second), part, dpi=80)
        else:
            with rc_context({"animation.ffmpeg_path": _ffmpeg()}):
                _roll(stage, FFMpegWriter(fps=frames_a_second, bitrate=1800), part, dpi=110)


def _roll(stage: "Stage", writer: AbstractMovieWriter, path: Path, dpi: int) -> None:
    """Write every frame of a stage, and say how far it is."""
    stage.drawing.set_dpi(dpi)
    with writer.saving(stage.drawing, path, dpi):
        stage.drawing.still(stage.moving)
        for frame in tqdm(range(len(stage.times)), disable=None, unit="frame"):
            stage.show(frame)
            writer.grab_frame()
        for _ in range(round(HELD_S * writer.fps)):
            writer.grab_frame()


class GifWriter(PillowWriter):
    """Writes a film with one palette: finding one for each frame takes longer than drawing it."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the frames, in the 256 colours that fill most of the first, middle and last."""
        frames = [frame.convert("RGB") for frame in self._frames]
        seen = [frames[0], frames[len(frames) // 2], frames[-1]]
        sheet = Image.fromarray(np.concatenate([np.asarray(frame) for frame in seen]))
        counted = sheet.getcolors(sheet.width * sheet.height) or []
        colours: dict[Any, Any] = {}
        for _, colour in sorted(counted, reverse=True):
            # pixels are matched in steps of four: of what is nearly alike the most frequent stays
            colours.setdefault(tuple(np.array(colour) >> 3), colour)
        palette = Image.new("P", (1, 1))
        palette.putpalette([part for colour in [*colours.values()][:256] for part in colour])
        first, *others = (frame.quantize(palette=palette, dither=UNDITHERED) for frame in frames)
        first.save(self.outfile, save_all=True, append_images=others,
                   duration=int(1000 / self.fps), loop=0)  # fmt: skip


class Screen(Figure):
    """A figure in which little moves: all else is drawn once, and put back before each frame."""

    def still(self, moving: Sequence[Artist]) -> None:
        """Draw everything but what is moving, which is drawn over it in this order."""
        self._moving = moving
        for artist in moving:
            artist.set_animated(True)
        self._agg = FigureCanvasAgg(self)
        self._agg.draw()
        self._still = self._agg.copy_from_bbox(self.bbox)

    def savefig(self, fname: Any, **_: Any) -> None:
        """Write the present frame, as a writer of films asks for it: its pixels, nothing else."""
        self._agg.restore_region(self._still)
        for artist in self._moving:
            artist.draw(self._agg.get_renderer())
        fname.write(self._agg.buffer_rgba())


def turns(block: System) -> bool:
    """Say whether what is shown turns, and does not slide."""
    return bool(layout_of(block, 1.0, None, (0.0, 0.0)).rocking)


class Panel:
    """One source: its bodies, the exact outline over them, and its verdict, above a ground.

    Posts behind it pass as the ground moves.
    """

    def __init__(self, axes: Axes, block: System, row: Row, exact: FloatArray | None) -> None:
        reach, top = axes.get_xlim()[1], axes.get_ylim()[1]
        colour = style_of(row["source"]).colour
        axes.set_axis_off()
        axes.set_title(row["source"], fontsize=9)
        self._block, self._top = block, top
        self._spacing = 2.0 * reach / (POSTS - 1)
        ground = Rectangle((-2.0 * reach, -0.25 * reach), 4.0 * reach, 0.25 * reach)
        ground.set_color("#9a9a9a")
        posts = axes.vlines(self._places(0.0), 0.0, top, color="#e4e4e4", linewidth=2, zorder=0)
        self._posts: Any = posts
        at_rest = [*outlines(block, 0.0)]
        bodies = PolyCollection(at_rest, facecolor=colour, edgecolor="#222222", alpha=0.8, zorder=3)
        axes.add_collection(bodies)
        self._shown: list[tuple[Any, FloatArray]] = [(bodies, row["theta"])]
        if exact is not None and row["source"] != "exact":
            ghost = PolyCollection(at_rest, facecolor="none", edgecolor="#000000",
                                   linestyle=(0, (3, 2)), linewidth=1.2, zorder=4)  # fmt: skip
            axes.add_collection(ghost)
            self._shown.append((ghost, exact))
        self._told = verdict(row, exact, block.alpha) if turns(block) else ended(row, exact)
        self._verdict = axes.text(0.5, 0.98, "", transform=axes.transAxes, ha="center", va="top",
                                  fontsize=9, color=colour, fontweight="bold")  # fmt: skip
        self.moving: list[Artist] = [
            *(posts, axes.add_patch(ground)),  # the ground hides the feet of the posts
            *(*(bodies for bodies, _ in self._shown), self._verdict),
        ]

    def _places(self, shift: float) -> FloatArray:
        places = (np.arange(POSTS + 2, dtype=np.float64) - 0.5 * (POSTS + 1)) * self._spacing
        moved: FloatArray = places - math.fmod(shift, self._spacing)
        return moved

    def show(self, frame: int, shift: float) -> None:
        """Set the panel to a frame, in which the ground is off by a shift [m]."""
        for bodies, theta in self._shown:
            bodies.set_verts(outlines(self._block, float(theta[frame])))
        self._posts.set_segments([[(x, 0.0), (x, self._top)] for x in self._places(shift)])
        since, words = self._told
        self._verdict.set_text(words if frame >= since else "")


class Stage:
    """A figure that can show any time of the responses.

    Bodies that rock together are drawn as the first one turns.
    """

    def __init__(
        self, block: System, motion: Motion, times: FloatArray, rows: Sequence[Row]
    ) -> None:
        self.times, self._shift = times, motion.displacement(times)
        most = 0.0 if turns(block) else max(float(np.abs(row["theta"]).max()) for row in rows)
        at_rest = outlines(block, 0.0).max(axis=(0, 1))
        spare = 1.15 * math.hypot(block.width, block.height)
        reach = float(at_rest[0]) - 0.5 * block.width + spare + most
        top = float(at_rest[1]) - block.height + 1.2 * spare
        self.drawing = Screen(figsize=(2.1 * max(len(rows), 3), 5.2), layout="constrained")
        halves = self.drawing.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.1))
        upper, lower = halves[:, 0]
        look = {"xlim": (-reach, reach), "ylim": (-0.25 * reach, top), "aspect": "equal"}
        grid = upper.subplots(1, len(rows), sharey=True, squeeze=False, subplot_kw=look)[0]
        exact = next((row["theta"] for row in rows if row["source"] == "exact"), None)
        panels = zip(grid, rows, strict=True)
        self._panels = [Panel(axes, block, row, exact) for axes, row in panels]
        self._clock = self._graph(lower.subplots(), block, motion, rows)

    @property
    def moving(self) -> list[Artist]:
        """What differs from frame to frame, and the ground that hides the feet of the posts."""
        return [*(artist for panel in self._panels for artist in panel.moving), self._clock]

    def show(self, frame: int) -> None:
        """Set the figure to a frame."""
        for panel in self._panels:
            panel.show(frame, float(self._shift[frame]))
        self._clock.set_xdata([self.times[frame]] * 2)

    def _graph(self, axes: Axes, block: System, motion: Motion, rows: Sequence[Row]) -> Any:
        rocks = turns(block)
        for row in rows:
            style = style_of(row["source"])
            axes.plot(
                self.times,
                row["theta"] / (block.alpha if rocks else 1.0),
                linestyle=line_of(row["source"]),
                linewidth=style.width,
                color=style.colour,
                alpha=0.9,
                label=row["source"],
            )
        axes.set_xlim(0.0, float(self.times[-1]))
        if motion.duration:
            axes.axvspan(0.0, motion.duration, color="#f2f2f2", zorder=-1, label="ground shakes")
        if rocks:
            axes.set_ylim(-1.6, 1.6)
            axes.axhline(1.0, color="#aaaaaa", linewidth=0.8)
            axes.axhline(-1.0, color="#aaaaaa", linewidth=0.8)
        axes.set_xlabel("time  [s]")
        axes.set_ylabel("rotation  θ/θcr  [–]" if rocks else "place on the base  [m]")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
        return axes.axvline(0.0, color="#cc0000", linewidth=1.0)


def verdict(row: Row, exact: FloatArray | None, alpha: float) -> tuple[int, str]:
    """Return from which frame on it is known what becomes of a block, and what is said then.

    Of a block that overturns, when it passes θcr for the last time; of others, at their peak.

    Parameters
    ----------
    row : Row
        With its source, outcome and theta [rad].
    exact : ndarray or None
        The exact rotation [rad] at the same times.
    alpha : float
        [rad]
    """
    size = np.abs(row["theta"])
    if row["outcome"] == Outcome.OVERTURNED.value:
        within = np.flatnonzero(size < alpha)
        since = int(within[-1]) + 1 if within.size else 0
        return min(since, size.size - 1), "overturned"
    peak = float(size.max())
    if peak == 0.0:
        return size.size - 1, "at rest"
    words = f"peak {peak / alpha:.2f} θcr"
    right = 0.0 if exact is None else float(np.abs(exact).max())
    if row["source"] != "exact" and 0.0 < right < alpha:
        off = peak / right - 1.0
        near = "peak within 0.1 %"  # of what frames can tell
        words = f"peak {off:+.1%}".replace("%", " %").replace("-", "−") if abs(off) > 1e-3 else near
    return int(size.argmax()), words


def ended(row: Row, exact: FloatArray | None) -> tuple[int, str]:
    """Return the last frame, and what is said then of a block that slid: where it lies."""
    place, last = float(row["theta"][-1]), len(row["theta"]) - 1
    if exact is None or row["source"] == "exact":
        return last, f"lies at {1e3 * place:+.1f} mm".replace("-", "−")
    return last, f"{1e3 * (place - float(exact[-1])):+.2g} mm off".replace("-", "−")
