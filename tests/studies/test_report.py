"""The chapters, and the page that shows them, in a browser where there is one."""

import itertools
import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pandas as pd
import pytest
from given import BLOCK

from analytic import SinePulse, simulate
from analytic.block import GRAVITY
from studies.measures.published import PUBLISHED
from studies.page import chapters, page
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
        for module in (page, chapters):
            patch.setattr(module, "PARTS", parts)
        patch.setattr(page, "CHAPTERS", {"A chapter": parts})
        patch.setattr(page, "SHOWN", FEW)
        assert chapters.command(out=folder) == 0
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
    with pytest.raises(chapters.FolderError, match="quick report"):
        chapters.command(out=made, full=True)


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
