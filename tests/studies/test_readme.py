"""README.md and the page of the published results: what the tables say, and nothing else."""

import math
import re
import shutil
import tomllib

import pandas as pd
import pytest
from commanding import PAGES, PROSE, PUBLISHED_PAGES, ROOT, refused

from engines.parts.factors import BEST, DEFAULT, LEFT_OUT
from studies.catalogue import CHAPTERS
from studies.old.tables import read_table
from studies.page import facts, hero, readme, scene_facts
from studies.page.engine_facts import objections, once, prices, rules
from studies.page.readme import table

PUBLISHED = ROOT / readme.PUBLISHED


TABLES = ("studies/published/columns.csv",)


@pytest.fixture(scope="module")
def pages():
    return readme.pages(ROOT)


@pytest.mark.parametrize("name", (*PAGES, *TABLES))
def test_a_page_says_what_the_published_tables_say(name, pages):
    assert pages[ROOT / name] == (ROOT / name).read_text("utf-8"), "run `rocking readme`"


def test_the_readme_follows_its_tables(pages, tmp_path):
    """A number and a word change with the table that they come from."""
    copy = tmp_path / readme.PUBLISHED
    shutil.copytree(PUBLISHED, copy)
    before = said(pages, ROOT)
    for path in (copy / "sweep" / "summary.csv", copy / "presets" / "summary.csv"):
        lines = pd.read_csv(path)
        mine = (lines["source"] == "mujoco") & (lines["figure"] == "all")
        wrong = ["agree", "fall_wrong", "rest_wrong", "no_answer"]
        lines.loc[mine, [*wrong, "max_error"]] = [957, 1, 2, 0, 0.0123]
        lines.to_csv(path, index=False)
    after = said(readme.pages(tmp_path), tmp_path)
    for old, new, words in zip(
        before,
        after,
        ("<br>→ 2.8·10⁻⁶ (3 wrong) |", "957 of 960 | 1 | 2 | 0 |"),
        strict=True,
    ):
        assert words in new.replace("\N{NO-BREAK SPACE}", " ") and words not in old
    assert "1.2 % |" in after[1]
    assert "at rest for rocked in up to 2 (MuJoCo) of 960 cases each" in after[0]
    assert "960 cases are 480 problems, each in 2 sizes, at 1.1 to 1.5 times" in after[0]
    assert "5760" not in after[0]


def test_the_scenes_of_the_readme_follow_their_tables(tmp_path):
    copy = tmp_path / readme.PUBLISHED
    shutil.copytree(PUBLISHED, copy)
    cells = cells_of(copy, "Drake")
    assert "3.8 %<br>→ 9.4·10⁻⁵" in cells and len(cells) == 5
    path = copy / "scenes" / "slide.csv"
    rows = read_table(path)
    rows[~rows["source"].str.startswith("newton")].to_csv(path, index=False, na_rep="nan")
    assert cells_of(copy, "Newton")[-1] == "–"
    path = copy / "scenes" / "frame.csv"
    rows = read_table(path)
    mine = rows["source"] == "drake:naive"
    rows.loc[mine, "error"] = 0.25
    rows.loc[rows[mine].index[:3], "outcome"] = "overturned"
    rows.loc[rows[mine].index[:3], "error"] = float("nan")
    rows.to_csv(path, index=False, na_rep="nan")
    assert "25 % (3 wrong)<br>→ 9.4·10⁻⁵" in cells_of(copy, "Drake")
    shutil.rmtree(copy / "scenes")
    heads, _ = scene_facts.scenes(copy)
    assert len(heads) == 3 and "frame" not in " ".join(heads)


def cells_of(published, engine):
    """Return the cells of an engine among the scenes."""
    _, rows = scene_facts.scenes(published)
    (found,) = (cells for cells in rows if engine in cells[0])
    return [cell.replace("\N{NO-BREAK SPACE}", " ") for cell in found]


def test_what_is_said_of_heavy_beams_follows_their_table(tmp_path):
    copy = tmp_path / readme.PUBLISHED
    shutil.copytree(PUBLISHED / "scenes", copy / "scenes")
    path = copy / "scenes" / "frame-extremes.csv"
    rows = read_table(path)
    heavy = rows["load"] == 1000.0
    rows.loc[heavy & (rows["source"] == "pymunk"), "median_error"] = 0.0001
    rows.loc[heavy & (rows["source"] == "mujoco"), "median_error"] = float("nan")
    rows.loc[heavy & (rows["source"] == "newton:fixed"), "median_error"] = 3.0
    # a preset that is not the best counts for nothing
    rows.loc[heavy & (rows["source"] == "box2d:naive"), "median_error"] = 9.0
    rows.to_csv(path, index=False, na_rep="nan")
    claim = scene_facts.extreme_frames(copy)["claim"]
    assert claim.endswith("by 10⁻⁴ (pymunk) to 300 % (Newton); no peak at all from MuJoCo.")


