"""One engine on one page: registered, at a place, or nothing but what builds its world."""

import json
import re
from collections import Counter

import numpy as np
import pandas as pd
import pytest
from commanding import ROOT, refused

from analytic import simulate
from engines import ENGINES, core_engines, installed_engines
from engines.declaration import Stepping
from engines.registry import undeclared
from studies import respond, score
from studies.__main__ import COMMANDS, run
from studies.kit.app import make_app
from studies.kit.run import run as measured
from studies.score import (
    CASE,
    EXTREMES,
    MEASURES,
    MOMENTS,
    STUDY,
    SWEEP,
    holds,
    probes,
    read,
    required,
    since,
)
from studies.score.probes import OFF, problem_of, wrong_moment, wrong_quantity
from studies.sources.registry import announce, presets_of, resolve

MINE = "my_engine:World"
"""In tests/plugin: a class that builds its world, and no declaration."""


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("nothing", "ENGINE is 'nothing'; it must be one of pybullet, mujoco"),
        ("pymunk:fixd", "preset of pymunk is 'fixd', perhaps 'fixed'; it must be one of naive"),
        ("no_such_module:ENGINE", "No module named 'no_such_module'"),
        ("my_engine:Wheel", "has no attribute 'Wheel'"),
        (":World", "it must be like my_package.mine:ENGINE"),
        ("my engine:World", "it must be like my_package.mine:ENGINE"),
        ("rocking_moreau:ENGINE", "is called 'moreau', as another is"),
        ("rocking_moreau:SLACK", "is neither a declaration nor what builds a world"),
        ("wrong:NoFault", "ENGINE is 'wrong:NoFault': its world has no method fault"),
    ],
)
def test_what_is_no_engine_is_refused_in_a_line(place, message, alone, tmp_path, capsys):
    pytest.importorskip("pymunk")
    refused(capsys, ["score", place, "--out", tmp_path / "out"], message)
    assert not (tmp_path / "out").exists()


def test_quick_asks_a_part_of_every_preset():
    quick = score.jobs(["moreau"], True)
    counts = Counter(job.labels["part"] for job in quick)
    assert counts[SWEEP] == 3 * len(range(0, 480, 11))
    assert counts[MOMENTS] == 3 and min(counts.values()) > 0 and len(counts) == 5
    assert {job.source.partition(":")[2] for job in quick} == {"naive", "fixed", "landing"}
    assert {job.source for job in score.jobs(["moreau:fixed"], True)} == {"moreau:fixed"}


def test_each_table_has_its_rows_with_its_own_columns(few):
    asked = [job for job in few(["mujoco:landing"], True) if job.labels["part"] != EXTREMES]
    tables = STUDY.tabulate(pd.DataFrame(measured(asked, score.measure)))
    assert {name: len(table) for name, table in tables.items() if len(table)} == {
        "score-sweep": 2, "score-steps": 2, "score-moments": 1, "score-frame": 1
    }  # fmt: skip
    assert tables[SWEEP]["figure"].dtype == int and "method" not in tables[SWEEP]
    assert tables["score-steps"]["runs"].min() >= 1
    assert "peak_ratio" not in tables[MOMENTS]
    assert abs(tables["score-frame"]["error"].item()) < 1e-2


