"""One engine on one page: registered, at a place, or nothing but what builds its world."""

import json
import re
import subprocess
import sys
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import pandas as pd
import pytest
from commanding import refused

from analytic import RigidBlock, SinePulse, simulate
from engines import ENGINES
from engines.declaration import Stepping
from engines.registry import announce
from engines.undeclared import undeclared
from studies import respond
from studies.__main__ import COMMANDS, run
from studies.old.app import make_app
from studies.old.fingerprint import ROOT
from studies.old.jobs import Job
from studies.old.options import Running
from studies.old.plan import Plan, fill
from studies.old.provenance import record_of
from studies.score import STUDY
from studies.score import report as score_report
from studies.score import study as score
from studies.score.result import CASE, MEASURES, Requirement, read, required, result_of, since
from studies.sources import registry as sources

MINE = "my_engine:World"
"""In tests/plugin: a class that builds its world, and no declaration."""


def test_what_builds_a_world_is_an_engine(alone):
    pytest.importorskip("pymunk")
    assert announce(MINE) == "my_engine"
    engine = ENGINES["my_engine"]
    assert [use.stepping for use in engine.presets] == [Stepping.FIXED, Stepping.LANDING]
    assert engine.best.settings.friction == 1.0


def test_an_engine_that_is_announced_is_known_to_processes_that_are_started(alone):
    pytest.importorskip("pymunk")
    announce(MINE)
    code = "from engines import ENGINES; print(ENGINES['my_engine'].presets[-1].name)"
    path = f"import sys; sys.path[:0] = {sys.path!r}; "
    done = subprocess.run([sys.executable, "-c", path + code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("landing\n", "")


def test_an_engine_that_is_announced_makes_no_row_stale(alone, tmp_path, capsys):
    pytest.importorskip("pymunk")
    block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=3.9, omega=6.3)

    def computed(*names):
        jobs = [Job(labels={}, block=block, motion=pulse, source=name) for name in names]
        fill(STUDY, Plan(jobs=jobs, growing={"source": names}), tmp_path, Running(jobs=1))
        return record_of(tmp_path)["runs"][-1]["computed"]

    assert computed("exact", "mujoco") == 2
    sources.announce(MINE)
    assert computed("exact", "mujoco", "my_engine") == 1
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("nothing", "ENGINE is 'nothing'; it must be one of pybullet, mujoco"),
        ("pymunk:fixd", "preset of pymunk is 'fixd', perhaps 'fixed'; it must be one of naive"),
        ("no_such_module:ENGINE", "No module named 'no_such_module'"),
        ("my_engine:Wheel", "has no attribute 'Wheel'"),
        (":World", "it must be like my_package.mine:ENGINE"),
        ("my_engine:World:World", "it must be like my_package.mine:ENGINE"),
        ("my engine:World", "it must be like my_package.mine:ENGINE"),
        ("rocking_moreau:ENGINE", "is called 'moreau', as another is"),
        ("rocking_moreau:SLACK", "is neither a declaration nor what builds a world"),
    ],
)
def test_what_is_no_engine_is_refused_in_a_line(place, message, alone, tmp_path, capsys):
    refused(capsys, ["score", place, "--out", tmp_path], message)


def test_quick_asks_a_part_of_every_preset():
    quick, full = (score.score_jobs("moreau", some) for some in (True, False))
    counts = Counter(job.labels["table"] for job in full)
    assert counts[score.SWEEP] == 3 * 960
    assert {job.labels["table"] for job in quick} == set(counts)
    assert {job.source.partition(":")[2] for job in quick} == {"naive", "fixed", "landing"}
    assert len(quick) < len(full) / 10


def tables_of(name):
    return {job.labels["table"] for job in score.score_jobs(name, True)}


