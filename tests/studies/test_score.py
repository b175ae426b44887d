"""One engine on one page: registered, at a place, or nothing but what builds its world."""

import json
from collections import Counter

import pandas as pd
import pytest
from commanding import refused

from analytic import simulate
from engines import ENGINES, core_engines, installed_engines
from engines.declaration import Stepping
from studies import respond, score
from studies.__main__ import run
from studies.kit.run import run as measured
from studies.score import (
    CASE,
    EXTREMES,
    STUDY,
    SWEEP,
    measured_moment,
    problem_of,
    read,
    since,
    uses_of,
    world_of,
)
from studies.sources.registry import announce, resolve

MINE = "my_engine:World"
"""In tests/plugin: a class that builds its world, and no declaration."""


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("nothing", "ENGINE is 'nothing'; it must be one of pybullet, mujoco"),
        ("pymunk:tuend", "preset of pymunk is 'tuend', perhaps 'tuned'; it must be one of default"),
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
    assert min(counts.values()) > 0 and len(counts) == 4
    assert {job.source.partition(":")[2] for job in quick} == {"default", "tuned", "landing"}
    assert {job.source for job in score.jobs(["moreau:tuned"], True)} == {"moreau:tuned"}


def test_each_table_has_its_rows_with_its_own_columns(few):
    asked = [job for job in few(["mujoco:landing"], True) if job.labels["part"] != EXTREMES]
    tables = STUDY.tabulate(pd.DataFrame(measured(asked, score.measure)))
    assert {name: len(table) for name, table in tables.items() if len(table)} == {
        "score-sweep": 2, "score-steps": 2, "score-frame": 1
    }  # fmt: skip
    assert tables[SWEEP]["figure"].dtype == int and "method" not in tables[SWEEP]
    assert tables["score-steps"]["runs"].min() >= 1
    assert abs(tables["score-frame"]["error"].item()) < 1e-2


@pytest.mark.slow
def test_the_page_the_result_and_what_moved_since(alone, few, tmp_path, capsys):
    """Of an engine that does not declare itself: its numbers are those that `respond` gives."""
    pytest.importorskip("pymunk")
    out, kept = tmp_path / "out", tmp_path / "kept.json"
    asked = ["score", MINE, "--quick", "--out", str(out), "--json", str(kept)]
    assert run(asked) == 0
    assert capsys.readouterr().out.strip() == (out / "findings.txt").read_text().strip()
    assert {path.name for path in out.glob("*.png")} == {"score.png", "extremes.png"}
    tables = STUDY.read(out)
    assert tables[SWEEP]["figure"].dtype == int and "verdict" not in tables[SWEEP]
    result = json.loads(kept.read_text())
    assert list(result) == ["schema", "engine", "versions", "presets", "peaks"]
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
    result["peaks"]["landing"][name] = "slid"
    (tmp_path / "before.json").write_text(json.dumps(result))
    asked[1] = "my_engine"  # it is known by now
    assert run([*asked, "--against", str(tmp_path / "before.json")]) == 0
    assert "1 of 8 answers have another outcome, and 0 peaks" in capsys.readouterr().out
    refused(capsys, ["score", "pymunk", "--quick", "--out", out], "my_engine")


def test_what_moved_is_beyond_noise():
    peaks = {"same": 0.5, "noise": 0.5, "little": 0.5, "more": 0.5, "fell": 0.5, "rose": "slid"}
    then = {"versions": {"engine": "1.0"}, "peaks": {"tuned": {**peaks, "gone": 1.0}, "old": peaks}}
    moved = {"noise": 0.5 * (1 + 9e-7), "little": 0.5 * (1 + 2e-6), "more": 0.3}
    moved |= {"fell": "overturned", "rose": 0.25, "new": 1.0}
    _, other, most = since(then, {"peaks": {"new": peaks, "tuned": peaks | moved}}).split("\n\n")
    outcomes = [line.split()[1:] for line in other.splitlines()]
    assert outcomes[0] == ["case", "then", "now"]
    assert outcomes[1:] == [["fell", "0.5", "overturned"], ["rose", "slid", "0.25"]]
    assert [line.split()[1] for line in most.splitlines()] == ["case", "more", "little"]