def said(pages, root):
    """Return README.md and the page about the engines, of a folder."""
    return pages[root / "README.md"], pages[root / readme.PUBLISHED / "engines.md"]


def test_a_preset_of_one_engine_alone_is_named_in_its_cell():
    lines = pd.DataFrame(
        [
            ("naive", "pybullet", 9),
            ("naive", "drake", 10),
            ("naive", "newton", 10),
            ("landing", "pybullet", 10),
            ("landing", "mujoco", 10),
            ("error-controlled", "drake", 10),
        ],
        columns=["preset", "engine", "right"],
    ).assign(cases=10, median=0.01, p90=0.02, max=0.5, ms=2.0, rest_wrong=0, no_answer=0)
    lines["fall_wrong"] = lines["cases"] - lines["right"]
    lines = lines.rename(columns={"median": "median_error", "max": "largest_error"})
    heads, rows = facts.by_preset(lines)
    rows = [[cell.replace("\N{NO-BREAK SPACE}", " ") for cell in row] for row in rows]
    assert len(heads) == 3 and not any("error-controlled" in head for head in heads)
    assert rows[0][:2] == ["**PyBullet**", "**fall wrong in 1**<br>1 %, max 50 %<br>2 ms"]
    assert rows[1][-1] == "`:error-controlled`<br>none wrong<br>1 %, max 50 %<br>2 ms"
    assert rows[2][-1] == "–" and rows[3][:2] == ["**MuJoCo**", "–"]


def test_what_users_would_object_follows_the_tables(tmp_path):
    """What lowers an error is shown with what it lowers; what makes more cases wrong is not."""
    for name in ("contact", "precision", "scenes"):
        shutil.copytree(PUBLISHED / name, tmp_path / name)
    path = tmp_path / "contact" / "own-steps.csv"
    lines = read_table(path, "factor", "level", "trap")
    plain = (lines["engine"] == "mujoco") & (lines["factor"] == "")
    better = (lines["engine"] == "mujoco") & (lines["factor"] == "integrator")
    worse = (lines["engine"] == "mujoco") & (lines["factor"] == "cone")
    lines.loc[plain, ["median_error", "max_error", "failed", "wrong"]] = [0.5, 0.75, 0, 1]
    lines.loc[better, ["median_error", "max_error", "failed", "wrong"]] = [0.0123, 0.06, 0, 1]
    lines.loc[worse, ["median_error", "max_error", "failed", "wrong"]] = [0.001, 0.002, 0, 2]
    lines.to_csv(path, index=False, na_rep="nan")
    said = once(objections(tmp_path, facts.presets(PUBLISHED)))
    tried = {cells[1].partition(":")[0]: cells[4] for cells in said if "max 75 %" in cells[3]}
    assert tried["integrator"] == "1.2 %, max 6 %, 1 wrong" and "cone" not in tried
    assert sum(cells[0] == "MuJoCo" for cells in said) == 1


def made_up(preset, factor="", level="", error=1e-5, **broken):
    counts = {"cases": 12, "failed": 0, "wrong": 0, **broken}
    words = {"engine": "rapier", "preset": preset, "factor": factor, "level": level}
    return {**words, **counts, "median_error": error / 2, "max_error": error}


def test_what_helps_has_a_price_and_a_rule_its_worth():
    lines = pd.DataFrame(
        [
            made_up("landing"),
            made_up("landing", LEFT_OUT, "reflection", 2e-2, wrong=1),
            made_up(BEST, error=3e-2),
            made_up(BEST, "locks", "y locked", math.nan, failed=12),
            made_up(DEFAULT, error=0.05),
            made_up(BEST, "sleeping", "on", 0.4),
        ]
    )
    assert prices(lines, "rapier") == {
        "": "10⁻⁵",
        "REFLECTION": "2 %, 1 of 12 wrong",
        "STEPS": "3 %",
    }
    # without the rule, and with it: what is seen from the best is what happens without
    worth = {tuple(pair) for _, _, *pair in rules(lines)}
    assert worth == {("no result", "1.5 %, 3 %"), ("20 %, 40 %", "1.5 %, 3 %")}


def runs_of(*runs, commit="a", **record):
    named = ("first", "rows", "computed", "duration_s")
    return {
        **{"study": "sweep", "version": "1", "engines": {}, "machine": {}, "settings": {}},
        "git": {"commit": commit},
        **record,
        "runs": [dict(zip(named, run, strict=True)) for run in runs],
    }