@pytest.mark.slow
def test_the_page_the_result_and_what_moved_since(alone, few, tmp_path, capsys):
    """Of an engine that does not declare itself: its numbers are those that `respond` gives."""
    pytest.importorskip("pymunk")
    out, kept = tmp_path / "out", tmp_path / "kept.json"
    asked = ["score", MINE, "--quick", "--out", str(out), "--json", str(kept)]
    assert run([*asked, "--require", "outcomes=2", "fixed:max=1e-9"]) == 1
    *page, held, short = capsys.readouterr().out.strip().splitlines()
    assert "\n".join(page).strip() == (out / "findings.txt").read_text().strip()
    assert held.startswith("holds: landing:outcomes") and short.startswith("falls short: fixed:max")
    assert {path.name for path in out.glob("*.png")} == {"score.png", "extremes.png"}
    tables = STUDY.read(out)
    assert tables[SWEEP]["figure"].dtype == int and "verdict" not in tables[SWEEP]
    result = json.loads(kept.read_text())
    assert list(result) == ["schema", "engine", "versions", "presets", "peaks", "moments"]
    errors = []
    for job in few(["my_engine"], True):
        if (job.labels["part"], job.source) == (SWEEP, "my_engine:landing"):
            case, name = job.case, "/".join(str(job.labels[column]) for column in CASE)
            found, right = (
                respond(job.source, case.system, case.motion),
                simulate(case.system, case.motion),
            )
            rocked = found.outcome.value == "rocked"
            told = result["peaks"]["landing"][name]
            assert told == (found.peak_ratio if rocked else found.outcome.value)
            errors += [abs(found.peak_ratio / right.peak_ratio - 1.0)] * rocked
    numbers = result["presets"]["landing"]
    assert numbers["max"] == pytest.approx(max(errors), rel=1e-6)
    assert (numbers["cases"], numbers["outcomes"], numbers["failed"]) == (2, 2, 0)
    rows = tables[EXTREMES]
    good = rows.loc[rows["source"] == "my_engine:landing", "verdict"] == "good"
    assert (numbers["extreme"], numbers["extremes"]) == (good.sum(), 2)
    assert result["moments"]["fixed"]["measured"] == pytest.approx(1.5, abs=1e-6)
    result["peaks"]["landing"][name] = "slid"
    (tmp_path / "before.json").write_text(json.dumps(result))
    asked[1] = "my_engine"  # it is known by now
    assert run([*asked, "--against", str(tmp_path / "before.json")]) == 0
    assert "1 of 8 answers have another outcome, and 0 peaks" in capsys.readouterr().out
    refused(capsys, ["score", "pymunk", "--quick", "--out", out], "my_engine")


def test_what_moved_is_beyond_noise():
    peaks = {"same": 0.5, "noise": 0.5, "little": 0.5, "more": 0.5, "fell": 0.5, "rose": "slid"}
    then = {"versions": {"engine": "1.0"}, "peaks": {"fixed": {**peaks, "gone": 1.0}, "old": peaks}}
    moved = {"noise": 0.5 * (1 + 9e-7), "little": 0.5 * (1 + 2e-6), "more": 0.3}
    moved |= {"fell": "overturned", "rose": 0.25, "new": 1.0}
    _, other, most = since(then, {"peaks": {"new": peaks, "fixed": peaks | moved}}).split("\n\n")
    outcomes = [line.split()[1:] for line in other.splitlines()]
    assert outcomes[0] == ["case", "then", "now"]
    assert outcomes[1:] == [["fell", "0.5", "overturned"], ["rose", "slid", "0.25"]]
    assert [line.split()[1] for line in most.splitlines()] == ["case", "more", "little"]


@pytest.mark.parametrize(
    ("number", "least", "most"),
    [(0.5, True, True), (0.6, True, False), (0.4, False, True), (None, False, False)],
)
def test_a_bound_may_be_reached_and_no_number_is_short_of_any(number, least, most):
    result = {"presets": {"fixed": {"p90": number, "extreme": number}}}
    assert holds(("fixed", "extreme", 0.5), result)[0] is least
    assert holds(("fixed", "p90", 0.5), result)[0] is most


