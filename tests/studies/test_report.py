"""The chapters, and the page that shows them, in a browser where there is one."""

import importlib
import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pandas as pd
import pytest

from studies.page import page, report
from studies.__main__ import COMMANDS
from studies.catalogue import CHAPTERS

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
SMALL = {
    "sweep": ("--figure", "6", "--sources", "exact", "modified"),
    "histories": ("--figure", "4"),
}
"""Chapters that are quickly made, and their arguments here."""


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda chapter: chapter.folder)
def test_a_chapter_is_a_study_with_pictures_and_a_headline(chapter):
    assert chapter.study in COMMANDS
    module = importlib.import_module(f"studies.{chapter.study}")
    for name in ("command", "pictures", "headline"):
        assert callable(getattr(module, name))


def test_every_study_is_a_chapter():
    beside = {"compare", "cost", "report", "redraw", "animate", "throughput"}
    assert {chapter.study for chapter in CHAPTERS} | beside == set(COMMANDS)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        chapters = {chapter.folder: chapter for chapter in CHAPTERS if chapter.folder in SMALL}
        few = tuple(
            type(chapter)(
                **{name: getattr(chapter, name) for name in chapter.__slots__}
                | {"quick": SMALL[name]}
            )
            for name, chapter in chapters.items()
        )
        patch.setattr(report, "CHAPTERS", few)
        patch.setattr(page, "CHAPTERS", few)
        assert report.command(out=folder) == 0
    return folder


class Links(HTMLParser):
    """Collects what a page would load or lead to, and the tags left open."""

    def __init__(self):
        super().__init__()
        self.addresses, self.open = [], []

    def handle_starttag(self, tag, attributes):
        self.addresses += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("meta", "img", "link", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_holds_all_it_shows(made):
    links = Links()
    links.feed((made / "report.html").read_text())
    assert links.open == []
    assert len(links.addresses) > 3
    assert all(address.startswith(("#", "data:image/svg+xml")) for address in links.addresses)


def test_the_page_says_what_the_tables_say(made):
    text = (made / "report.html").read_text()
    summary = pd.read_csv(made / "sweep" / "summary.csv").set_index("source")
    line = next(summary.loc[["modified"]].itertuples())
    assert f"modified {line.agree} of 240 ({line.max_error:.1e})" in text
    record = json.loads((made / "sweep" / "provenance.json").read_text())
    assert f"mujoco {record['engines']['mujoco']}" in text


def test_a_report_is_resumed_and_not_mixed(made, monkeypatch):
    with pytest.raises(report.FolderError, match="quick report"):
        report.command(out=made, full=True)


WIDTHS = (390, 820, 1400)
PROBE = """<script>
const head = document.querySelector("table th button");
document.querySelectorAll("details").forEach(part => part.open = true);
const before = document.documentElement.scrollWidth;
head.click(); head.click();
const column = [...head.closest("table").tBodies[0].rows].map(row => row.cells[0].textContent);
document.title = JSON.stringify({wide: before - window.innerWidth, column});
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
