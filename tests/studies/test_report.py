"""The chapters, the page that shows them, its equations; in a browser where there is one."""

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

from analytic import RigidBlock, SinePulse, simulate
from analytic.block import GRAVITY
from engines.scene import free_rocking_window
from studies import respond
from studies.__main__ import run
from studies.measures.published import PUBLISHED
from studies.page import page
from studies.page.chapters import PARTS
from studies.page.page import AXES, engine_cases

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
SMALL = {
    "sweep": ("--figure", "6", "--sources", "exact", "modified", "rk4"),
    "histories": ("--figure", "4", "--sources", "exact", "moreau"),
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
    shown = dict(
        zip(
            itertools.product(*(held[name] for name in AXES)),
            held["peaks"]["mujoco:default"],
            strict=True,
        )
    )
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
    done = subprocess.run(
        [*command, f"--user-data-dir={tmp_path}", f"--window-size={width},900", probed.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
    )
    seen = json.loads(re.search("<title>(.*)</title>", done.stdout)[1].replace("&quot;", '"'))
    assert seen["wide"] <= 0
    assert len(seen["column"]) > 1
    assert seen["column"] == sorted(seen["column"], reverse=True)
    for words, omega in ((seen["first"], 7.93185), (seen["then"], 12.5)):
        peak = simulate(
            BLOCK, SinePulse(amplitude=AMPLITUDE, omega=omega, half_cycles=2)
        ).peak_ratio
        assert f"{peak:.6f}" in words


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
