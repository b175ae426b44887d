"""One engine on one page: registered, at a place, or nothing but what builds its world."""

import math
import shutil
from collections import Counter

import pandas as pd
import pytest
from commanding import refused

from analytic import simulate
from engines import core_engines, installed_engines
from engines.declaration import Stepping
from studies import respond, score
from studies.__main__ import run
from studies.kit.run import run as measured
from studies.kit.store import write_record
from studies.kit.tables import split, write_table
from studies.measures.world import OFF, check, checked
from studies.score import CASE, EXTREMES, MODEL, STEPS, STUDY, SWEEP, since, uses_of
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
        ("wrong:SPACED", "is called 'my engine'; a name is made of letters"),
        ("rocking_moreau:SLACK", "is neither a declaration nor what builds a world"),
        ("wrong:Turned", "ENGINE is 'wrong:Turned': rotation or rate at the start, over what it"),
        ("wrong:Silent", "ENGINE is 'wrong:Silent': RuntimeError: there is no answer"),
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
    assert min(counts.values()) > 0 and len(counts) == 6
    assert {job.source.partition(":")[2] for job in quick} == {"default", "tuned", "landing"}
    assert {job.source for job in score.jobs(["moreau:tuned"], True)} == {"moreau:tuned"}


def test_each_table_has_its_rows_with_its_own_columns(few):
    asked = [job for job in few(["mujoco:landing"], True) if job.labels["part"] != EXTREMES]
    tables = STUDY.tabulate(split(measured(asked, score.measure), "part"))
    assert {name: len(table) for name, table in tables.items() if len(table)} == {
        "score-model": 13, "score-sweep": 2, "score-steps": 2, "score-frame": 1
    }  # fmt: skip
    assert tables[SWEEP]["figure"].dtype == int and "method" not in tables[SWEEP]
    assert tables["score-steps"]["runs"].min() >= 1
    assert abs(tables["score-frame"]["error"].item()) < 1e-2


@pytest.mark.slow
def test_the_page_the_result_and_what_moved_since(alone, few, tmp_path, capsys):
    pytest.importorskip("pymunk")
    out, then = tmp_path / "out", tmp_path / "then"
    asked = ["score", MINE, "--quick", "--out", str(out)]
    assert run(asked) == 0
    assert capsys.readouterr().out.strip() == (out / "findings.txt").read_text().strip()
    assert {path.name for path in out.glob("*.png")} == {"score.png", "extremes.png"}
    assert (out / "score.html").read_text().count("<table") >= 6
    tables = STUDY.read(out)
    assert tables[SWEEP]["figure"].dtype == int and "verdict" not in tables[SWEEP]
    swept, errors = score.answers(tables).set_index(["source", "case"]), []
    for job in few(["my_engine"], True):
        if (job.labels["part"], job.source) == (SWEEP, "my_engine:landing"):
            case, name = job.case, "/".join(str(job.labels[column]) for column in CASE)
            found = respond(job.source, case.system, case.motion)
            right = simulate(case.system, case.motion)
            rocked = found.outcome.value == "rocked"
            told = swept.loc[(job.source, name)]
            assert told["outcome"] == found.outcome.value
            assert told["peak_ratio"] == found.peak_ratio or not rocked
            errors += [abs(found.peak_ratio / right.peak_ratio - 1.0)] * rocked
    numbers = score.swept(tables).set_index("source").loc["my_engine:landing"]
    assert numbers["max_error"] == pytest.approx(max(errors), rel=1e-6)
    assert (numbers["cases"], numbers["agree"], numbers["no_answer"]) == (2, 2, 0)
    shutil.copytree(out, then, ignore=shutil.ignore_patterns("*.sqlite"))
    asked[1] = "my_engine"  # it is known by now
    assert run([*asked, "--against", str(then)]) == 0
    assert "Since rocking" in capsys.readouterr().out.splitlines()[-1]
    refused(capsys, ["score", "pymunk", "--quick", "--out", out], "my_engine")


def results(peaks):
    words = {math.inf: "overturned", 0.0: "at rest"}
    rows = pd.DataFrame(
        {**dict.fromkeys(CASE, name), "source": source, "outcome": words.get(peak, "rocked"),
         "peak_ratio": peak}
        for source, found in peaks.items() for name, peak in found.items()
    )  # fmt: skip
    return {SWEEP: rows[1:], EXTREMES: rows[:1].assign(case="first")}


def test_what_moved_is_beyond_noise():
    peaks = {"same": 0.5, "noise": 0.5, "little": 0.5, "more": 0.5, "fell": 0.5, "rose": 0.0}
    moved = {"first": 0.4, "noise": 0.5 * (1 + 9e-7), "little": 0.5 * (1 + 2e-6), "more": 0.3}
    moved |= {"fell": math.inf, "rose": 0.25, "new": 1.0}
    then = results(
        {"e:tuned": {"first": 0.2, **peaks, "stays": math.inf, "gone": 1.0}, "e:old": peaks}
    )
    now = results({"e:tuned": {**moved, "same": 0.5, "stays": math.inf}, "e:new": peaks})
    said, other, most = since(then, now).split("\n\n")
    assert said.startswith("2 of 8 answers") and "3 peaks" in said
    rows = [[line.split()[1].split("/")[0] for line in each.splitlines()] for each in (other, most)]
    assert rows == [["case", "fell", "rose"], ["case", "first", "more", "little"]]