def test_what_is_no_earlier_result_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(score, "jobs", None)
    asked, engine = ["score", "mujoco"], ENGINES["mujoco"]
    refused(capsys, [*asked, "--json", "nowhere/result.json"], "--json")
    refused(capsys, [*asked, "--against", "/dev/zero"], "--against", "it is no file")
    kept = {"schema": 1, "engine": "mujoco", "versions": {}, "presets": {}, "peaks": {}}
    other = (
        *({"schema": 2}, {"engine": "pymunk"}, {"versions": 1}, {"peaks": [1.0]}),
        *({"peaks": {"tuned": value}} for value in (1.0, {"a case": [1.0]}, {"a case": 10**400})),
    )
    path = tmp_path / "before.json"
    broken = ("[", "[" * 10**5, "[]", "5", "null", "{}", '"schema engine"', "\0", "")
    for text in (*broken, *(json.dumps(kept | each) for each in other)):
        path.write_text(text)
        refused(capsys, [*asked, "--against", path], "--against", "schema 1")
    path.write_text(json.dumps(kept))
    assert read(path, engine) == kept


def test_the_best_preset_is_the_one_that_is_right_most_often(monkeypatch):
    """Not the one that is declared last; of two alike the one whose largest error is smaller."""
    lines = [
        {"source": "e:one", "cases": 4, "agree": 4, "max_error": 0.2},
        {"source": "e:two", "cases": 4, "agree": 4, "max_error": 0.1},
        {"source": "e:last", "cases": 4, "agree": 3, "max_error": 0.01},
    ]
    monkeypatch.setattr(score, "swept", lambda _: pd.DataFrame(lines))
    found = score.finding({})
    assert found.startswith("e:two") and "all 4" in found and "10 %" in found


ENGINES_HERE = [
    name if name in core_engines() else pytest.param(name, marks=pytest.mark.slow)
    for name in installed_engines()
]


@pytest.mark.parametrize("name", ENGINES_HERE)
def test_no_engine_is_accused(name):
    assert problem_of(name) == ""
    # what takes n steps within a step has its velocity at 1 - 1/2n: Rapier's own settings take 4, 8
    substeps = {"rapier:default": 4, "rapier:default-at-rest": 4, "rapier:recommended": 8}
    for use in map(resolve, uses_of(name)):
        if use.used.stepping is not Stepping.OWN:
            lag = 0.5 - 0.5 / substeps.get(f"{name}:{use.preset}", 1)
            declared = world_of(use).moment.value
            assert measured_moment(use) - declared == pytest.approx(lag, abs=0.03)


NO_WORLDS = {
    "wrong:NoStep": "has no method step; it must have state, fault, close, step",
    "wrong:NoState": "has no method state",
    "wrong:NoFault": "has no method fault",
    "wrong:NoClose": "has no method close",
    "wrong:NoMoment": "has no moment; it must be one of Moment.MIDDLE, END and NEXT",
    "wrong:Turned": "theta -0.0804 of a block put to 0.0804",
    "wrong:Backwards": "rate -0.0982 of a block put to 0.0982",
    "wrong:Mirrored": "pulled towards +x, its block turns to theta -0.0",
    "wrong:Middle": "hold +1 of a step from the Moment.MIDDLE that its world declares; it must "
    "declare Moment.NEXT",
    "wrong:End": "must declare Moment.NEXT",
    "wrong:Moreau": "must declare Moment.END",
    "hostile:Calm": "",  # what does not move has no moment
    "my_engine:World": "",
}


@pytest.mark.parametrize("place", NO_WORLDS)
def test_what_is_no_world_is_told_in_a_line(place, alone):
    pytest.importorskip("pymunk")
    found = problem_of(announce(place))
    assert NO_WORLDS[place] in found and bool(found) == bool(NO_WORLDS[place])
