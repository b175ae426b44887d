"""From what users see to the setting that mends it."""

import math
import re
from functools import partial

import pandas as pd
import pytest
from commanding import run_scripts
from declared import run
from given import BLOCK

from analytic import simulate
from engines import ENGINES, Scene
from engines.declaration import DEFAULT, OWN_STEPS
from studies.__main__ import run as run_command
from studies.advise.symptoms import HULL, MEASURED, OWN, SYMPTOMS, UNMOVED, VARIANTS, find, patch
from studies.cases.paper import free_rocking_window, sweep_cases
from studies.cases.variants import variants
from studies.export import files
from studies.kit.tables import read_table, table_in
from studies.measures.formulas import by_step
from studies.measures.published import PUBLISHED

CORE = [name for name, engine in ENGINES.items() if engine.core]
KEPT = table_in(PUBLISHED / "symptoms", "symptoms", "setting", "formula", "literal")


@pytest.fixture(scope="module")
def lines():
    return find(PUBLISHED, list(KEPT["engine"].unique()), BLOCK)


def published(name):
    table = read_table(PUBLISHED / name, "factor", "level")
    return table[table["preset"] == DEFAULT]


def test_the_published_symptoms_follow_from_the_published_tables(lines):
    pd.testing.assert_frame_equal(lines, KEPT, check_dtype=False, rtol=1e-12)
    mine = lines[lines["engine"].isin(CORE)]
    assert set(zip(mine["symptom"], mine["engine"], strict=True)) == {
        (symptom.name, engine) for symptom in SYMPTOMS for engine in CORE
    }
    hulls = [name for name in lines["engine"].unique() if ENGINES[name].best.takes(geometry="hull")]
    assert list(lines.loc[lines["symptom"] == HULL.name, "engine"]) == hulls


def singles(table, engine, column):
    """Return what the defaults leave, and what each setting that breaks nothing does."""
    mine = table[table["engine"] == engine]
    base = mine[mine["factor"] == ""].iloc[0]
    found = mine[(mine["factor"] != "") & (mine["factor"] != OWN_STEPS)]
    sound = found[(found["failed"] == 0) & (found["wrong"] <= base["wrong"])]
    if column == "max_error" and not base["failed"]:
        sound = sound[sound["median_error"] < base["median_error"]]
    left = {
        f"{each.factor}: {each.level}": abs(getattr(each, column)) for each in sound.itertuples()
    }
    return math.inf if base["failed"] else base[column], left


@pytest.mark.parametrize("symptom", MEASURED, ids=lambda symptom: symptom.column)
def test_no_other_single_setting_helps_more(symptom, lines):
    equal, own = published(VARIANTS), published(OWN)
    for row in lines[lines["symptom"] == symptom.name].to_dict("records"):
        before, left = singles(equal, row["engine"], symptom.column)
        before_own, left_own = singles(own, row["engine"], symptom.column)
        assert (row["before"], row["before_own"]) == (before, before_own)
        helping = {
            name: size
            for name, size in left.items()
            if before and name in left_own and size <= 0.5 * abs(before)
            if left_own[name] <= 0.5 * abs(before_own)
        }
        if row["setting"]:
            assert abs(row["after"]) == helping[row["setting"]] == min(helping.values())
            assert abs(row["after_own"]) == left_own[row["setting"]]
        else:
            assert not helping


def test_a_base_without_velocity_gives_no_result_and_a_box_for_a_hull_does_not_help(lines):
    unmoved = lines[lines["symptom"] == UNMOVED.name]
    assert (unmoved["before"] == math.inf).all() and (unmoved["after"] < 0.05).all()
    hull = lines[lines["symptom"] == HULL.name].set_index("engine")
    box = lines[lines["symptom"] == MEASURED[0].name].set_index("engine")["before"]
    assert (hull["before"] > box[hull.index]).all()
    assert hull["before"].to_numpy() == pytest.approx(box[hull.index].to_numpy(), rel=5e-2)
    assert (hull["setting"] == "").all() and hull["after"].isna().all()


