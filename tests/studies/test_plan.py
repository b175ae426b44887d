"""The one way a study is made: its folder, tables and exit code, whatever the study."""

import json
import math
import os
import pickle
import re
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import pandas as pd
import pytest
from given import BLOCK

from analytic import SinePulse, simulate
from analytic.response import Response
from studies import respond
from studies.cases.paper import HISTORIES as PANELS
from studies.cases.refusal import BadInputError
from studies.histories import STUDY as HISTORIES
from studies.histories import study as histories
from studies.old import provenance
from studies.old.jobs import Job
from studies.old.journal import FolderError
from studies.old.options import DEFAULT_RUNNING, PatientRunning
from studies.old.plan import Plan, by_label, carry_out, fill
from studies.old.study import Study
from studies.old.tables import read_table, write_table
from studies.measures.published import PUBLISHED
from studies.scenes import STUDY as SCENES
from studies.scenes import summaries as scenes
from studies.sources.registry import SOURCES, UnknownSourceError, resolve

PULSE = SinePulse.in_g(0.4, omega=2.0 * math.pi)
STUDY = Study(name="made-up", module="studies.sweep.study", help="", tables=("made-up.csv",))


def job(label, **more):
    return Job(labels={"table": label, **more}, block=BLOCK, motion=PULSE, source="exact")


def answered(job, source):
    if job.labels["table"] == "lost":
        return Response.failure("lost")
    return simulate(job.block, job.motion)


def test_each_value_of_a_label_is_a_table(tmp_path):
    plan = Plan(jobs=[job("b"), job("a"), job("b", n=2)], ask=answered, tabulate=by_label("table"))
    rows = fill(STUDY, plan, tmp_path)
    assert list(by_label("table")(rows)) == ["b", "a"]
    assert [len(pd.read_csv(tmp_path / f"{name}.csv")) for name in "ab"] == [1, 2]
    assert not (tmp_path / "made-up.csv").exists()


def test_a_failure_counts_where_the_row_is_needed(tmp_path, capsys):
    plan = Plan(jobs=[job("a"), job("lost")], ask=answered)
    assert carry_out(STUDY, plan, tmp_path, DEFAULT_RUNNING, lambda folder: folder.name) == 1
    said = capsys.readouterr()
    assert said.out == f"{tmp_path.name}\n"
    assert said.err == "failed: exact: lost\n"
    for label, code in (("a", 0), ("lost", 1)):
        asked = replace(plan, needed=lambda rows, n=label: [r for r in rows if r["table"] == n])
        assert carry_out(STUDY, asked, tmp_path, DEFAULT_RUNNING, str) == code


def test_tables_that_no_job_makes_are_written_with_their_provenance(tmp_path):
    made = pd.DataFrame({"x": [1.0, 0.1 + 0.2, math.nan]})
    assert fill(STUDY, Plan(settings={"n": 3}, tabulate=lambda rows: {"x": made}), tmp_path) == []
    assert (tmp_path / "x.csv").read_text() == "x\n1.0\n0.30000000000000004\nnan\n"
    record = json.loads((tmp_path / "provenance.json").read_text())
    assert record["settings"] == {"n": 3}
    assert "rows" not in record["runs"][0]
    with pytest.raises(FolderError, match="settings"):
        fill(STUDY, Plan(settings={"n": 4}), tmp_path)


def test_nobody_else_writes_while_tables_are_made(tmp_path):
    def tabulate(rows):
        with pytest.raises(FolderError, match="in use"):
            fill(STUDY, Plan(), tmp_path)
        return {}

    fill(STUDY, Plan(tabulate=tabulate), tmp_path)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, OSError])
def test_what_stops_while_tables_are_made_says_how_to_go_on(stop, tmp_path):
    def tabulate(rows):
        raise stop

    with pytest.raises(Exception if stop is OSError else stop, match="2 of 2 rows are kept"):
        fill(STUDY, Plan(jobs=[job("a"), job("b")], ask=answered, tabulate=tabulate), tmp_path)
    with pytest.raises(stop) as bare:
        fill(STUDY, Plan(tabulate=tabulate), tmp_path / "no jobs")
    assert "kept" not in str(bare.value)


def test_a_study_with_more_patience_keeps_it_beside_other_options():
    assert (DEFAULT_RUNNING.time_limit, PatientRunning(jobs=2).time_limit) == (60.0, 180.0)


def test_histories_go_on_where_they_stopped_to_the_bit(tmp_path):
    """Samples come back from the journal as they went in."""
    shown = product(PANELS[5], ("exact", "housner"))
    plan = Plan(
        jobs=[histories.history_job(*each) for each in shown],
        reduce=histories.reduce,
        tabulate=histories.tabulate,
    )
    whole = fill(HISTORIES, plan, tmp_path / "whole")
    kept = (tmp_path / "whole" / "figure-5.csv").read_bytes()
    assert fill(HISTORIES, replace(plan, ask=partial(plan.ask, None)), tmp_path / "whole") == whole
    assert (tmp_path / "whole" / "figure-5.csv").read_bytes() == kept
    case = plan.jobs[0]
    direct = simulate(case.block, case.motion, duration=case.duration, times=case.times)
    found = whole[0]["samples"]["theta_ratio"]
    assert found == (direct.history.theta / case.block.alpha).tolist()


