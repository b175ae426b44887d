"""The chapters, the page, its equations and its figures; in a browser where there is one."""

import itertools
import json
import math
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from given import BLOCK, PULSE
from matplotlib.text import Text

from analytic import GRAVITY, RigidBlock, SinePulse, simulate
from engines import ENGINES
from engines.scene import free_rocking_window
from studies import respond
from studies.__main__ import run
from studies.drawing.figures import ONSETS
from studies.drawing.overturning import VERDICTS
from studies.drawing.styles import ENGINE_COLOURS, ENGINE_MARKERS, STYLES, look_at, title_of
from studies.kit.pictures import lay_out
from studies.measures.published import PUBLISHED
from studies.page import page
from studies.page.chapters import PARTS
from studies.page.page import AXES, engine_cases

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
SMALL = {
    "sweep": "--figure 6 --sources exact modified rk4",
    "histories": "--figure 4 --sources exact moreau",
}
"""Chapters that are quickly made, and their arguments here."""
SMALL_OF = {part.folder: part for part in PARTS}
FEW = 2
"""Rows of a table that the page shows here."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    parts = tuple(replace(SMALL_OF[f], quick=words) for f, words in SMALL.items())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(page, "PARTS", parts)
        patch.setattr(page, "CHAPTERS", {"A chapter": parts})
        patch.setattr(page, "SHOWN", FEW)
        assert page.command(out=folder) == 0
    return folder


class Links(HTMLParser):
    """Collects what a page would load or lead to, and the tags left open."""

    def __init__(self):
        super().__init__()
        self.addresses, self.open = [], []

    def handle_starttag(self, tag, attributes):
        self.addresses += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("meta", "img", "link", "br", "input"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_a_page_has_a_tile_for_each_preset_and_cases_to_try(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "CHAPTERS", {})
    page.write_page(tmp_path / "report.html", PUBLISHED, full=True)
    tiles, _, rest = (tmp_path / "report.html").read_text().partition('id="try-cases">')
    assert tiles.count("MuJoCo") == 1 and " 960 cases" in tiles
    assert "mujoco:default" in json.loads(rest.partition("</script>")[0])["peaks"]


def test_the_page_holds_all_it_shows(made):
    links = Links()
    links.feed((made / "report.html").read_text())
    assert links.open == []
    assert len(links.addresses) > 3
    assert all(address.startswith(("#", "data:image/")) for address in links.addresses)
    text = (made / "report.html").read_text()
    record = json.loads((made / "sweep" / "provenance.json").read_text())
    assert f"mujoco {record['engines']['mujoco']}" in text and "moreau" in text
    sweep = SMALL_OF["sweep"]
    assert sweep.study.finding(sweep.study.read(made / "sweep")) in text and sweep.weaker in text
    bodies = re.findall('<div class="scroll".*?<tbody>(.*?)</tbody>', text, re.DOTALL)
    assert max(body.count("<tr>") for body in bodies) == FEW
    assert f"The first {FEW} of 3 rows" in text


def test_the_engines_answers_are_those_of_the_tables():
    held = engine_cases(PUBLISHED)
    assert next(iter(held["peaks"])) == "exact"
    rows = pd.read_csv(PUBLISHED / "defaults" / "defaults.csv")
    cases = rows[rows["source"] == "mujoco:default"].reset_index(drop=True)
    places = itertools.product(*(held[name] for name in AXES))
    shown = dict(zip(places, held["peaks"]["mujoco:default"], strict=True))
    assert len(shown) == len(cases) > 1000
    assert held["rests"] == list(cases["rest_s"])
    for case in cases.iloc[::97].itertuples():
        half_cycles = {"half-sine": 1, "full-sine": 2}[case.pulse]
        peak = shown[half_cycles, case.aspect, case.width_m, case.onsets, case.omega_over_p]
        known = {"overturned": -1.0, "failed": None}
        assert peak == known.get(case.outcome, float(f"{case.peak_ratio:.5g}"))


def test_a_report_is_resumed_and_not_mixed(made, monkeypatch):
    with pytest.raises(page.FolderError, match="quick report"):
        page.command(out=made, full=True)


AMPLITUDE = 0.43333333 * GRAVITY
"""What the page shows first."""
WIDTHS = (390, 820, 1400)
PROBE = """<script>
const head = document.querySelector("table th button");
document.querySelectorAll("details").forEach(part => part.open = true);
const before = document.documentElement.scrollWidth;
head.click(); head.click();
const column = [...head.closest("table").tBodies[0].rows].map(row => row.cells[0].textContent);
const said = () => document.getElementById("try-outcome").textContent;
const first = said(), slider = document.getElementById("try-omega");
slider.value = 12.5;
slider.dispatchEvent(new Event("input"));
const then = said(), answers = document.getElementById("try-answers").rows;
const engines = [...answers].map(row => [...row.cells].map(cell => cell.textContent));
const pulses = document.getElementById("try-pulse");
pulses.value = "1";
pulses.dispatchEvent(new Event("input"));
const unasked = document.getElementById("try-engines").hidden;
const wide = before - window.innerWidth;
document.title = JSON.stringify({wide, column, first, then, engines, unasked});
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs a Chromium to look at the page")
@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_fits_its_window_and_sorts(made, tmp_path: Path, width):
    probed = tmp_path / "page.html"
    probed.write_text((made / "report.html").read_text().replace("</body>", PROBE + "</body>"))
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += [f"--user-data-dir={tmp_path}", f"--window-size={width},900", probed.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    seen = json.loads(re.search("<title>(.*)</title>", done.stdout)[1].replace("&quot;", '"'))
    assert seen["wide"] <= 0
    assert len(seen["column"]) > 1
    assert seen["column"] == sorted(seen["column"], reverse=True)
    for words, omega in ((seen["first"], 7.93185), (seen["then"], 12.5)):
        pulse = SinePulse(amplitude=AMPLITUDE, omega=omega, half_cycles=2)
        assert f"{simulate(BLOCK, pulse).peak_ratio:.6f}" in words


ENGINE = "quickjs"  # it has no wheel for Python 3.13
SCRIPT = Path(page.__file__).with_name("rocking.js").read_text(encoding="utf-8")
# the truncation of 400 classical Runge-Kutta steps in a time 1/p, through a few impacts
TOLERANCE = 1e-7

# (B, H, amplitude in g, rad/s, half cycles), and what the exact solution says
CASES = [
    (0.5, 1.5, 0.4, 6.2832, 2, "rocked"),
    (0.5, 3.0, 0.2, 6.2832, 1, "rocked"),
    (0.5, 1.0, 0.6, 6.2832, 2, "rocked"),
    (0.5, 1.5, 0.45, 4.0, 2, "overturned"),
    (0.5, 1.5, 0.32, 5.0, 2, "at rest"),
    (0.5, 1.5, 0.34, 5.0, 2, "rocked"),
    (2.0, 4.0, 4.0, 12.0, 1, "overturned"),
    (1.0, 1.0, 1.3, 9.0, 3, "rocked"),
    (0.3, 0.24, 1.5, 9.0, 2, "rocked"),
    (1.0, 4.0, 0.9, 8.0, 7, "overturned"),
    (1.0, 4.0, 2.2, 20.0, 2, "rocked"),
]


def by_the_page(block, motion, times):
    call = (
        f"rock({block.alpha!r}, {block.restitution!r}, pulse({motion.amplitude / block.gravity!r},"
        f" {motion.omega / block.p!r}, {motion.half_cycles}), {float(times[-1]) * block.p!r},"
        f" {(times * block.p).tolist()})"
    )
    engine = pytest.importorskip(ENGINE).Context()
    engine.eval(SCRIPT)
    found = json.loads(engine.eval(f"JSON.stringify({call})"))
    return found | {"peak": math.inf if found["peak"] is None else found["peak"]}


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, case[:5])))
def test_the_page_solves_the_exact_equations(case):
    width, height, amplitude_g, omega, half_cycles, outcome = case
    block = RigidBlock(width=width, height=height)
    motion = SinePulse(amplitude=amplitude_g * block.gravity, omega=omega, half_cycles=half_cycles)
    times = np.linspace(0.0, free_rocking_window(block, motion), 301)
    right = simulate(block, motion, duration=float(times[-1]), times=times)
    assert right.outcome.value == outcome
    found = by_the_page(block, motion, times)
    assert found["outcome"] == outcome
    assert found["peak"] / block.alpha == pytest.approx(right.peak_ratio, abs=TOLERANCE)
    if outcome != "overturned":
        assert found["impacts"] == len(right.impacts)
    shown = np.array(found["samples"])
    assert len(shown) == len(right.history.theta)
    assert shown / block.alpha == pytest.approx(right.history.theta / block.alpha, abs=TOLERANCE)


@pytest.mark.parametrize("source", ["exact", "mujoco:default"])
def test_the_commands_of_the_page_ask_what_it_shows(source, capsys, tmp_path):
    engine = pytest.importorskip(ENGINE).Context()
    write = str(source != "exact").lower()
    engine.eval(SCRIPT)
    values = f"0.5, 3, 2, 0.4, 6.2832, '{source}', {write}"
    compare, *export = json.loads(engine.eval(f"JSON.stringify(commands({values}))"))
    assert run([*compare.split()[1:], "--json", "--jobs", "1"]) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    peak = respond(source, BLOCK, PULSE).peak_ratio
    assert (found["source"], found["peak_ratio"]) == (source, pytest.approx(peak, rel=1e-9))
    for line in export:
        assert run(line.replace("DIR", str(tmp_path)).split()[1:]) == 0
        assert f"{peak:.12g}" in capsys.readouterr().out


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
