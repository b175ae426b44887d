"""Figures: who is told from whom."""

import itertools

import numpy as np
import pytest
from matplotlib.text import Text

from engines import ENGINES
from studies.drawing.figures import ONSETS
from studies.drawing.overturning import VERDICTS
from studies.drawing.styles import ENGINE_COLOURS, ENGINE_MARKERS, STYLES, look_at, title_of
from studies.kit.pictures import lay_out
from studies.measures.published import PUBLISHED
from studies.page.chapters import PARTS

# Machado, Oliveira and Fernandes, 2009, table 1, severity 1: linear RGB to those without a cone
CONES = {
    "all three cones": "1 0 0  0 1 0  0 0 1",
    "protanopia": "0.152286 1.052583 -0.204868  0.114503 0.786281 0.099216  "
    "-0.003882 -0.048116 1.051998",
    "deuteranopia": "0.367322 0.860646 -0.227968  0.280085 0.672501 0.047413  "
    "-0.011820 0.042940 0.968881",
    "tritanopia": "1.255528 -0.076749 -0.178779  -0.078411 0.930809 0.147602  "
    "0.004733 0.691367 0.303900",
}
VISIONS = {name: np.array(words.split(), float).reshape(3, 3) for name, words in CONES.items()}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
APART = 15.0
"""Distance in CIELAB from which two colours are told apart at a glance; 2.3 is just seen."""


def seen(colour, vision):
    """Return a colour in CIELAB, as somebody with that vision sees it."""
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ (VISIONS[vision] @ linear).clip(0.0, 1.0) / TO_XYZ.sum(axis=1)
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


def distance(one, other, vision):
    return np.linalg.norm(seen(one, vision) - seen(other, vision))


@pytest.mark.parametrize("vision", VISIONS)
def test_sources_are_told_apart_by_colour_line_or_marker(vision):
    looks = {name: (style.colour, style.line) for name, style in STYLES.items()}
    looks |= {f"engine {i}": look_at(i) for i in range(12)}
    alike = [
        (first, second)
        for first, second in itertools.combinations(looks, 2)
        if looks[first][1] == looks[second][1]
        and distance(looks[first][0], looks[second][0], vision) < APART
    ]
    assert alike == []
    for areas in (VERDICTS, ONSETS):
        pairs = itertools.combinations([colour for colour, _ in areas.values()], 2)
        assert min(distance(*pair, vision) for pair in pairs) > APART


def test_no_engine_takes_the_look_of_another():
    most = len(ENGINE_COLOURS) * len(ENGINE_MARKERS)
    assert len({look_at(place) for place in range(most)}) == most > 70
    assert len({look_at(place)[0] for place in range(8)}) == 8


def words_of(drawing):
    """Return the words written in a figure as it is laid out, with their boxes."""
    lay_out(drawing)
    drawing.draw_without_rendering()
    unseen = [
        label
        for axes in drawing.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in axis.get_major_ticks() + axis.get_minor_ticks()
        if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
        for label in (tick.label1, tick.label2)
    ]
    texts = [
        text
        for text in drawing.findobj(Text)
        if text.get_visible() and text.get_text() and text not in unseen
    ]
    return [(text.get_text(), text.get_window_extent()) for text in texts]


NAMING = ("precision", "contact", "advice", "validate", "restitution", "stability", "scenes")


@pytest.mark.parametrize("part", [part for part in PARTS if part.folder in NAMING])
def test_a_redrawn_picture_names_every_engine_and_clips_no_words(part):
    for drawing in part.study.figures(part.study.read(PUBLISHED / part.folder)).values():
        found = words_of(drawing)
        titles = [title_of(name) for name in ENGINES]
        asked = [title for title in titles if any(title in words for words, _ in found)]
        assert len(asked) >= 6
        assert not [name for name in ENGINES if any(words == name for words, _ in found)
                    and name not in titles]  # fmt: skip
        width, height = drawing.canvas.get_width_height()
        clipped = [
            words for words, box in found
            if box.width and (box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1
                              or box.y1 > height + 1)
        ]  # fmt: skip
        assert clipped == []
