"""README.md and the page of the published results: what the tables say, and nothing else."""

import csv
import re
import shutil
from pathlib import Path

import pandas as pd
import pytest

from studies.__main__ import run
from studies.catalogue import CHAPTERS
from studies.measures.columns import COLUMNS, GROUPS
from studies.page import facts, hero, readme
from studies.page.markdown import table

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / readme.PUBLISHED


@pytest.mark.parametrize("name", ["README.md", "studies/published/README.md"])
def test_a_page_says_what_the_published_tables_say(name):
    assert readme.pages(ROOT)[ROOT / name] == (ROOT / name).read_text(encoding="utf-8"), (
        "run `rocking readme`"
    )


def test_the_readme_follows_its_tables(tmp_path):
    """A number and a word change with the table that they come from."""
    copy = tmp_path / readme.PUBLISHED
    shutil.copytree(PUBLISHED, copy)
    (tmp_path / facts.NINTH).parent.mkdir(parents=True)
    shutil.copy(ROOT / facts.NINTH, tmp_path / facts.NINTH)
    before = readme.pages(tmp_path)[tmp_path / "README.md"]
    for path in (copy / "sweep" / "summary.csv", copy / "presets" / "summary.csv"):
        lines = pd.read_csv(path)
        mine = (lines["source"] == "mujoco") & (lines["figure"] == "all")
        lines.loc[mine, ["agree", "max_error"]] = [957, 0.0123]
        lines.to_csv(path, index=False)
    after = readme.pages(tmp_path)[tmp_path / "README.md"]
    assert "957 of 960" in after and "957 of 960" not in before
    assert "1.2 % |" in after
    assert "4 of 5760 cases" in after  # one of another engine's besides


def test_both_commands_of_ci_are_there_once():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for name in ("the main job", "the tests"):
        assert len(re.findall(f"<!-- {name} -->\n```sh\npython3.11 -m venv .*\n```\n", text)) == 1


def test_the_engine_of_the_readme_is_the_one_that_is_scored():
    """In at most 30 lines; tests/studies/test_score.py puts it to the cases."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    shown = re.search("`rocking score my_engine:World.*?```python\n(.*?)\n```", text, re.DOTALL)[1]
    assert len(shown.splitlines()) <= 30
    assert (ROOT / facts.NINTH).read_text(encoding="utf-8").rstrip().endswith(shown)


def test_every_link_of_a_page_leads_somewhere():
    for path in (ROOT / "README.md", PUBLISHED / "README.md"):
        text = path.read_text(encoding="utf-8")
        targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
        targets += re.findall(r'src="([^"]+)"', text)
        inside = [target for target in targets if not target.startswith("http")]
        assert len(inside) > 5
        assert [name for name in inside if not (path.parent / name).exists()] == []
        names = set(re.findall(r'<a id="([^"]+)"', (PUBLISHED / "README.md").read_text()))
        asked = re.findall(r"studies/published/README\.md#([\w-]+)", text)
        assert set(asked) <= names


def test_every_published_column_is_in_the_glossary():
    assert sum(map(len, GROUPS.values())) == len(COLUMNS)
    heads = {}
    for path in PUBLISHED.glob("*/*.csv"):
        with path.open(newline="", encoding="utf-8") as file:
            heads |= dict.fromkeys(next(csv.reader(file)), path)
    assert len(heads) > 100
    assert {name: path for name, path in heads.items() if name not in COLUMNS} == {}
    assert all(column.meaning for column in COLUMNS.values())


def test_what_is_not_published_is_named(tmp_path):
    assert facts.missing(tmp_path) == [chapter.folder for _, chapter in CHAPTERS]


def test_a_bar_does_not_end_a_cell():
    assert table(("a", "b"), [("|θ|", "1")]).splitlines()[-1] == "| ∣θ∣ | 1 |"


def test_the_first_picture_is_of_the_case_that_it_names():
    """Figure 5-b of the paper: exact 0.3852, and Housner's linearization overturns."""
    lines = hero.summary(pd.read_csv(PUBLISHED / "hero" / "hero.csv")).set_index("source")
    assert lines.loc["exact", "peak_ratio"] == pytest.approx(0.3852, abs=5e-5)
    assert lines.loc["housner", "outcome"] == "overturned"
    assert set(lines.index) == set(hero.SOURCES)


def test_a_folder_without_tables_is_refused(tmp_path, capsys):
    assert run(["readme", "--root", str(tmp_path)]) == 2
    assert "--root" in capsys.readouterr().err
