"""From what users see to the setting that mends it."""

import math

import pandas as pd
import pytest

from engines import ENGINES
from engines.factors import DEFAULT
from studies.__main__ import run
from studies.measures.published import PUBLISHED
from studies.symptoms import study
from studies.symptoms.lines import VARIANTS, lines_of
from studies.symptoms.seen import HULL, SYMPTOMS, THREADS, UNMOVED
from studies.symptoms.words import changed

CORE = [name for name, engine in ENGINES.items() if engine.core]


@pytest.fixture(scope="module")
def lines():
    return lines_of(PUBLISHED, CORE)


@pytest.fixture(scope="module")
def table():
    words = dict.fromkeys(("factor", "level"), str)
    path = PUBLISHED / VARIANTS
    return pd.read_csv(path, keep_default_na=False, na_values=["nan"], dtype=words)


def test_the_published_page_follows_from_the_published_tables():
    kept = study._read(PUBLISHED / "symptoms")
    today = lines_of(PUBLISHED, list(kept["engine"].unique()))
    pd.testing.assert_frame_equal(today, kept, check_dtype=False, rtol=1e-12)


def test_every_symptom_has_a_line_for_every_engine(lines):
    names = {*(symptom.name for symptom in SYMPTOMS), *THREADS}
    assert {*zip(lines["symptom"], lines["engine"], strict=True)} == {
        (name, engine) for name in names for engine in CORE
    }
    assert lines["asked_in"].str.contains("#").all()


@pytest.mark.parametrize("symptom", SYMPTOMS, ids=lambda symptom: symptom.column)
def test_no_other_single_setting_helps_more(symptom, lines, table):
    for row in lines[lines["symptom"] == symptom.name].to_dict("records"):
        mine = table[(table["engine"] == row["engine"]) & (table["preset"] == DEFAULT)]
        base = mine[mine["factor"] == ""].iloc[0]
        assert row["before"] == base[symptom.column]
        singles = mine[(mine["factor"] != "") & (mine["factor"] != "step")]
        sound = singles[(singles["failed"] == 0) & (singles["wrong"] <= base["wrong"])]
        least = sound[symptom.column].abs().min()
        if row["setting"]:
            assert abs(row["after"]) == least <= 0.5 * abs(row["before"])
            assert row["setting"] in [f"{s.factor}: {s.level}" for s in sound.itertuples()]
        else:
            assert least > 0.5 * abs(row["before"])


def test_a_base_without_velocity_gives_no_result_and_a_hull_another(lines):
    unmoved = lines[lines["symptom"] == UNMOVED].set_index("engine")
    assert (unmoved["before"] == math.inf).all()
    assert (unmoved["after"] < 0.05).all()
    hull = lines[lines["symptom"] == HULL].set_index("engine")
    assert hull.loc["pybullet", "before"] > 10 * hull.loc["pybullet", "after"]
    assert hull.loc["mujoco", "before"] == pytest.approx(hull.loc["mujoco", "after"], rel=1e-3)


def test_a_hull_is_missing_only_where_an_adapter_has_none():
    published = study._read(PUBLISHED / "symptoms")
    able = [name for name in published["engine"].unique() if "hull" in ENGINES[name].geometries]
    assert list(published.loc[published["symptom"] == HULL, "engine"]) == able


def test_a_change_is_told_in_the_library_s_words():
    damping = changed("pybullet", DEFAULT, "damping", "as in the best")
    assert damping == "linearDamping=0.0, angularDamping=0.0"
    stiff = changed("mujoco", DEFAULT, "reference", "2 dt 1")
    assert stiff.startswith('solref="0.000655')
    assert changed("moreau", DEFAULT, "closing", "as in the best") == ""


def test_the_page_is_written_drawn_and_told(tmp_path, capsys):
    assert run(["symptoms", "--engines", *CORE, "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert text == (tmp_path / "findings.txt").read_text()
    assert text.count("rocking contact --engines mujoco --out DIR") == len(SYMPTOMS) + 2
    assert "asked in bullet3 #1204" in text
    assert "alone takes the largest error from" in study.headline(tmp_path)
    words = study.paragraph(tmp_path)
    assert words.count("; least in ") == words.count(": most in ") == len(SYMPTOMS) + len(THREADS)
    # a contact that is tuned for a block that does not bounce is not asked to
    assert words.count(" tuned; least in ") == len(SYMPTOMS) + len(THREADS) - 1
    assert "It creeps: most in mujoco 1.2e-02, 1.5e-05 with reference: as in the best" in words
    assert (tmp_path / "symptoms.png").stat().st_size > 20_000


def test_refusals(capsys):
    assert run(["symptoms", "--published", "tests"]) == 2
    assert f"--published is 'tests'; it must hold {VARIANTS}" in capsys.readouterr().err
    assert run(["symptoms", "--engines", "moreau"]) == 2
    assert f"--engines is 'moreau'; it must name one in {VARIANTS}" in capsys.readouterr().err