def test_a_change_is_written_line_by_line_in_the_library_s_words():
    damping = patch(BLOCK, "pybullet", "damping", "as in the best", 1.0 / 240.0)
    gone = "p.changeDynamics(bodyUniqueId=block, linkIndex=-1, lateralFriction=1.0, mass=375.0"
    come = f"+ {gone},\n+     linearDamping=0.0, angularDamping=0.0)"
    assert damping == f"@@ block.py\n- {gone})\n{come}"


SETTINGS = sorted(
    (engine, each.factor, each.level)
    for engine, setting in set(zip(KEPT["engine"], KEPT["setting"], strict=True))
    if ENGINES[engine].installed
    for each in variants(engine)
    if f"{each.factor}: {each.level}" == setting and each.preset == DEFAULT
)
"""Each setting that the published table names."""
FIRST = [*{engine: (engine, *setting) for engine, *setting in reversed(SETTINGS)}.values()][:2]


def pasted(texts, changes):
    """Return files in which lines that go have made room for those that come."""
    texts = dict(texts)
    for place in changes.split("@@ ")[1:]:
        name, *lines = place.splitlines()
        old, new = (
            "".join(f"\n{line[2:]}" for line in lines if line[:2] in (mark, "  ")) + "\n"
            for mark in ("- ", "+ ")
        )
        assert texts[name].count(old) == 1 or texts[name].startswith(old[1:])
        texts[name] = texts[name].replace(old, new)
    return texts


@pytest.mark.parametrize(
    ("engine", "factor", "level"),
    [pytest.param(*each, marks=[pytest.mark.slow] * (each not in FIRST)) for each in SETTINGS],
)
def test_a_setting_that_is_pasted_into_a_script_does_what_it_does_here(
    engine, factor, level, tmp_path
):
    """At the library's own step and at another one; there, the lines of the own step do not."""
    mending = {(v.preset, v.factor, v.level): v.settings for v in variants(engine)}
    case = next(case for case in sweep_cases((6,)) if case.aspect == 3.0 and case.width_m == 0.5
                and simulate(case.block, case.motion).outcome.value == "rocked")  # fmt: skip
    asked = {"system": case.block, "motion": case.motion, "preset": DEFAULT}
    asked["duration"] = free_rocking_window(case.block, case.motion)
    scripts, declared = [], ENGINES[engine]
    for step in (None, 1e-3):
        scene = Scene(**asked, step=step)
        mended = Scene(**asked, step=step, settings=mending[DEFAULT, factor, level])
        peak, dt_s = run(engine, mended).peak_ratio, declared.use(scene).dt_s
        changes = patch(case.block, engine, factor, level, dt_s)
        scripts.append(tmp_path / f"{step}" / "block.py")
        scripts[-1].parent.mkdir()
        for name, text in pasted(files(declared, scene, peak, peak), changes).items():
            (scripts[-1].parent / name).write_text(text)
    done = run_scripts(declared.library, *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("largest rotation") == len(scripts)


STEP = r"[-\d.e]*[*/]?\bDT\b(?:\*\*\d)?"


@pytest.mark.parametrize("engine", [name for name, engine in ENGINES.items() if engine.script])
def test_a_formula_gives_the_lines_of_every_step(engine):
    """Of each single setting; DT is the only name in it that a step has."""

    def numbers(text, dt_s):
        plain = re.sub(STEP, lambda found: repr(eval(found[0], {"DT": dt_s})), text)
        return [float(n) for n in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]?\d+)?", plain)]

    for each in variants(engine):
        if each.preset != DEFAULT or not each.factor or each.factor == OWN_STEPS or each.scene:
            continue
        change = partial(patch, BLOCK, engine, each.factor, each.level)
        for dt_s in (1e-4, 1.0 / 240.0):
            expected = numbers(change(dt_s), dt_s)
            assert numbers(by_step(change), dt_s) == pytest.approx(expected, rel=1e-9)


def test_settings_are_written_for_the_step_of_the_reader(capsys):
    asked = ["advise", "--symptoms", "--engines", "mujoco"]
    assert run_command([*asked, "--dt", "0.004"]) == 0
    text = capsys.readouterr().out
    assert 'solref="-0.0099980001/DT**2 -0.9999/DT"' in text
    assert f" {-0.9999 / 0.004!r}" in text and "at DT = 0.004 s" in text
    assert run_command(asked) == 0
    assert "at DT = 0.002 s" in capsys.readouterr().out