def test_a_table_is_written_to_the_bit(tmp_path):
    values = [math.pi, 1e-300, 2.0**-1074, 1.0 + 2.0**-52]
    write_table(tmp_path / "t.csv", pd.DataFrame({"x": values}))
    back = pd.read_csv(tmp_path / "t.csv")
    assert back["x"].tolist() == values


def test_provenance_tells_a_run_that_computes_all_from_one_that_goes_on(tmp_path):
    for jobs in ([job("a")], [job("a"), job("b")]):
        carry_out(STUDY, Plan(jobs=jobs, ask=answered), tmp_path, DEFAULT_RUNNING, str)
    record = provenance.record_of(tmp_path)
    assert [(run["rows"], run["computed"]) for run in record["runs"]] == [(1, 1), (2, 1)]
    assert provenance.whole_runs(record) == record["runs"][:1]


def test_the_time_of_a_run_is_that_of_the_command(tmp_path):
    """What is reduced and drawn after the tables is waited for, too."""
    assert carry_out(STUDY, Plan(), tmp_path, DEFAULT_RUNNING, lambda _: str(time.sleep(0.2))) == 0
    assert provenance.record_of(tmp_path)["runs"][0]["duration_s"] > 0.2


def test_the_first_run_after_an_installation_is_told_from_later_ones(tmp_path):
    code = """
from pathlib import Path
import numpy as np
from analytic.cases import fill_restitution
from studies.old.provenance import begin
print(begin(Path("a.json"), {}, {})["runs"][-1]["first"])
fill_restitution.run(np.ones(1), np.ones(1))
print(begin(Path("a.json"), {}, {})["runs"][-1]["first"])
"""
    paths = os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")])
    kept = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept"), "PYTHONPATH": paths}
    said = [
        subprocess.run(
            [sys.executable, "-c", code], env=kept, cwd=tmp_path, capture_output=True, text=True
        ).stdout.split()
        for _ in range(2)
    ]
    assert said == [["True", "False"], ["False", "False"]]


@pytest.mark.parametrize(
    ("source", "options", "problem"),
    [
        ("mujoco", {"frction": 0.8}, "option is 'frction', perhaps 'friction'; it must be one of"),
        ("mujoco:naive", {"settings": {"dampin": 1.0}}, "setting is 'dampin', perhaps 'damping'"),
        ("mujoco", {"settings": {"iterations": -1}}, "iterations is -1; it must be 0 or more"),
        ("pymunk", {"friction": -1.0}, "friction is -1.0; it must not be negative"),
        ("box2d", {"accuracy": "tigt"}, "accuracy is 'tigt', perhaps 'tight'"),
        ("exact", {"friction": 0.8}, "option is 'friction'; it must be one of start,"),
        ("rk4", {"stepp": 0.1}, "option is 'stepp', perhaps 'step'"),
        ("radau", {"step": 0.1}, "option is 'step'; it must be one of rtol,"),
    ],
)
def test_what_a_source_cannot_be_asked_is_refused_before_the_first_case(source, options, problem):
    with pytest.raises(BadInputError) as refused:
        Job(labels={}, block=BLOCK, motion=PULSE, source=source, options=options)
    assert str(refused.value).startswith(f"source {source!r} cannot be asked so: {problem}")
    with pytest.raises(ValueError, match=re.escape(problem)):
        respond(source, BLOCK, PULSE, **options)


def test_a_job_travels_with_what_its_name_meant(monkeypatch):
    """Another process knows the names of the registry alone."""
    monkeypatch.setitem(SOURCES, "mine", resolve("housner"))
    job = Job(labels={}, block=BLOCK, motion=PULSE, source="mine")
    monkeypatch.undo()
    sent = pickle.loads(pickle.dumps(job))
    assert replace(sent, labels={"case": 1}).asked.model == "housner"
    assert replace(sent, source="exact").asked.model == "exact"
    with pytest.raises(UnknownSourceError):
        replace(sent, source="another")


def test_an_empty_table_keeps_its_head_and_is_read(tmp_path):
    """Of the scenes nobody asked about: each has the columns that it has where somebody did."""
    fill(SCENES, Plan(tabulate=lambda _: scenes.tabulate([])), tmp_path)
    told = pd.read_csv(PUBLISHED / "columns.csv")
    for path in tmp_path.glob("*.csv"):
        head = told.loc[told["table"] == f"scenes/{path.name}", "column"]
        assert list(read_table(path).columns) == list(head) != [], path.name
    (tmp_path / "blank.csv").write_text("\n")
    assert read_table(tmp_path / "blank.csv").empty
