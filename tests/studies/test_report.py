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
from studies.catalogue import CHAPTERS, STUDIES
from studies.measures.published import PUBLISHED
from studies.page import page, report
from studies.page.page import AXES, engine_cases

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
SMALL = {
    "sweep": ("--figure", "6", "--sources", "exact", "modified", "rk4"),
    "defaults": ("--quick", "--sources", "pybullet:naive"),
    "histories": ("--figure", "4", "--sources", "exact", "moreau"),
}
"""Chapters that are quickly made, and their arguments here."""
FEW = 2
"""Rows of a table that the page shows here."""


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.name)
def test_a_study_has_a_command_and_one_with_a_table_can_be_drawn_and_told(study):
    module = study.load()
    needed = ["command", *["finding"] * bool(study.table)]
    assert all(callable(getattr(module, name)) for name in needed)
    assert not study.chapters or study.table


def test_every_study_is_a_chapter_but_those_shown_elsewhere():
    shown = {study.name for study, _ in CHAPTERS}
    alone = {"compare", "blocks", "animate", "export", "cost", "score", "doctor"}
    assert {study.name for study in STUDIES} - shown == alone


def test_what_a_chapter_shows_is_what_its_study_writes():
    for study, chapter in CHAPTERS:
        assert set(chapter.tables) <= set(study.products), study.name


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        few = tuple(
            (study, replace(chapter, quick=SMALL[chapter.folder]))
            for study, chapter in CHAPTERS
            if chapter.folder in SMALL
        )
        patch.setattr(report, "CHAPTERS", few)
        patch.setattr(page, "CHAPTERS", few)
        patch.setattr(page, "SHOWN", FEW)
        assert report.command(out=folder) == 0
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


def test_an_engine_of_another_package_is_told_of_on_the_page(made):
    assert "moreau" in (made / "report.html").read_text()


def test_the_page_holds_all_it_shows(made):
    links = Links()
    links.feed((made / "report.html").read_text())
    assert links.open == []
    assert len(links.addresses) > 3
    assert all(address.startswith(("#", "data:image/")) for address in links.addresses)


def test_the_page_says_what_the_tables_say(made):
    text = (made / "report.html").read_text()
    summary = pd.read_csv(made / "sweep" / "summary.csv").set_index("source")
    line = next(summary.loc[["modified"]].itertuples())
    assert f"modified the fall wrong in {line.fall_wrong}." in text
    record = json.loads((made / "sweep" / "provenance.json").read_text())
    assert f"mujoco {record['engines']['mujoco']}" in text


def test_the_page_shows_the_first_rows_of_a_table_and_says_where_all_are(made):
    text = (made / "report.html").read_text()
    bodies = re.findall('<div class="scroll".*?<tbody>(.*?)</tbody>', text, re.DOTALL)
    assert max(body.count("<tr>") for body in bodies) == FEW
    rows = len(pd.read_csv(made / "sweep" / "summary.csv"))
    assert f"The first {FEW} of {rows} rows; all: sweep/summary.csv." in text
    tabular = re.findall('<pre tabindex="0">(.*?)</pre>', text, re.DOTALL)
    assert max(len(lines.splitlines()) for lines in tabular) == FEW + 2


def test_a_picture_is_described_and_what_is_weaker_is_said(made):
    text = (made / "report.html").read_text()
    described = re.findall('<img [^>]*alt="([^"]*)"', text)
    assert len(described) == 4
    assert all(len(words) > 60 for words in described)
    assert f"Weaker than the published form:</strong> {CHAPTERS[0][1].weaker}" in text


def test_captions_are_of_pictures_that_there_are():
    for study in STUDIES:
        assert {f"{name}.png" for name in study.captions} <= set(study.products)


def test_prose_is_told_from_tables():
    told = page.prose("A sentence.\n\nAnother.\n  a    b\n  1    2\nThe end.")
    assert told == [
        (False, ["A sentence.", "Another."]),
        (True, ["  a    b", "  1    2"]),
        (False, ["The end."]),
    ]


def test_the_engines_answers_are_those_of_the_tables():
    held = engine_cases(PUBLISHED)
    assert next(iter(held["peaks"])) == "exact"
    rows = pd.read_csv(PUBLISHED / "defaults" / "defaults.csv")
    cases = rows[rows["source"] == "mujoco:naive"].reset_index(drop=True)
    shown = dict(
        zip(
            itertools.product(*(held[name] for name in AXES)),
            held["peaks"]["mujoco:naive"],
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


@pytest.mark.parametrize("place", CHAPTERS, ids=lambda place: place[1].folder)
def test_what_failed_is_found_in_any_study_s_table(place):
    study, chapter = place
    found = page.failures(PUBLISHED / chapter.folder, study.table)
    assert all(item["n"] > 0 and item["message"] for item in found)


def test_a_report_is_resumed_and_not_mixed(made, monkeypatch):
    with pytest.raises(report.FolderError, match="quick report"):
        report.command(out=made, full=True)


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
    rows = pd.read_csv(made / "defaults" / "defaults.csv").sort_values("source")
    near = rows[(rows["width_m"] == 0.5) & (rows["omega_over_p"] == 3.5) & (rows["onsets"] == 1.3)]
    shown = [[line.source, f"{line.peak_ratio:.4f} θcr"] for line in near.itertuples()]
    assert [line[:2] for line in seen["engines"]] == shown
    assert seen["unasked"]  # half-sines are not among the quick ones
