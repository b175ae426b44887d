"""The paper's sweep: its table, summary, findings, figures and provenance."""

import json
import math
import sys
import tomllib
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commanding import redrawn

from analytic import simulate
from engines import ENGINES, core_engines
from studies.cases.paper import sweep_cases
from studies.kit.executors import Local
from studies.kit.jobs import summary
from studies.kit.options import Running
from studies.kit.plan import fill
from studies.kit.runner import run_jobs
from studies.measures.claims import said_once
from studies.measures.differences import summarize, with_reference, worst_cases
from studies.measures.findings import findings
from studies.sources.registry import DEFAULT_EFFORT, SOURCES
from studies.sweep import STUDY
from studies.sweep import study as sweep

HERE = Path(__file__).parent
MODELS_AND_SOLVERS = [name for name, its in SOURCES.items() if its.kind in ("model", "solver")]
ALONE = Running(jobs=1, time_limit=1.0)


@pytest.fixture(scope="module")
def whole():
    return sweep.plan([6, 7, 8, 9], MODELS_AND_SOLVERS)


@pytest.fixture(scope="module")
def swept(whole, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    rows = fill(STUDY, whole, folder, ALONE)
    return folder, rows, sweep.report(folder)


def test_the_models_sweep_has_its_columns_and_rows(swept):
    folder, rows, _ = swept
    table = pd.read_csv(folder / "sweep.csv")
    assert list(table.columns) == [
        *("figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p", "source"),
        *("outcome", "peak_ratio", "impacts", "steps", "wall_s", "message"),
    ]
    assert len(table) == len(rows) == 960 * len(MODELS_AND_SOLVERS)
    assert (table["peak_ratio"].eq(math.inf) == table["outcome"].eq("overturned")).all()
    assert not table["outcome"].eq("failed").any()


def test_the_conclusions_of_the_paper_fall_as_they_fall(swept):
    folder, _, text = swept
    table = sweep.read(folder)
    compared = with_reference(table)
    summary_table = summarize(compared).set_index(["figure", "source"])
    assert summary_table.loc[("all", "exact"), "agree"] == 960
    assert summary_table.loc[("all", "exact"), "max_error"] < 1e-10
    assert summary_table.loc[("all", "housner"), "false_overturnings"] > 0
    assert summary_table.loc[("all", "modified"), "missed_overturnings"] > 0
    found = findings(compared)
    verdicts = [item.holds for item in found]
    assert verdicts[:6] == [True, False, True, False, True, True]
    assert all(verdicts[6:])
    # two solvers against the exact solution, and the two widths of every source
    assert len(verdicts) == 6 + 2 + len(MODELS_AND_SOLVERS)
    assert (folder / "findings.txt").read_text().strip() == text
    assert [line.split()[0] for line in text.splitlines()[-8:]] == [
        "holds" if holds else "does" for holds in [*verdicts[:6], True, True]
    ]
    assert all(name in text.splitlines()[-1] for name in MODELS_AND_SOLVERS)


def test_findings_report_what_breaks_them(swept):
    compared = with_reference(sweep.read(swept[0]))
    calm = compared[compared["aspect"] == 4].assign(false_overturning=False)
    assert findings(calm)[0].holds is False
    wide = compared["width_m"].eq(1.0) & compared["source"].eq("exact")
    scaled = compared.assign(peak_ratio=compared["peak_ratio"].where(~wide, 2.0))
    coincide = {item.source: item.holds for item in findings(scaled) if "panels" in item.statement}
    assert coincide == {name: name != "exact" for name in MODELS_AND_SOLVERS}
    apart = [item for item in said_once(findings(scaled)) if "panels" in item.statement]
    held = {item.holds: "exact" in item.statement for item in apart}
    assert held == {False: True, True: False}
    lost = compared.assign(agrees=compared["agrees"] & ~compared["source"].eq("rk4"))
    disagreeing = [
        item
        for item in findings(lost)
        if "every outcome" in item.statement and item.source == "rk4"
    ]
    assert [item.holds for item in disagreeing] == [False]
    assert "960 of 960 cases differ; figure 6 H/B 2: ω/p 0.1–4;" in disagreeing[0].numbers
    alone = findings(compared[compared["source"] == "exact"])
    assert [item.holds for item in alone] == [None] * 6 + [True]


def test_errors_are_counted_against_the_exact_solution():
    jobs = [sweep.sweep_jobs([6], ["exact"], DEFAULT_EFFORT)[place] for place in (0, 9, 39)]
    rows = pd.DataFrame(run_jobs(jobs, executor=Local(1, 1.0), reduce=summary))
    assert rows["omega_over_p"].to_list() == [0.1, 1.0, 4.0]
    rows["outcome"] = ["rocked", "overturned", "rocked"]
    rows["peak_ratio"] = [0.5, math.inf, 2.0 * rows["peak_ratio"][2]]
    line = summarize(with_reference(rows)).iloc[0]
    assert (line["agree"], line["missed_overturnings"], line["false_overturnings"]) == (1, 1, 1)
    assert line["max_error"] == pytest.approx(1.0)


def test_the_worst_case_comes_with_its_conditioning(swept):
    worst = worst_cases(with_reference(sweep.read(swept[0]))).set_index("source")
    assert list(worst.index) == MODELS_AND_SOLVERS
    case = worst.loc["housner"]
    place = ["figure", "aspect", "width_m", "omega_over_p"]
    (posed,) = (
        each
        for each in sweep_cases([case["figure"]])
        if [getattr(each, name) for name in place] == case[place].to_list()
    )

    def peak(scale):
        stronger = replace(posed.motion, amplitude=scale * posed.motion.amplitude)
        return simulate(posed.block, stronger).peak_ratio

    # two difference quotients of different width agree to their second order
    slope = (peak(1.0001) / peak(0.9999) - 1.0) / 2e-4
    assert case["kappa"] == pytest.approx(slope, rel=1e-2)
    assert case["exact_peak"] == pytest.approx(peak(1.0), rel=1e-10)


def test_figures_are_drawn_from_the_csv_alone(swept, tmp_path):
    folder = swept[0]
    for name in ("sweep.csv", "provenance.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    drawn = sorted(redrawn("sweep", tmp_path))
    assert [path.name for path in drawn] == [f"figure-{n}.png" for n in (6, 7, 8, 9)]
    for path in drawn:
        assert path.read_bytes() == (folder / path.name).read_bytes()
        assert path.stat().st_size > 15_000


def test_a_rerun_computes_nothing(swept, whole):
    folder = swept[0]
    journal = folder / "journal.jsonl"
    before = journal.read_bytes()
    fill(STUDY, replace(whole, ask=partial(whole.ask, None)), folder, ALONE)
    assert journal.read_bytes() == before


def test_provenance_says_what_ran(swept):
    record = json.loads((swept[0] / "provenance.json").read_text())
    project = tomllib.loads((HERE.parents[1] / "pyproject.toml").read_text())["project"]
    assert record["version"] == project["version"]
    pinned = [package for name in core_engines() for package in ENGINES[name].packages]
    for name in pinned:
        (pin,) = (line for line in project["dependencies"] if line.startswith(f"{name}=="))
        assert pin.partition(";")[0] == f"{name}=={record['engines'][name]}"
    assert record["settings"] == {"step": None, "accuracy": None}
    assert set(record["machine"]) == {"cpu", "cores", "os"}
    assert record["packages"]["numpy"] == np.__version__
    assert record["python"] == ".".join(map(str, sys.version_info[:3]))
    first = record["runs"][0]
    assert first["rows"] == 960 * len(MODELS_AND_SOLVERS)
    assert first["duration_s"] > 0.0
    assert str(Path.home()) not in json.dumps(record)