def test_an_engine_is_asked_about_the_scenes_that_it_declares(alone):
    """One of which nothing is declared has one body, which slides, too."""
    pytest.importorskip("pymunk")
    for place in (MINE, "stacks:ENGINE"):
        sources.announce(place)
    assert tables_of("stacks") - tables_of("my_engine") == {"score-frame"}
    assert "score-slide" in tables_of("my_engine")
    slides = [
        job for job in score.score_jobs("my_engine", True) if job.labels["table"] in score.BEYOND
    ]
    assert {job.source for job in slides} == {"my_engine:fixed"}  # nothing there to land on


def test_the_page_of_an_engine_that_stacks(alone, few, tmp_path, capsys):
    pytest.importorskip("pymunk")
    assert run(["score", "stacks:ENGINE", "--quick", "--out", str(tmp_path)]) == 0
    page = capsys.readouterr().out
    words = "beyond one body several bodies on one base and bodies that rest on other bodies."
    assert words in " ".join(page.split())
    for head, name in (("A rocking frame:", "frame"), ("A sliding block:", "slide")):
        line = next(text for text in page.partition(head)[2].splitlines() if "stacks:fixed" in text)
        rows = pd.read_csv(tmp_path / f"score-{name}.csv")
        assert line.split()[1] == f"{len(rows)}"
        job = next(job for job in few("stacks", True) if job.labels["table"] == f"score-{name}")
        again = respond("stacks:fixed", job.block, job.motion, **job.options)
        assert rows["peak_ratio"].iloc[0] == again.peak_ratio
        assert rows["outcome"].iloc[0] == ("rocked" if name == "frame" else "slid")


def test_the_page(alone, few, tmp_path, capsys):
    """Of an engine that does not declare itself: its numbers are those that `respond` gives."""
    pytest.importorskip("pymunk")
    kept = tmp_path / "kept.json"
    required = ("--require", "outcomes=2", "--require", "fixed:max=1e-9", "--json", str(kept))
    assert run(["score", MINE, "--quick", "--out", str(tmp_path), *required]) == 1
    page, _, said = capsys.readouterr().out.partition("holds: ")
    assert page.strip() == (tmp_path / "score.txt").read_text().strip()
    for words in ("my_engine:fixed gets", "wall_s", "extreme cases", "helped by  steps that"):
        assert words in page
    assert "falls short: fixed:max" in said
    rows = pd.read_csv(tmp_path / "score-sweep.csv")
    assert sorted(rows["source"].unique()) == ["my_engine:fixed", "my_engine:landing"]
    assert {path.name for path in tmp_path.glob("*.png")} == {"score.png", "extremes.png"}
    job = few("my_engine", True)[0]
    again = respond(job.source, job.block, job.motion)
    assert rows["peak_ratio"].iloc[0] == again.peak_ratio > 0.0
    peaks = json.loads(kept.read_text())["peaks"]["fixed"]
    assert peaks["6/half-sine/0.05/2/0.5/0.1"] == again.outcome.value == "overturned"


@pytest.mark.slow
def test_the_example_of_the_readme_ends_with_0(alone, tmp_path, monkeypatch):
    """A block thrown about before a slow pulse can lift it lands on its impacts for ever."""
    pytest.importorskip("pymunk")
    everything = score.score_jobs
    case = {"figure": 7, "aspect": 4, "width_m": 0.5, "omega_over_p": 0.1}

    def and_that_case(name, quick):
        slow = [job for job in everything(name, False) if case.items() <= job.labels.items()]
        return [*everything(name, quick), *(j for j in slow if j.labels["table"] == score.SWEEP)]

    monkeypatch.setattr(score, "score_jobs", and_that_case)
    assert run(["score", MINE, "--quick", "--out", str(tmp_path)]) == 0
    rows = pd.read_csv(tmp_path / "score-sweep.csv")
    slow = rows[rows["figure"] == 7]
    assert [*slow["source"]] == ["my_engine:fixed", "my_engine:landing"]
    assert set(slow["outcome"]) == {"overturned"}