def test_the_first_run_and_a_later_one_are_timed_apart():
    """One that goes on where another stopped is neither."""
    versions = {"mujoco": "1.0"}
    later = runs_of((False, 9, 9, 21.4), (False, 9, 2, 3.0), engines=versions)
    first = runs_of((True, 9, 9, 80.9), engines=versions)
    both = "81 s the first time, when its functions are compiled, and for 21 s later"
    assert facts.lasts(later, first) == both == facts.lasts(first, later)
    unknown = "a time that was not measured"
    assert facts.lasts(later) == both.replace("81 s", unknown)
    assert facts.lasts(first) == both.replace("21 s", unknown)
    assert facts.lasts({**later, "runs": [{"duration_s": 5.0}]}).count(unknown) == 2
    ninth = {**later, "engines": {**versions, "a ninth": "1.0"}}
    assert facts.lasts(ninth, first) == both  # which neither asked
    absent = {**first, "engines": {**versions, "a ninth": "not installed"}}
    assert facts.lasts(ninth, absent) == both
    with pytest.raises(ValueError, match="the provenances of two runs differ"):
        facts.lasts(later, {**first, "engines": {"mujoco": "2.0"}})
    with pytest.raises(ValueError, match="the provenances of two runs differ"):
        facts.lasts(later, runs_of((True, 9, 9, 80.9), machine={"cpu": "another"}))


def test_the_readme_is_short():
    """Two screens of text before its example; the numbers are on the pages that it leads to."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.encode()) < 9_600
    assert (
        len([word for line in text.splitlines() if line[:1] != "|" for word in line.split()]) < 900
    )


@pytest.mark.parametrize("name", PROSE)
def test_headings_and_paragraphs_are_short(name):
    """Of paragraphs those that a person wrote: a claim of a table is as long as its presets."""
    text = re.sub("```.*?```", "", (ROOT / name).read_text(encoding="utf-8"), flags=re.S)
    heads = re.findall("^#+ (.*)$", text, re.M)
    assert heads and [head for head in heads if len(head.split()) > 12] == []
    shown = re.sub(r"\]\([^)]*\)", "]", text)
    parts = re.split(r"\n\s*\n|\n(?=(?:[-*]|\d+\.) )", shown)
    written = [
        part for part in parts if part[:1] != "|" and not re.fullmatch(r"\*\*[^*]*\*\*\s*", part)
    ]
    assert [part for part in written if len(part) > 600] == []


def test_both_commands_of_ci_are_there_once():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for name in ("the main job", "the tests"):
        assert len(re.findall(f"<!-- {name} -->\n```sh\npython3.11 -m venv .*\n```\n", text)) == 1


def test_the_engine_of_the_readme_is_as_short_as_it_says():
    """tests/studies/test_score.py puts it to the cases."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "a class of thirty lines, [my_engine.py](tests/plugin/my_engine.py)" in text
    code = (ROOT / "tests" / "plugin" / "my_engine.py").read_text(encoding="utf-8")
    assert len(code[code.index("import ") :].splitlines()) <= 30


def test_every_link_of_a_page_leads_somewhere():
    assert {PUBLISHED / name for name in PUBLISHED_PAGES} == set(PUBLISHED.glob("*.md"))
    for path in (ROOT / name for name in (*PROSE, "analytic/EQUATIONS.md")):
        text = path.read_text(encoding="utf-8")
        targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
        targets += re.findall(r'src="([^"]+)"', text)
        inside = [target for target in targets if not target.startswith("http")]
        assert inside
        assert [name for name in inside if not (path.parent / name).exists()] == []
        for name, place in re.findall(r"\]\(([^)#]*)#([\w-]+)\)", text):
            assert place in anchors(path.parent / name if name else path), (path, name, place)


def anchors(path):
    """Return the names that a link into a page may end with: its own, and those of its headings."""
    text = path.read_text(encoding="utf-8")
    heads = re.findall("^#+ (.*)$", text, re.MULTILINE)
    return {*re.findall(r'<a id="([^"]+)"', text), *(slug(head) for head in heads)}


def slug(head):
    return re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-")


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
    refused(capsys, ["readme", "--root", tmp_path], "--root")


def test_the_project_s_files_name_what_there_is():
    """Forms and the workflow can be read, and the citation and the changes are of this version."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    folder = ROOT / ".github"
    assert f"## {version}\n" in (folder / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\nversion: {version}\n" in (folder / "CITATION.cff").read_text(encoding="utf-8")
    assert "run: .ci/run" in (folder / "workflows" / "ci.yml").read_text(encoding="utf-8")


def test_the_changes_tell_the_published_outcomes():
    """How many outcomes of 960 are right as documented, after the change."""
    text = (ROOT / ".github" / "CHANGELOG.md").read_text(encoding="utf-8")
    told = dict(re.findall(r"(\w+)\s+\d{3},\s+(\d{3})[;.]", text))
    lines = pd.read_csv(PUBLISHED / "presets" / "summary.csv").query("figure == 'all'")
    right = lines.set_index("source")["agree"]
    found = {title: int(right[f"{title.lower()}:naive"]) for title in told}
    assert len(told) == 8 and {title: int(count) for title, count in told.items()} == found