def test_what_is_no_requirement_and_no_earlier_result_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(score, "jobs", None)
    asked, engine = ["score", "mujoco"], ENGINES["mujoco"]
    assert required("p90=1e-3", engine) == ("landing", "p90", 1e-3)
    assert required("naive:failed=0", engine) == ("naive", "failed", 0.0)
    of_a_name = ("p90", "p95=1", "P90=1", "best:p90=1", ":p90=1", "fixed:=1", "=1")
    for text in (*of_a_name, "p90=", "p90=x", "p90=-1", "p90=nan", "max=inf", "p90=1=1"):
        refused(capsys, [*asked, "--require", text], "--require", repr(text))
    refused(capsys, [*asked, "--require"], "--require")  # as a shell writes an empty variable
    refused(capsys, [*asked, "--require", "p90=1", "landing:p90=2"], "--require", "twice")
    refused(capsys, [*asked, "--json", "nowhere/result.json"], "--json")
    for path in (tmp_path, tmp_path / "nothing", "/dev/zero"):
        refused(capsys, [*asked, "--against", path], "--against", "it is no file")
    kept = {"schema": 1, "engine": "mujoco", "versions": {}, "presets": {}, "peaks": {}}
    other = (
        *({"schema": 2}, {"engine": "pymunk"}, {"versions": 1}, {"peaks": [1.0]}),
        *({"peaks": {"fixed": value}} for value in (1.0, {"a case": [1.0]}, {"a case": 10**400})),
    )
    path = tmp_path / "before.json"
    broken = ("[", "[" * 10**5, "[]", "5", "null", "{}", '"schema engine"', "\0", "")
    for text in (*broken, *(json.dumps(kept | each) for each in other)):
        path.write_text(text)
        refused(capsys, [*asked, "--against", path], "--against", "schema 1")
    path.write_text(json.dumps(kept))
    assert read(path, engine) == kept


def test_the_workflow_to_paste_says_what_is_taken():
    guide = (ROOT / "studies" / "GUIDE.md").read_text(encoding="utf-8")
    workflow = re.search("```yaml\n(.*?)```", guide, re.DOTALL)[1]
    (line,) = re.findall("- run: rocking (.*)", workflow)
    _, bound, ignored = make_app(COMMANDS).parse_args(line, exit_on_error=False)
    assert (bound.args, ignored) == ((MINE,), {})
    engine = undeclared("my_engine", None, "my_engine")
    assert [required(text, engine)[0] for text in bound.kwargs["require"]] == ["fixed"] * 2
    assert all(f"`{measure}`" in guide for measure in MEASURES)


def test_the_best_preset_is_the_one_that_is_right_most_often(monkeypatch):
    """Not the one that is declared last; of two alike the one whose largest error is smaller."""
    lines = [
        {"source": "e:one", "cases": 4, "agree": 4, "max_error": 0.2},
        {"source": "e:two", "cases": 4, "agree": 4, "max_error": 0.1},
        {"source": "e:last", "cases": 4, "agree": 3, "max_error": 0.01},
    ]
    monkeypatch.setattr(score, "swept", lambda _: pd.DataFrame(lines))
    right = pd.DataFrame({"source": ["mujoco:fixed"], "message": "", **probes.UNKNOWN})
    found = score.finding({MOMENTS: right})
    assert found.startswith("e:two") and "all 4" in found and "10 %" in found


def moments_of(name):
    """Return the table of moments of an engine, of all its presets."""
    jobs = [job for job in score.jobs([name], True) if job.labels["part"] == MOMENTS]
    assert len(jobs) == len(presets_of(resolve(name)))
    return pd.DataFrame(measured(jobs, score.measure))


ENGINES_HERE = [
    name if name in core_engines() else pytest.param(name, marks=pytest.mark.slow)
    for name in installed_engines()
]


@pytest.mark.parametrize("name", ENGINES_HERE)
def test_no_engine_is_accused(name):
    table = moments_of(name)
    lag = (table["measured"] - table["declared"]).to_numpy()
    own = [resolve(source).used.stepping is Stepping.OWN for source in table["source"]]
    assert (np.isnan(lag) == own).all()
    # what takes n steps within a step has its velocity at 1 - 1/2n: Rapier's own settings take 4, 8
    substeps = {"rapier:naive": 4, "rapier:naive-base-at-rest": 4, "rapier:recommended": 8}
    expected = [0.5 - 0.5 / substeps.get(source, 1) for source in table["source"]]
    assert lag[~np.isnan(lag)] == pytest.approx(np.array(expected)[~np.isnan(lag)], abs=0.03)
    assert (wrong_moment(table), wrong_quantity(table)) == ("", "")