def test_one_preset_of_an_engine_is_scored_alone(few, tmp_path, capsys):
    kept, out = tmp_path / "kept.json", tmp_path / "out"
    asked = ("score", "mujoco:fixed", "--quick", "--out", str(out), "--json", str(kept))
    assert run([*asked, "--require", "outcomes=2", "fixed:failed=0"]) == 0
    page = capsys.readouterr().out
    assert "holds: fixed:outcomes must be at least 2" in page
    result = json.loads(kept.read_text())
    assert (result["engine"], [*result["presets"]], [*result["peaks"]]) == (
        *("mujoco", ["fixed"], ["fixed"]),
    )
    refused(capsys, [*asked, "--require", "landing:failed=0"], "--require", "fixed and a colon")
    refused(capsys, ["score", "mujoco", "--quick", "--out", out], "same study and settings")


@pytest.mark.slow
def test_a_result_is_kept_and_the_next_one_held_against_it(few, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asked = ["score", "mujoco", "--quick", "--json", "result.json"]
    assert run([*asked, "--require", "outcomes=2", "failed=0", "naive:max=1e-9"]) == 1
    *held, short = capsys.readouterr().out.splitlines()[-3:]
    assert held == [
        "holds: landing:outcomes must be at least 2, and is 2",
        "holds: landing:failed must be at most 0, and is 0",
    ]
    assert short.startswith("falls short: naive:max must be at most 1e-09, and is ")
    kept = json.loads(Path("result.json").read_text())
    assert list(kept) == ["schema", "engine", "versions", "presets", "peaks", "moments"]
    assert (kept["schema"], kept["engine"]) == (1, "mujoco")
    assert kept["versions"]["mujoco"] == version("mujoco")

    jobs = [job for job in few("mujoco", True) if job.source == "mujoco:landing"]
    swept = [job for job in jobs if job.labels["table"] == score.SWEEP]
    errors = []
    for job in swept:
        name = "/".join(str(job.labels[column]) for column in CASE)
        found, right = respond(job.source, job.block, job.motion), simulate(job.block, job.motion)
        rocked = found.outcome.value == "rocked"
        expected = found.peak_ratio if rocked else found.outcome.value
        assert kept["peaks"]["landing"][name] == expected
        errors += [abs(found.peak_ratio / right.peak_ratio - 1.0)] * rocked
    numbers = kept["presets"]["landing"]
    assert numbers["max"] == pytest.approx(max(errors), rel=1e-6)
    assert (numbers["cases"], numbers["outcomes"], numbers["failed"]) == (len(swept), 2, 0)
    assert (numbers["extreme"], numbers["extremes"]) == (2, 2)

    kept["peaks"]["landing"][name] = "slid"
    Path("before.json").write_text(json.dumps(kept))
    monkeypatch.setattr(score, "carry_out", lambda *_: 1)  # the rows are there, and some failed
    assert run(asked) == 1
    assert run([*asked, "--against", "before.json"]) == 0
    assert "1 have another outcome, and 0 peaks moved" in capsys.readouterr().out
    assert run([*asked, "--against", "result.json", "--require", "naive:max=1e-9"]) == 1
    assert "0 have another outcome, and 0 peaks moved" in capsys.readouterr().out
    matrix = pd.read_csv("score/score-extremes.csv")
    one_each = matrix["verdict"].mask(~matrix["source"].duplicated(), "invalid")
    matrix.assign(verdict=one_each).to_csv("score/score-extremes.csv", index=False)
    numbers = result_of(Path("score"), ENGINES["mujoco"])["presets"]["landing"]
    assert (numbers["extreme"], numbers["extremes"]) == (1, 1)


def test_what_moved_is_beyond_noise():
    peaks = {"same": 0.5, "noise": 0.5, "little": 0.5, "more": 0.5, "fell": 0.5, "rose": "slid"}
    then = {"versions": {"engine": "1.0"}, "peaks": {"fixed": {**peaks, "gone": 1.0}, "old": peaks}}
    moved = {"noise": 0.5 * (1 + 9e-7), "little": 0.5 * (1 + 2e-6), "more": 0.3}
    moved |= {"fell": "overturned", "rose": 0.25, "new": 1.0}
    said = since(then, {"peaks": {"new": peaks, "fixed": peaks | moved}})
    head, other, most = said.split("\n\n")
    assert head.startswith("Since engine 1.0: of 6 answers 2 have another outcome, and 2 peaks")
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
    assert Requirement("fixed", "extreme", 0.5).judged(result)[0] is least
    assert Requirement("fixed", "p90", 0.5).judged(result)[0] is most


def test_a_requirement_is_of_the_best_preset_or_of_the_one_it_names():
    assert required("p90=1e-3", ENGINES["mujoco"]) == ("landing", "p90", 1e-3)
    assert required("naive:failed=0", ENGINES["mujoco"]) == ("naive", "failed", 0.0)


SCORE = ["score", "mujoco"]
WRITTEN = {"schema": 1, "engine": "mujoco", "versions": {}, "presets": {}, "peaks": {}}


def test_what_is_no_requirement_is_refused_before_anything_runs(capsys, monkeypatch):
    monkeypatch.setattr(score, "carry_out", None)
    of_a_name = ("p90", "p95=1", "P90=1", "best:p90=1", ":p90=1", "fixed:=1", "=1")
    for text in (*of_a_name, "p90=", "p90=x", "p90=-1", "p90=nan", "max=inf", "p90=1=1"):
        refused(capsys, [*SCORE, "--require", text], "--require", repr(text))
    refused(capsys, [*SCORE, "--require"], "--require")  # as a shell writes an empty variable
    refused(capsys, [*SCORE, "--json", "nowhere/result.json"], "--json")


BROKEN = ("[", "[" * 10**5, "[]", "5", "null", "{}", '"schema engine"', "\0", "")
FOREIGN = (
    *({"schema": 2}, {"engine": "pymunk"}, {"versions": 1}, {"peaks": [1.0]}),
    *({"peaks": {"fixed": value}} for value in (1.0, {"a case": [1.0]}, {"a case": 10**400})),
)


def test_what_is_no_earlier_result_is_refused_before_anything_runs(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(score, "carry_out", None)
    for path in (tmp_path, tmp_path / "nothing", "/dev/zero"):
        refused(capsys, [*SCORE, "--against", path], "--against", "it is no file")
    kept = tmp_path / "before.json"
    for text in (*BROKEN, *(json.dumps(WRITTEN | other) for other in FOREIGN)):
        kept.write_text(text)
        refused(capsys, [*SCORE, "--against", kept], "--against", "schema 1")
    kept.write_text(json.dumps(WRITTEN))
    assert read(kept, ENGINES["mujoco"]) == WRITTEN


def test_the_workflow_to_paste_says_what_is_taken():
    guide = (ROOT / "studies" / "GUIDE.md").read_text(encoding="utf-8")
    workflow = re.search("```yaml\n(.*?)```", guide, re.DOTALL)[1]
    (line,) = re.findall("- run: rocking (.*)", workflow)
    _, bound, ignored = make_app(COMMANDS).parse_args(line, exit_on_error=False)
    assert (bound.args, ignored) == ((MINE,), {})
    engine = undeclared("my_engine", None, "my_engine")
    assert [required(text, engine).preset for text in bound.kwargs["require"]] == ["fixed"] * 2
    assert all(f"`{measure}`" in guide for measure in MEASURES)


def test_the_best_preset_is_the_one_that_is_right_most_often(monkeypatch):
    """Not the one that is declared last; of two alike the one whose largest error is smaller."""
    kinds = {"fall_wrong": 0, "rest_wrong": 0, "no_answer": 0, "cases": 4}
    lines = [
        {**kinds, "source": "e:one", "agree": 4, "max_error": 0.2},
        {**kinds, "source": "e:two", "agree": 4, "max_error": 0.1},
        {**kinds, "source": "e:last", "agree": 3, "max_error": 0.01, "no_answer": 1},
    ]
    # a folder's own rows take a run of an engine each
    monkeypatch.setattr(score_report, "swept", lambda _: pd.DataFrame(lines))
    said = score_report.finding(Path())
    assert said == "e:two gets all 4 outcomes right, and peaks within 10 %."