def test_what_is_no_earlier_result_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(score, "jobs", None)
    asked = ["score", "mujoco", "--against", tmp_path]
    refused(capsys, asked, "--against", "must hold what scoring mujoco wrote")
    tables = results({"pymunk:tuned": {"first": 0.2, "second": 0.5}})
    for name, table in tables.items():
        write_table(tmp_path / f"{name}.csv", table)
    refused(capsys, asked, "--against", f"{SWEEP}.csv must be beside")
    write_record(tmp_path, {"version": "0.2", "engines": {"pymunk": "7.0"}, "runs": []})
    refused(capsys, asked, "--against", "must hold what scoring mujoco wrote")
    versions, kept = score.read(tmp_path, "pymunk")
    assert versions == "rocking 0.2, pymunk 7.0"
    assert since(kept, tables).startswith("0 of 2 answers")


def test_the_best_preset_is_the_one_that_is_right_most_often(monkeypatch):
    """Not the one that is declared last; of two alike the one whose largest error is smaller."""
    lines = [
        {"source": "e:one", "cases": 4, "agree": 4, "max_error": 0.2},
        {"source": "e:two", "cases": 4, "agree": 4, "max_error": 0.1},
        {"source": "e:last", "cases": 4, "agree": 3, "max_error": 0.01},
    ]
    monkeypatch.setattr(score, "swept", lambda _: pd.DataFrame(lines))
    monkeypatch.setattr(score, "along_step", lambda _: {})
    found = score.finding({MODEL: pd.DataFrame({"verdict": []})})
    assert found.startswith("e:two") and "all 4" in found and "10 %" in found


ENGINES_HERE = [
    name if name in core_engines() else pytest.param(name, marks=pytest.mark.slow)
    for name in installed_engines()
]


@pytest.mark.parametrize("name", ENGINES_HERE)
def test_no_engine_is_accused(name):
    rapiers_substeps = {"default": 4, "default-at-rest": 4, "recommended": 8, "pasted": 8}
    for use in map(resolve, uses_of(name)):
        lines = check(use)
        assert [line.wrong for line in lines if line.wrong] == []
        own = use.used.stepping is Stepping.OWN
        assert len(lines) == (1 if own else 10 if use.name == checked(name) else 3)
        for moment in (line for line in lines if line.within == OFF):
            lag = 0.5 - 0.5 / (rapiers_substeps.get(use.preset, 1) if name == "rapier" else 1)
            assert moment.expected - moment.found == pytest.approx(lag, abs=0.03)


REFUSED = True
WRONG = {
    "wrong:Turned": (REFUSED, "-1 and must be 1"),
    "wrong:Backwards": (REFUSED, "-1 and must be 1"),
    "wrong:Mirrored": (REFUSED, "-1 and must be 1"),
    "wrong:Middle": (REFUSED, "0.5 and must be 1.5"),
    "wrong:End": (REFUSED, "1 and must be 1.5"),
    "wrong:Moreau": (REFUSED, "0.5 and must be 1"),
    "wrong:Silent": (REFUSED, "RuntimeError: there is no answer"),
    "wrong:Faultless": (REFUSED, "TypeError: "),
    "hostile:Calm": (REFUSED, "0 and must be 1"),
    "wrong:Spun": (not REFUSED, "inertia over mass [m2] is 0.2146 and must be 0.2083"),
    "wrong:Heavy": (not REFUSED, "inertia over mass [m2] is 0.1894 and must be 0.2083"),
    "wrong:Pulled": (not REFUSED, "pull times step, is 1.02 and must be 1"),
    "wrong:Damped": (not REFUSED, "0.9908 and must be 1"),
    "wrong:Wide": (not REFUSED, "0.3277 and must be 0.3218"),
    "wrong:Slippery": (not REFUSED, "0.15 and must be 0.3"),
    "wrong:Bouncing": (not REFUSED, "0.2266 and must be 0"),
    "my_engine:World": (not REFUSED, ""),
}
"""Place of an engine -> whether it is refused, and what the model check says of it."""


@pytest.mark.parametrize("place", WRONG)
def test_one_wrong_quantity_is_named(place, alone):
    pytest.importorskip("pymunk")
    engine = announce(place, lambda place: place.rpartition(":")[2])
    (job,) = (job for job in score.jobs([f"{engine}:tuned"], True) if job.labels["part"] == MODEL)
    row, (refused_, words) = score.look(job), WRONG[place]
    assert (row["refused"], row["outcome"]) == (refused_, "failed" if words else "right")
    assert words in row["message"]
    lines = score.model(pd.DataFrame([{**job.labels, "source": engine, **row}]))
    assert len(lines) == (0 if "Error" in words else 10 - 4 * refused_ - ("Calm" in place))
    assert bool(words) == ("Error" in words or (lines["verdict"] == "wrong").any())


@pytest.mark.parametrize(("last", "said"), [(0.080, True), (0.024, False), (9e-4, False)])
def test_an_error_that_no_step_shrinks_is_none_of_the_step(last, said):
    steps = pd.DataFrame({"source": "e:one", "set": "typical", "value": [0.05, 0.01, 2e-3]})
    errors = score.along_step(
        {STEPS: steps.assign(error=[0.3, max(0.083, 100 * last * (last < 1e-3)), last])}
    )["e:one"]
    assert score.no_matter_of_the_step(errors) is said