TO_CORNER, OF_CORNER = 1.0 / 3.0, 4.0 / 3.0
"""Moments of inertia of a block about its centre and a corner, in units of m R^2."""
QUANTITIES = {
    "Inertia": OF_CORNER / (OF_CORNER + 0.03 * TO_CORNER) - 1.0,
    "Mass": 1.03 * OF_CORNER / (1.03 + TO_CORNER) - 1.0,
    "Gravity": 0.01,
    "Width": 0.0221,
    "Heavy": 0.0,
    "Standard": 0.0,
}
"""Class -> by what part the block is turned too fast; what changes no motion is no fault."""


@pytest.mark.parametrize("wrong", QUANTITIES)
def test_an_error_that_does_not_shrink_with_the_step_is_a_wrong_quantity(wrong, alone):
    pytest.importorskip("pymunk")
    table = moments_of(announce(f"wrong:{wrong}"))
    errors = table[["turn_error", "turn_error_half"]].to_numpy()
    assert errors == pytest.approx(QUANTITIES[wrong], abs=1e-3)
    said = wrong_quantity(table)
    assert bool(said) == (QUANTITIES[wrong] != 0.0)
    assert not said or all(f"wrong:{use}" in said for use in ("fixed", "landing"))


def test_an_error_that_shrinks_or_is_small_or_the_librarys_own_is_none():
    table = pd.DataFrame(
        [("mujoco:fixed", 4e-3, 2e-3), ("mujoco:landing", 9e-4, 9e-4), ("mujoco:naive", 0.1, 0.1)],
        columns=["source", "turn_error", "turn_error_half"],
    )
    assert wrong_quantity(table) == ""
    assert "mujoco:fixed" in wrong_quantity(table.assign(turn_error=-2e-3))


NO_WORLDS = {
    "NoStep": "has no method step; it must have state, fault, close, step",
    "NoState": "has no method state",
    "NoFault": "has no method fault",
    "NoClose": "has no method close",
    "NoMoment": "has no moment; it must be one of Moment.MIDDLE, END and NEXT",
    "Turned": "theta -0.0804 of a block put to 0.0804",
    "Backwards": "rate -0.0982 of a block put to 0.0982",
    "Mirrored": "pulled towards +x, its block turns to theta -0.0256",
}


@pytest.mark.parametrize("wrong", NO_WORLDS)
def test_what_is_no_world_is_told_in_a_line(wrong, alone):
    pytest.importorskip("pymunk")
    assert NO_WORLDS[wrong] in problem_of(announce(f"wrong:{wrong}"))
    assert problem_of("moreau:landing") == ""


@pytest.mark.parametrize(
    ("place", "moment", "name"),
    [("Middle", 1.5, "NEXT"), ("End", 1.5, "NEXT"), ("Moreau", 1.0, "END")],
)
def test_a_wrong_moment_is_the_finding(place, moment, name, alone):
    pytest.importorskip("pymunk")
    table = moments_of(announce(f"staggered:{place}"))
    assert table["measured"].to_numpy() == pytest.approx(moment, abs=1e-6)
    said = score.finding({MOMENTS: table})
    assert "staggered:fixed and staggered:landing" in said and said.endswith(f"Moment.{name}.")


def test_from_half_a_step_on_it_is_another_moment():
    table = pd.DataFrame({"source": ["a"], "declared": [0.5], "measured": [0.5 + OFF]})
    assert "END" in wrong_moment(table) and "MIDDLE" in wrong_moment(table)
    # what takes 16 steps within a step
    assert wrong_moment(table.assign(measured=1.0 - 1.0 / 32.0)) == ""


def test_what_does_not_move_has_no_moment(alone):
    table = moments_of(announce("hostile:Calm"))
    assert table["measured"].isna().all()
    assert wrong_moment(table) == ""
    assert "gave 0 of" in table["message"].iloc[0]
